//! Learning rules: how a weight changes with the activities that it connects.

use serde::{Deserialize, Serialize};

use crate::error::{BrainError, check_range};

/// Deviations from an average that are smaller than this count as zero. A weight moves by at most
/// η · deviation · `w_max` a step, so 20,000 skipped steps keep back less than 4e-7 of `w_max` = 0.2.
const SILENT: f32 = 1e-10;

/// A learning rule that is local: the change of the weight `w_ji` depends on the two neurons that it
/// connects and on the weight itself,
///
/// ```text
/// Δw_ji = change(post(a_j, ā_j), pre(g_i, ḡ_i), w_ji)
/// ```
///
/// with the activities g of the input and a of the output, and their running averages ḡ and ā.
/// Written in these three parts, any rule learns as fast as the one of the paper: `pre` and `post` are
/// computed once a neuron, `change` once a weight, in vector registers.
///
/// ```
/// use babble_brain::{Association, LearningRule};
///
/// /// Hebb's rule with a decay of unused weights.
/// struct Decaying;
///
/// impl LearningRule for Decaying {
///     fn post(&self, a: f32, _mean: f32) -> f32 { a }
///     fn pre(&self, g: f32, _mean: f32) -> f32 { g }
///     fn change(&self, post: f32, pre: f32, w: f32) -> f32 { 0.1 * post * (pre - w) }
/// }
///
/// let mut association = Association::new(2, 1)?;
/// association.learn(&Decaying, &[1.0, 0.0], &[1.0])?;
/// assert_eq!(association.weights(), [0.1, 0.0]);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
pub trait LearningRule: Sync {
    /// Signal of an output neuron with activity `a` and average activity `mean`. A neuron whose
    /// signal is zero learns nothing.
    fn post(&self, a: f32, mean: f32) -> f32;

    /// Signal of an input neuron with activity `g` and average activity `mean`.
    fn pre(&self, g: f32, mean: f32) -> f32;

    /// Change Δw of the weight `w` between two neurons with these signals; 0 for `post` = 0.
    fn change(&self, post: f32, pre: f32, w: f32) -> f32;

    /// Share ξ of the old value in the running averages, 0 ≤ ξ < 1; the paper's 0.2 unless given.
    fn xi(&self) -> f32 {
        0.2
    }
}

/// The covariance rule of the paper:
///
/// ```text
/// Δw_ji = η (a_j - ā_j)(g_i - ḡ_i)(w_max - |w_ji|)                                   (Eq. 7)
/// ```
///
/// With activities in \[0, 1\] a step takes |w| at most the whole way to `w_max`, so nothing is
/// clipped. A deviation below 1e-10 counts as zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CovarianceRule {
    /// Learning rate η, 0 < η ≤ 1, default 1 \[P\]. Above 1 a weight could leap over its bound.
    pub eta: f32,
    /// Bound of the weights, > 0, default 0.2 \[P\]. Larger weights drive the output neurons further
    /// into the saturation of tanh.
    pub w_max: f32,
    /// Share ξ of the old value in the running averages, 0 ≤ ξ < 1, default 0.2 \[P\]. Larger values
    /// average over more movements.
    pub xi: f32,
}

impl LearningRule for CovarianceRule {
    #[inline]
    fn post(&self, a: f32, mean: f32) -> f32 {
        self.eta * deviation(a, mean)
    }

    #[inline]
    fn pre(&self, g: f32, mean: f32) -> f32 {
        deviation(g, mean)
    }

    #[inline]
    fn change(&self, post: f32, pre: f32, w: f32) -> f32 {
        post * pre * room(w, self.w_max)
    }

    fn xi(&self) -> f32 {
        self.xi
    }
}

/// Hebb's rule: neurons that are active together are connected more strongly, whatever their average
/// activity. It is Eq. 7 without the averages, with the same bound of the weights:
///
/// ```text
/// Δw_ji = η a_j g_i (w_max - |w_ji|)
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HebbRule {
    /// Learning rate η, 0 < η ≤ 1, default 1.
    pub eta: f32,
    /// Bound of the weights, > 0, default 0.2.
    pub w_max: f32,
    /// Share ξ of the old value in the running averages, 0 ≤ ξ < 1, default 0.2. They are kept, and
    /// the rule does not use them.
    pub xi: f32,
}

