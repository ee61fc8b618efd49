//! Population codes on neural maps: Eq. 3 (encoding) and Eq. 4 (read-out).

use serde::{Deserialize, Serialize};

use crate::error::{BrainError, check_length, check_range};

/// Most neurons along one axis of a map.
const MAX_NEURONS: usize = 1024;
/// Most axes of a map.
const MAX_AXES: usize = 8;
/// Most neurons of a map.
const MAX_SIZE: usize = 1 << 24;

/// Size and tuning of a [`PopulationMap`] of d axes, 1 ≤ d ≤ 8, each of which encodes one number.
///
/// Preferred values have the unit of the encoded quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapConfig {
    /// Neurons along each axis, 2 to 1024, at most 2^24 in all; the paper has 21 × 21.
    pub neurons: Vec<usize>,
    /// Preferred value of the first neuron of each axis.
    pub low: Vec<f64>,
    /// Preferred value of the last neuron of each axis, above `low`.
    pub high: Vec<f64>,
    /// Standard deviation σ of the tuning curves, in spacings of neurons; the paper has 0.7.
    /// Larger values activate more neurons for one stimulus and pull the read-out of stimuli near
    /// the border further inside.
    pub sigma: f64,
}

impl MapConfig {
    /// A map of `side` × `side` neurons for pairs of numbers from `low` to `high`.
    #[must_use]
    pub fn square(side: usize, low: f64, high: f64, sigma: f64) -> Self {
        Self {
            neurons: vec![side; 2],
            low: vec![low; 2],
            high: vec![high; 2],
            sigma,
        }
    }

    fn validate(&self) -> Result<(), BrainError> {
        let axes = self.neurons.len();
        check_range(
            (1..=MAX_AXES).contains(&axes),
            "axes",
            axes as f64,
            "1 <= axes <= 8",
        )?;
        check_length("low", axes, self.low.len())?;
        check_length("high", axes, self.high.len())?;
        for axis in 0..axes {
            let n = self.neurons[axis];
            check_range(
                (2..=MAX_NEURONS).contains(&n),
                format!("neurons[{axis}]"),
                n as f64,
                "2 <= neurons <= 1024",
            )?;
            let (from, to) = (self.low[axis], self.high[axis]);
            check_range(from.is_finite(), format!("low[{axis}]"), from, "finite")?;
            check_range(
                (to - from).is_finite() && to > from,
                format!("high[{axis}]"),
                to,
                "finite, low < high",
            )?;
        }
        // In floating point, as the product may exceed a usize.
        let size: f64 = self.neurons.iter().map(|&n| n as f64).product();
        check_range(size <= MAX_SIZE as f64, "neurons", size, "at most 2^24")?;
        let sigma = self.sigma;
        check_range(
            sigma.is_finite() && sigma > 0.0,
            "sigma",
            sigma,
            "finite, 0 < sigma",
        )
    }
}

/// A grid of neurons of d axes, each neuron tuned to one preferred value of d numbers.
///
/// The first axis runs fastest: with two axes, neuron `j = iy * nx + ix` prefers
/// `[x of column ix, y of row iy]`.
///
/// ```
/// use babble_brain::{MapConfig, PopulationMap};
///
/// let map = PopulationMap::new(&MapConfig::square(21, 0.0, 1.0, 0.7))?;
/// let mut a = vec![0.0; map.len()];
/// map.encode(&[0.3, 0.6], &mut a)?;
/// let mut b = [0.0; 2];
/// map.read_out(&a, &mut b)?;
/// assert!((b[0] - 0.3).abs() < 1e-3 && (b[1] - 0.6).abs() < 1e-3);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PopulationMap {
    neurons: Vec<usize>,
    low: Vec<f64>,
    high: Vec<f64>,
    /// Distance of the preferred values of two neighbours.
    spacing: Vec<f64>,
    sigma: f64,
}

#[expect(
    clippy::len_without_is_empty,
    reason = "a map has at least two neurons"
)]
impl PopulationMap {
    /// Lays out the neurons, evenly spaced from `low` to `high` inclusive.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the first field outside of its range; [`BrainError::Length`]
    /// for a `low` or `high` of another number of axes.
    pub fn new(config: &MapConfig) -> Result<Self, BrainError> {
        config.validate()?;
        let MapConfig {
            neurons,
            low,
            high,
            sigma,
        } = config.clone();
        let spacing = (0..neurons.len())
            .map(|axis| (high[axis] - low[axis]) / (neurons[axis] - 1) as f64)
            .collect();
        Ok(Self {
            neurons,
            low,
            high,
            spacing,
            sigma,
        })
    }

