//! All-to-all connections between two maps: weights, running averages, learning and recall (Eq. 4).

mod block;
mod built_in;
mod outstar;

use block::{BLOCK, Block, LANES, moved};

use crate::error::{BrainError, check_activity, check_finite, check_length, check_range};
use crate::rules::LearningRule;

/// Most connections of one association.
const MAX_WEIGHTS: usize = 1 << 30;

/// Connections from an input map (activities g) to an output map (activities a).
///
/// Weights are row-major, `w[j * n_in + i]` = `w_ji` from input neuron i to output neuron j.
///
/// ```
/// use babble_brain::{Association, CovarianceRule};
///
/// let mut association = Association::new(2, 2)?;
/// association.learn(&CovarianceRule::default(), &[1.0, 0.0], &[0.0, 1.0])?;
/// let mut a = [0.0; 2];
/// association.recall(&[1.0, 0.0], &mut a)?;
/// assert!(a[0] == 0.0 && a[1] > 0.0);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Association {
    w: Vec<f32>,
    a_mean: Vec<f32>,
    g_mean: Vec<f32>,
}

impl Association {
    /// Unlearnt connections: all weights and averages are zero.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`]: `n_in` and `n_out` are at least 1, their product at most 2^30.
    pub fn new(n_in: usize, n_out: usize) -> Result<Self, BrainError> {
        check_range(n_in > 0, "n_in", n_in as f64, "1 <= n_in")?;
        let most = MAX_WEIGHTS / n_in;
        let valid = (1..=most).contains(&n_out);
        check_range(
            valid,
            "n_out",
            n_out as f64,
            "1 <= n_out, n_in n_out <= 2^30",
        )?;
        Ok(Self {
            w: vec![0.0; n_in * n_out],
            a_mean: vec![0.0; n_out],
            g_mean: vec![0.0; n_in],
        })
    }

    /// Connections learnt before: `w` is row-major, `a_mean.len()` × `g_mean.len()`.
    ///
    /// # Errors
    /// As [`new`](Self::new), [`set_weights`](Self::set_weights) and [`set_means`](Self::set_means).
    pub fn from_parts(w: &[f32], a_mean: &[f32], g_mean: &[f32]) -> Result<Self, BrainError> {
        let mut association = Self::new(g_mean.len(), a_mean.len())?;
        association.set_weights(w)?;
        association.set_means(a_mean, g_mean)?;
        Ok(association)
    }

    /// Learns from m movements in their order: `g` holds m · `n_in` activities, `a` m · `n_out`, all
    /// in \[0, 1\]. For each movement the weights change by the rule, then the averages move on:
    ///
    /// ```text
    /// ā_j ← ξ ā_j + (1 - ξ) a_j,    ḡ_i ← ξ ḡ_i + (1 - ξ) g_i
    /// ```
    ///
    /// An average below 1e-20 becomes zero. The bits are those of the movements learnt one by one,
    /// whatever the number of threads; with the feature `threads`, large batches are shared among
    /// the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; nothing is learnt then.
    pub fn learn<R: LearningRule>(
        &mut self,
        rule: &R,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), BrainError> {
        let (n_in, n_out) = (self.n_in(), self.n_out());
        let movements = g.len() / n_in;
        check_length("g", movements * n_in, g.len())?;
        check_length("a", movements * n_out, a.len())?;
        check_activity("g", g)?;
        check_activity("a", a)?;
        for (g, a) in g.chunks(BLOCK * n_in).zip(a.chunks(BLOCK * n_out)) {
            let block = Block::new(rule, g, a, &mut self.g_mean, &mut self.a_mean);
            block.learn(&mut self.w, n_in);
        }
        Ok(())
    }