impl LearningRule for HebbRule {
    #[inline]
    fn post(&self, a: f32, _mean: f32) -> f32 {
        self.eta * a
    }

    #[inline]
    fn pre(&self, g: f32, _mean: f32) -> f32 {
        g
    }

    #[inline]
    fn change(&self, post: f32, pre: f32, w: f32) -> f32 {
        post * pre * room(w, self.w_max)
    }

    fn xi(&self) -> f32 {
        self.xi
    }
}

/// Oja's rule (1982): Hebb's rule with a decay that grows with the output's activity, so that weights
/// stay finite without a bound:
///
/// ```text
/// Δw_ji = η a_j (g_i - a_j w_ji)
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OjaRule {
    /// Learning rate η, 0 < η ≤ 1, default 0.1.
    pub eta: f32,
    /// Share ξ of the old value in the running averages, 0 ≤ ξ < 1, default 0.2. They are kept, and
    /// the rule does not use them.
    pub xi: f32,
}

impl LearningRule for OjaRule {
    #[inline]
    fn post(&self, a: f32, _mean: f32) -> f32 {
        a
    }

    #[inline]
    fn pre(&self, g: f32, _mean: f32) -> f32 {
        g
    }

    #[inline]
    fn change(&self, post: f32, pre: f32, w: f32) -> f32 {
        self.eta * post * (pre - post * w)
    }

    fn xi(&self) -> f32 {
        self.xi
    }
}

/// The outstar rule, which has no numbers: [`Association::learn_outstar`] is its equation.
///
/// [`Association::learn_outstar`]: crate::Association::learn_outstar
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutstarRule {}

impl Default for CovarianceRule {
    fn default() -> Self {
        Self {
            eta: 1.0,
            w_max: 0.2,
            xi: 0.2,
        }
    }
}

impl Default for HebbRule {
    fn default() -> Self {
        Self {
            eta: 1.0,
            w_max: 0.2,
            xi: 0.2,
        }
    }
}

impl Default for OjaRule {
    fn default() -> Self {
        Self { eta: 0.1, xi: 0.2 }
    }
}

impl CovarianceRule {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the parameter outside of its range.
    pub fn validate(&self) -> Result<(), BrainError> {
        check(self.eta, self.w_max, self.xi)
    }
}

impl HebbRule {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the parameter outside of its range.
    pub fn validate(&self) -> Result<(), BrainError> {
        check(self.eta, self.w_max, self.xi)
    }
}

impl OjaRule {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the parameter outside of its range.
    pub fn validate(&self) -> Result<(), BrainError> {
        check(self.eta, 1.0, self.xi)
    }
}

fn check(eta: f32, w_max: f32, xi: f32) -> Result<(), BrainError> {
    let valid = eta > 0.0 && eta <= 1.0;
    check_range(valid, "eta", eta.into(), "0 < eta <= 1")?;
    let valid = w_max >= f32::MIN_POSITIVE && w_max.is_finite();
    check_range(valid, "w_max", w_max.into(), "finite, 0 < w_max")?;
    let valid = (0.0..1.0).contains(&xi);
    check_range(valid, "xi", xi.into(), "0 <= xi < 1")
}

/// Deviation of an activity from its average; below 1e-10 it counts as zero.
#[inline]
#[must_use]
pub fn deviation(x: f32, mean: f32) -> f32 {
    let deviation = x - mean;
    if deviation.abs() < SILENT {
        0.0
    } else {
        deviation
    }
}

/// `w_max - |w|`: how far a weight is from its bound; 0 beyond it.
#[inline]
#[must_use]
pub fn room(w: f32, w_max: f32) -> f32 {
    // Rounding may carry |w| one ulp past w_max; from there it must not run away.
    let room = w_max - w.abs();
    if room > 0.0 { room } else { 0.0 }
}
