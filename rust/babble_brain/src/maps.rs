//! Population codes on two-dimensional neural maps: Eq. 3 (encoding) and Eq. 4 (read-out).

use serde::{Deserialize, Serialize};

use crate::error::{BrainError, check_range};

/// Most neurons along one axis of a map.
const MAX_NEURONS: usize = 1024;

/// Size and tuning of a [`PopulationMap`].
///
/// Preferred values have the unit of the encoded quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapConfig {
    /// Neurons along each axis, 2 to 1024; the paper has 21 × 21.
    pub neurons: [usize; 2],
    /// Preferred value of the first neuron of each axis.
    pub low: [f64; 2],
    /// Preferred value of the last neuron of each axis, above `low`.
    pub high: [f64; 2],
    /// Standard deviation σ of the tuning curves, in spacings of neurons; the paper has 0.7.
    /// Larger values activate more neurons for one stimulus and pull the read-out of stimuli near
    /// the border further inside.
    pub sigma: f64,
}

impl MapConfig {
    fn validate(&self) -> Result<(), BrainError> {
        for axis in 0..2 {
            let [neurons, low, high] = [
                ["neurons[0]", "low[0]", "high[0]"],
                ["neurons[1]", "low[1]", "high[1]"],
            ][axis];
            let n = self.neurons[axis];
            check_range(
                (2..=MAX_NEURONS).contains(&n),
                neurons,
                n as f64,
                "2 <= neurons <= 1024",
            )?;
            let (from, to) = (self.low[axis], self.high[axis]);
            check_range(from.is_finite(), low, from, "finite")?;
            check_range(
                (to - from).is_finite() && to > from,
                high,
                to,
                "finite, low < high",
            )?;
        }
        let sigma = self.sigma;
        check_range(
            sigma.is_finite() && sigma > 0.0,
            "sigma",
            sigma,
            "finite, 0 < sigma",
        )
    }
}

/// A grid of neurons, each tuned to one preferred pair of values.
///
/// Neuron `j = iy * nx + ix` prefers the pair `[x of column ix, y of row iy]`.
///
/// ```
/// use babble_brain::{MapConfig, PopulationMap};
///
/// let config = MapConfig { neurons: [21, 21], low: [0.0; 2], high: [1.0; 2], sigma: 0.7 };
/// let map = PopulationMap::new(&config)?;
/// let mut a = vec![0.0; map.len()];
/// map.encode([0.3, 0.6], &mut a);
/// let b = map.read_out(&a);
/// assert!((b[0] - 0.3).abs() < 1e-3 && (b[1] - 0.6).abs() < 1e-3);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PopulationMap {
    neurons: [usize; 2],
    low: [f64; 2],
    high: [f64; 2],
    /// Distance of the preferred values of two neighbours.
    spacing: [f64; 2],
    sigma: f64,
}

#[expect(
    clippy::len_without_is_empty,
    reason = "a map has at least four neurons"
)]
impl PopulationMap {
    /// Lays out the neurons, evenly spaced from `low` to `high` inclusive.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the first field outside of its range.
    pub fn new(config: &MapConfig) -> Result<Self, BrainError> {
        config.validate()?;
        let &MapConfig {
            neurons,
            low,
            high,
            sigma,
        } = config;
        let spacing = [0, 1].map(|axis| (high[axis] - low[axis]) / (neurons[axis] - 1) as f64);
        Ok(Self {
            neurons,
            low,
            high,
            spacing,
            sigma,
        })
    }

    /// Number of neurons, nx · ny.
    #[must_use]
    pub fn len(&self) -> usize {
        self.neurons[0] * self.neurons[1]
    }

    /// Preferred pair of values of neuron `j`, 0 ≤ `j` < [`len`](Self::len).
    #[must_use]
    pub fn preferred(&self, j: usize) -> [f64; 2] {
        self.value_at([(j % self.neurons[0]) as f64, (j / self.neurons[0]) as f64])
    }

    /// Eq. 3: `out[j] = exp(-|x_j - x|² / (2 σ²))`, lengths in spacings of neurons.
    ///
    /// A stimulus outside of the map gives the tails of the tuning curves; activities too small
    /// for a normal `f32` (below 1.2e-38) are zero. One that is no number leaves the map silent.
    ///
    /// # Panics
    /// If `out` has not [`len`](Self::len) elements.
    pub fn encode(&self, x: [f64; 2], out: &mut [f32]) {
        assert_eq!(out.len(), self.len(), "one activity per neuron");
        let columns: Vec<f64> = (0..self.neurons[0])
            .map(|ix| self.tuning(0, ix, x[0]))
            .collect();
        for (iy, row) in out.chunks_exact_mut(self.neurons[0]).enumerate() {
            let gy = self.tuning(1, iy, x[1]);
            for (g, gx) in row.iter_mut().zip(&columns) {
                *g = activity(gx * gy);
            }
        }
    }

