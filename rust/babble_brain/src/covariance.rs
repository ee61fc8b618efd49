//! All-to-all connections between two maps, learnt by the covariance rule (Eq. 7).

use serde::{Deserialize, Serialize};

use crate::block::{BLOCK, Block, LANES};
use crate::error::{BrainError, check_activity, check_length, check_range};

/// Most connections of one association.
const MAX_WEIGHTS: usize = 1 << 30;

/// Parameters of the covariance rule; the defaults are the paper's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CovarianceConfig {
    /// Learning rate η, 0 < η ≤ 1, default 1. Above 1 a weight could leap over its bound.
    pub eta: f32,
    /// Bound of the weights, > 0, default 0.2. Larger weights drive the output neurons further
    /// into the saturation of tanh.
    pub w_max: f32,
    /// Share ξ of the old value in the moving averages, 0 ≤ ξ < 1, default 0.2. Larger values
    /// average over more movements.
    pub xi: f32,
}

impl Default for CovarianceConfig {
    fn default() -> Self {
        Self {
            eta: 1.0,
            w_max: 0.2,
            xi: 0.2,
        }
    }
}

impl CovarianceConfig {
    fn validate(&self) -> Result<(), BrainError> {
        let &Self { eta, w_max, xi } = self;
        let valid = eta > 0.0 && eta <= 1.0;
        check_range(valid, "eta", eta.into(), "0 < eta <= 1")?;
        let valid = w_max >= f32::MIN_POSITIVE && w_max.is_finite();
        check_range(valid, "w_max", w_max.into(), "finite, 0 < w_max")?;
        let valid = (0.0..1.0).contains(&xi);
        check_range(valid, "xi", xi.into(), "0 <= xi < 1")
    }
}

/// Connections from an input map (activities g) to an output map (activities a).
///
/// Weights are row-major, `w[j * n_in + i]` = `w_ji` from input neuron i to output neuron j.
///
/// ```
/// use babble_brain::{Association, CovarianceConfig};
///
/// let mut association = Association::new(&CovarianceConfig::default(), 2, 2)?;
/// association.learn(&[1.0, 0.0], &[0.0, 1.0])?;
/// let mut a = [0.0; 2];
/// association.recall(&[1.0, 0.0], &mut a)?;
/// assert!(a[0] == 0.0 && a[1] > 0.0);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Association {
    config: CovarianceConfig,
    n_in: usize,
    n_out: usize,
    w: Vec<f32>,
    a_bar: Vec<f32>,
    g_bar: Vec<f32>,
}