    /// Number d of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.neurons.len()
    }

    /// Neurons along each axis.
    #[must_use]
    pub fn neurons(&self) -> &[usize] {
        &self.neurons
    }

    /// Number N of neurons.
    #[must_use]
    pub fn len(&self) -> usize {
        self.neurons.iter().product()
    }

    /// Preferred value of neuron `j`, 0 ≤ `j` < [`len`](Self::len).
    #[must_use]
    pub fn preferred(&self, j: usize) -> Vec<f64> {
        let at = self.place(j);
        (0..self.axes())
            .map(|axis| self.value_at(axis, at[axis] as f64))
            .collect()
    }

    /// Eq. 3: `out[j] = exp(-|x_j - x|² / (2 σ²))`, lengths in spacings of neurons, for m stimuli in
    /// `x` (m · d) and `out` (m · N).
    ///
    /// A stimulus outside of the map gives the tails of the tuning curves; activities too small
    /// for a normal `f32` (below 1.2e-38) are zero. One that is no number leaves the map silent.
    ///
    /// # Errors
    /// [`BrainError::Length`] names the slice.
    pub fn encode(&self, x: &[f64], out: &mut [f32]) -> Result<(), BrainError> {
        let stimuli = self.stimuli(x, out)?;
        for (x, out) in stimuli.zip(out.chunks_exact_mut(self.len())) {
            self.encode_one(x, out);
        }
        Ok(())
    }

    /// Eq. 4: the mean of the preferred values, weighted with activities ≥ 0, for m maps in `a`
    /// (m · N) and `out` (m · d). A silent map reads the middle of the map.
    ///
    /// # Errors
    /// [`BrainError::Length`] names the slice.
    pub fn read_out(&self, a: &[f32], out: &mut [f64]) -> Result<(), BrainError> {
        let last: Vec<usize> = self.neurons.iter().map(|n| n - 1).collect();
        self.read_each(a, out, |a, out| {
            self.centroid(a, &vec![0; self.axes()], &last, out);
        })
    }

    /// Eq. 4 over the neurons at most `radius` places away from the strongest one (the first of
    /// equals) along each axis: one peak is read where the mean would lie between two. Otherwise as
    /// [`read_out`](Self::read_out).
    ///
    /// # Errors
    /// [`BrainError::Length`] names the slice.
    pub fn read_out_peak(
        &self,
        a: &[f32],
        radius: usize,
        out: &mut [f64],
    ) -> Result<(), BrainError> {
        self.read_each(a, out, |a, out| {
            let mut peak = 0;
            for (j, &a_j) in a.iter().enumerate() {
                if a_j > a[peak] {
                    peak = j;
                }
            }
            let at = self.place(peak);
            let first: Vec<usize> = at.iter().map(|i| i.saturating_sub(radius)).collect();
            let last: Vec<usize> = at
                .iter()
                .zip(&self.neurons)
                .map(|(i, n)| i.saturating_add(radius).min(n - 1))
                .collect();
            self.centroid(a, &first, &last, out);
        })
    }

    /// The stimuli in `x`, if there are as many as maps in `out`.
    fn stimuli<'a>(
        &self,
        x: &'a [f64],
        out: &[f32],
    ) -> Result<std::slice::ChunksExact<'a, f64>, BrainError> {
        let stimuli = x.len() / self.axes();
        check_length("x", stimuli * self.axes(), x.len())?;
        check_length("out", stimuli * self.len(), out.len())?;
        Ok(x.chunks_exact(self.axes()))
    }

    fn read_each(
        &self,
        a: &[f32],
        out: &mut [f64],
        read: impl Fn(&[f32], &mut [f64]),
    ) -> Result<(), BrainError> {
        let maps = a.len() / self.len();
        check_length("a", maps * self.len(), a.len())?;
        check_length("out", maps * self.axes(), out.len())?;
        let outs = out.chunks_exact_mut(self.axes());
        for (a, out) in a.chunks_exact(self.len()).zip(outs) {
            read(a, out);
        }
        Ok(())
    }

    fn encode_one(&self, x: &[f64], out: &mut [f32]) {
        // exp(-r² / 2σ²) is the product of the tuning curves along the axes.
        let curves: Vec<Vec<f64>> = (0..self.axes())
            .map(|axis| {
                (0..self.neurons[axis])
                    .map(|i| self.tuning(axis, i, x[axis]))
                    .collect()
            })
            .collect();
        let mut at = vec![0; self.axes()];
        for line in out.chunks_exact_mut(self.neurons[0]) {
            let others: f64 = (1..self.axes())
                .map(|axis| curves[axis][at[axis]])
                .product();
            for (g, along) in line.iter_mut().zip(&curves[0]) {
                *g = activity(along * others);
            }
            self.next_line(&mut at);
        }
    }

    /// Tuning curve of neuron `i` along one axis.
    fn tuning(&self, axis: usize, i: usize, x: f64) -> f64 {
        let r = ((x - self.low[axis]) / self.spacing[axis] - i as f64) / self.sigma;
        libm::exp(-0.5 * r * r)
    }

    /// Eq. 4 over the neurons from `first` to `last` along each axis.
    fn centroid(&self, a: &[f32], first: &[usize], last: &[usize], out: &mut [f64]) {
        let (mut sum, mut moment) = (0.0, vec![0.0; self.axes()]);
        let mut at = vec![0; self.axes()];
        for line in a.chunks_exact(self.neurons[0]) {
            if (1..self.axes()).all(|axis| (first[axis]..=last[axis]).contains(&at[axis])) {
                let mut line_sum = 0.0;
                for (i, &a_j) in (first[0]..).zip(&line[first[0]..=last[0]]) {
                    line_sum += f64::from(a_j);
                    moment[0] += f64::from(a_j) * i as f64;
                }
                for axis in 1..self.axes() {
                    moment[axis] += line_sum * at[axis] as f64;
                }
                sum += line_sum;
            }
            self.next_line(&mut at);
        }
        for axis in 0..self.axes() {
            out[axis] = if sum > 0.0 {
                self.value_at(axis, moment[axis] / sum)
            } else {
                0.5 * self.low[axis] + 0.5 * self.high[axis]
            };
        }
    }

    /// Places along the axes of neuron `j`.
    fn place(&self, j: usize) -> Vec<usize> {
        let mut rest = j;
        let along = |&n: &usize| {
            let i = rest % n;
            rest /= n;
            i
        };
        self.neurons.iter().map(along).collect()
    }

    /// Moves on to the next line of neurons along the first axis.
    fn next_line(&self, at: &mut [usize]) {
        for axis in 1..self.axes() {
            at[axis] += 1;
            if at[axis] < self.neurons[axis] {
                return;
            }
            at[axis] = 0;
        }
    }

    /// Value preferred at a (fractional) place along an axis.
    fn value_at(&self, axis: usize, at: f64) -> f64 {
        // Weighting both ends meets low and high exactly.
        let s = at / (self.neurons[axis] - 1) as f64;
        self.low[axis] * (1.0 - s) + self.high[axis] * s
    }
}