    /// Moves the running averages on by one movement with activities `g` (`n_in`) and `a` (`n_out`), as
    /// [`learn`](Self::learn) does after the weights have changed; `xi` is the share of the old value.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; nothing is moved then.
    pub fn move_means(&mut self, g: &[f32], a: &[f32], xi: f32) -> Result<(), BrainError> {
        check_length("g", self.n_in(), g.len())?;
        check_length("a", self.n_out(), a.len())?;
        check_activity("g", g)?;
        check_activity("a", a)?;
        let inputs = self.g_mean.iter_mut().zip(g);
        for (mean, &x) in inputs.chain(self.a_mean.iter_mut().zip(a)) {
            *mean = moved(*mean, x, xi);
        }
        Ok(())
    }

    /// The output activities that input activities call up: `out[j]` = `max(tanh(Σ_i w_ji g_i), 0)`,
    /// for m stimuli in `g` (m · `n_in`) and `out` (m · `n_out`).
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; `out` is unchanged then.
    pub fn recall(&self, g: &[f32], out: &mut [f32]) -> Result<(), BrainError> {
        let (n_in, n_out) = (self.n_in(), self.n_out());
        let stimuli = out.len() / n_out;
        check_length("g", stimuli * n_in, g.len())?;
        check_length("out", stimuli * n_out, out.len())?;
        check_activity("g", g)?;
        for (g, out) in g.chunks_exact(n_in).zip(out.chunks_exact_mut(n_out)) {
            for (a_j, w_j) in out.iter_mut().zip(self.w.chunks_exact(n_in)) {
                *a_j = libm::tanhf(dot(w_j, g).max(0.0));
            }
        }
        Ok(())
    }

    /// Number of input neurons.
    #[must_use]
    pub fn n_in(&self) -> usize {
        self.g_mean.len()
    }

    /// Number of output neurons.
    #[must_use]
    pub fn n_out(&self) -> usize {
        self.a_mean.len()
    }

    /// Weights, row-major, `n_out` × `n_in`.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.w
    }

    /// Running averages ā of the output neurons.
    #[must_use]
    pub fn a_mean(&self) -> &[f32] {
        &self.a_mean
    }

    /// Running averages ḡ of the input neurons, or their use u if the outstar rule teaches them.
    #[must_use]
    pub fn g_mean(&self) -> &[f32] {
        &self.g_mean
    }

    /// Sets all weights, row-major, `n_out` × `n_in`.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::NotFinite`]; nothing is set then.
    pub fn set_weights(&mut self, w: &[f32]) -> Result<(), BrainError> {
        check_length("weights", self.w.len(), w.len())?;
        check_finite("weights", w)?;
        self.w.copy_from_slice(w);
        Ok(())
    }

    /// Sets the running averages of the output (`n_out`) and of the input (`n_in`).
    ///
    /// # Errors
    /// [`BrainError::Length`], or [`BrainError::Activity`] for an average outside of \[0, 1\];
    /// nothing is set then.
    pub fn set_means(&mut self, a_mean: &[f32], g_mean: &[f32]) -> Result<(), BrainError> {
        check_length("a_mean", self.n_out(), a_mean.len())?;
        check_length("g_mean", self.n_in(), g_mean.len())?;
        check_activity("a_mean", a_mean)?;
        check_activity("g_mean", g_mean)?;
        self.a_mean.copy_from_slice(a_mean);
        self.g_mean.copy_from_slice(g_mean);
        Ok(())
    }
}

/// `Σ_i w_i g_i` in 32 partial sums, which fit vector registers on every machine and give the same bits on
/// all.
#[must_use]
pub fn dot(w: &[f32], g: &[f32]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    let (w_lanes, w_rest) = w.as_chunks::<LANES>();
    let (g_lanes, g_rest) = g.as_chunks::<LANES>();
    for (w, g) in w_lanes.iter().zip(g_lanes) {
        for lane in 0..LANES {
            sums[lane] += w[lane] * g[lane];
        }
    }
    for (sum, (w, g)) in sums.iter_mut().zip(w_rest.iter().zip(g_rest)) {
        *sum += w * g;
    }
    sums.iter().sum()
}