impl Association {
    /// Unlearnt connections: all weights and averages are zero.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the parameter outside of its range; `n_in` and `n_out`
    /// are at least 1, their product at most 2^30.
    pub fn new(config: &CovarianceConfig, n_in: usize, n_out: usize) -> Result<Self, BrainError> {
        config.validate()?;
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
            config: config.clone(),
            n_in,
            n_out,
            w: vec![0.0; n_in * n_out],
            a_bar: vec![0.0; n_out],
            g_bar: vec![0.0; n_in],
        })
    }

    /// Connections learnt before: `w` is row-major, `a_bar.len()` × `g_bar.len()`.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`BrainError::Length`] if `w` does not fit the averages,
    /// [`BrainError::Activity`] for an average outside of \[0, 1\], [`BrainError::Weight`] for a
    /// weight with |w| above `w_max` by more than one unit in the last place.
    pub fn from_parts(
        config: &CovarianceConfig,
        w: Vec<f32>,
        a_bar: Vec<f32>,
        g_bar: Vec<f32>,
    ) -> Result<Self, BrainError> {
        let (n_in, n_out) = (g_bar.len(), a_bar.len());
        let unlearnt = Self::new(config, n_in, n_out)?;
        check_length("w", n_in * n_out, w.len())?;
        check_activity("a_bar", &a_bar)?;
        check_activity("g_bar", &g_bar)?;
        let bound = config.w_max.next_up();
        if let Some(index) = w
            .iter()
            .position(|w_ji| w_ji.is_nan() || w_ji.abs() > bound)
        {
            return Err(BrainError::Weight {
                index,
                value: w[index],
                w_max: config.w_max,
            });
        }
        Ok(Self {
            w,
            a_bar,
            g_bar,
            ..unlearnt
        })
    }

    /// One step of Eq. 7 for the input activity `g` (`n_in`) and the output activity `a` (`n_out`):
    ///
    /// ```text
    /// Δw_ji = η (a_j - ā_j)(g_i - ḡ_i)(w_max - |w_ji|),    then
    /// ā_j ← ξ ā_j + (1 - ξ) a_j,    ḡ_i ← ξ ḡ_i + (1 - ξ) g_i
    /// ```
    ///
    /// Activities are in \[0, 1\]; then |w| ≤ `w_max` to one unit in the last place, unclipped. A
    /// deviation below 1e-10 counts as zero, an average below 1e-20 becomes zero. Runs in the thread
    /// that calls.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; nothing is learnt then.
    pub fn learn(&mut self, g: &[f32], a: &[f32]) -> Result<(), BrainError> {
        check_length("g", self.n_in, g.len())?;
        check_length("a", self.n_out, a.len())?;
        check_activity("g", g)?;
        check_activity("a", a)?;
        let block = Block::new(&self.config, g, a, &mut self.g_bar, &mut self.a_bar);
        block.learn(&mut self.w, self.n_in, self.config.w_max);
        Ok(())
    }

    /// m steps of Eq. 7 in order: `gs` holds m · `n_in`, `as_` m · `n_out` activities. The bits
    /// are those of m calls of [`learn`](Self::learn), whatever the number of threads; large
    /// batches share their rows among the threads of the current rayon pool.
    ///
    /// # Errors
    /// As [`learn`](Self::learn).
    pub fn learn_batch(&mut self, gs: &[f32], as_: &[f32]) -> Result<(), BrainError> {
        let movements = gs.len() / self.n_in;
        check_length("gs", movements * self.n_in, gs.len())?;
        check_length("as_", movements * self.n_out, as_.len())?;
        check_activity("gs", gs)?;
        check_activity("as_", as_)?;
        let a_blocks = as_.chunks(BLOCK * self.n_out);
        for (g, a) in gs.chunks(BLOCK * self.n_in).zip(a_blocks) {
            let block = Block::new(&self.config, g, a, &mut self.g_bar, &mut self.a_bar);
            block.learn_shared(&mut self.w, self.n_in, self.config.w_max);
        }
        Ok(())
    }

    /// The output activity that the input activity `g` (`n_in`) calls up:
    /// `out[j]` = `max(tanh(Σ_i w_ji g_i), 0)`.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; `out` is unchanged then.
    pub fn recall(&self, g: &[f32], out: &mut [f32]) -> Result<(), BrainError> {
        check_length("g", self.n_in, g.len())?;
        check_length("out", self.n_out, out.len())?;
        check_activity("g", g)?;
        for (a_j, row) in out.iter_mut().zip(self.w.chunks_exact(self.n_in)) {
            *a_j = libm::tanhf(dot(row, g).max(0.0));
        }
        Ok(())
    }

    /// Parameters of the rule.
    #[must_use]
    pub fn config(&self) -> &CovarianceConfig {
        &self.config
    }

    /// Number of input neurons.
    #[must_use]
    pub fn n_in(&self) -> usize {
        self.n_in
    }

    /// Number of output neurons.
    #[must_use]
    pub fn n_out(&self) -> usize {
        self.n_out
    }

    /// Weights, row-major, `n_out` × `n_in`.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.w
    }

    /// Moving averages ā of the output neurons.
    #[must_use]
    pub fn a_bar(&self) -> &[f32] {
        &self.a_bar
    }

    /// Moving averages ḡ of the input neurons.
    #[must_use]
    pub fn g_bar(&self) -> &[f32] {
        &self.g_bar
    }
}

/// `Σ_i w_i g_i` in [`LANES`] partial sums, which fit vector registers on every machine and give
/// the same bits on all.
fn dot(w: &[f32], g: &[f32]) -> f32 {
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