/// All pairs of the neurons of two maps, so that each neuron is tuned to the values of both.
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

    /// Activities of all pairs for m stimuli in `x0` (m · d0), `x1` (m · d1) and `out` (m · N); the
    /// sum of each is one, or zero if one of the stimuli is too far outside of its map to activate
    /// any neuron.
    ///
    /// # Errors
    /// [`BrainError::Length`] names the slice.
    pub fn encode(&self, x0: &[f64], x1: &[f64], out: &mut [f32]) -> Result<(), BrainError> {
        let [map0, map1] = &self.maps;
        let stimuli = x0.len() / map0.axes();
        check_length("x0", stimuli * map0.axes(), x0.len())?;
        check_length("x1", stimuli * map1.axes(), x1.len())?;
        check_length("out", stimuli * self.len(), out.len())?;
        let pairs = x0
            .chunks_exact(map0.axes())
            .zip(x1.chunks_exact(map1.axes()));
        for ((x0, x1), out) in pairs.zip(out.chunks_exact_mut(self.len())) {
            let (g0, g1) = (normalised(map0, x0), normalised(map1, x1));
            for (block, &g1_j) in out.chunks_exact_mut(map0.len()).zip(&g1) {
                for (g, &g0_j) in block.iter_mut().zip(&g0) {
                    *g = activity(g0_j * g1_j);
                }
            }
        }
        Ok(())
    }
}

/// Activities of `map`, scaled to sum one; a silent map stays silent.
fn normalised(map: &PopulationMap, x: &[f64]) -> Vec<f64> {
    let mut g = vec![0.0_f32; map.len()];
    map.encode_one(x, &mut g);
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