    /// Eq. 4: the mean of the preferred values, weighted with the activities `a` ≥ 0.
    /// A silent map reads the middle of the map.
    ///
    /// # Panics
    /// If `a` has not [`len`](Self::len) elements.
    #[must_use]
    pub fn read_out(&self, a: &[f32]) -> [f64; 2] {
        assert_eq!(a.len(), self.len(), "one activity per neuron");
        self.centroid(a, [0, 0], [self.neurons[0] - 1, self.neurons[1] - 1])
    }

    /// Eq. 4 over the neurons at most `radius` columns and rows away from the strongest one (the
    /// first of equals): one peak is read where the mean would lie between two.
    /// A silent map reads the middle of the map.
    ///
    /// # Panics
    /// If `a` has not [`len`](Self::len) elements.
    #[must_use]
    pub fn read_out_peak(&self, a: &[f32], radius: usize) -> [f64; 2] {
        assert_eq!(a.len(), self.len(), "one activity per neuron");
        let mut peak = 0;
        for (j, &a_j) in a.iter().enumerate() {
            if a_j > a[peak] {
                peak = j;
            }
        }
        let at = [peak % self.neurons[0], peak / self.neurons[0]];
        let first = at.map(|i| i.saturating_sub(radius));
        let last = [0, 1].map(|axis| at[axis].saturating_add(radius).min(self.neurons[axis] - 1));
        self.centroid(a, first, last)
    }

    /// Tuning curve of column or row `i` along one axis; exp(-r² / 2σ²) is the product of both.
    fn tuning(&self, axis: usize, i: usize, x: f64) -> f64 {
        let r = ((x - self.low[axis]) / self.spacing[axis] - i as f64) / self.sigma;
        libm::exp(-0.5 * r * r)
    }

    /// Eq. 4 over the columns and rows `first..=last`.
    fn centroid(&self, a: &[f32], first: [usize; 2], last: [usize; 2]) -> [f64; 2] {
        let (mut sum, mut moment) = (0.0, [0.0; 2]);
        for iy in first[1]..=last[1] {
            let row = &a[iy * self.neurons[0]..][first[0]..=last[0]];
            let mut row_sum = 0.0;
            for (ix, &a_j) in (first[0]..).zip(row) {
                row_sum += f64::from(a_j);
                moment[0] += f64::from(a_j) * ix as f64;
            }
            moment[1] += row_sum * iy as f64;
            sum += row_sum;
        }
        if sum > 0.0 {
            self.value_at(moment.map(|m| m / sum))
        } else {
            [0, 1].map(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis])
        }
    }

    /// Value preferred at a (fractional) column and row.
    fn value_at(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            // Weighting both ends meets low and high exactly.
            let s = at[axis] / (self.neurons[axis] - 1) as f64;
            self.low[axis] * (1.0 - s) + self.high[axis] * s
        })
    }
}

/// All pairs of the neurons of two maps, so that each neuron is tuned to four values at once.
///
/// Goes beyond the paper, whose input is one map. A pair's activity is the product of its two
/// neurons' activities, and the whole map's activity is normalised to sum one.
/// Neuron `j = j1 * map0.len() + j0`.
#[derive(Debug, Clone, PartialEq)]
pub struct ConjunctiveMap {
    maps: [PopulationMap; 2],
}

#[expect(
    clippy::len_without_is_empty,
    reason = "a map has at least four neurons"
)]
impl ConjunctiveMap {
    /// Pairs the neurons of `map0` (inner index) and `map1` (outer index).
    #[must_use]
    pub fn new(map0: PopulationMap, map1: PopulationMap) -> Self {
        Self { maps: [map0, map1] }
    }

    /// Number of pairs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.maps[0].len() * self.maps[1].len()
    }

    /// The two maps.
    #[must_use]
    pub fn maps(&self) -> &[PopulationMap; 2] {
        &self.maps
    }

    /// Activities of all pairs for the stimuli `x0` and `x1`; their sum is one, or zero if one of
    /// the stimuli is too far outside of its map to activate any neuron.
    ///
    /// # Panics
    /// If `out` has not [`len`](Self::len) elements.
    pub fn encode(&self, x0: [f64; 2], x1: [f64; 2], out: &mut [f32]) {
        assert_eq!(out.len(), self.len(), "one activity per pair");
        let [map0, map1] = &self.maps;
        let (g0, g1) = (normalised(map0, x0), normalised(map1, x1));
        for (block, &g1_j) in out.chunks_exact_mut(map0.len()).zip(&g1) {
            for (g, &g0_j) in block.iter_mut().zip(&g0) {
                *g = activity(g0_j * g1_j);
            }
        }
    }
}

/// Activities of `map`, scaled to sum one; a silent map stays silent.
fn normalised(map: &PopulationMap, x: [f64; 2]) -> Vec<f64> {
    let mut g = vec![0.0_f32; map.len()];
    map.encode(x, &mut g);
    let sum: f64 = g.iter().copied().map(f64::from).sum();
    let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
    g.iter().map(|&g_j| f64::from(g_j) * scale).collect()
}

/// Rounds to `f32`, without the subnormal numbers, which are slow in all later sums.
fn activity(g: f64) -> f32 {
    if g >= f64::from(f32::MIN_POSITIVE) {
        g as f32
    } else {
        0.0
    }
}
