//! Eq. 7 for a block of movements: the inner loop of learning.
//!
//! The averages depend on the activities alone, so the deviations of a whole block are computed
//! first. They then pass, in order, over one tile of weights after the other, held in registers.

use rayon::prelude::*;

use crate::covariance::CovarianceConfig;

/// Deviations from an average that are smaller than this count as zero. A weight moves by at most
/// η · deviation · `w_max` a step, so 20,000 skipped steps keep back less than 4e-7 of `w_max` = 0.2.
const SILENT: f32 = 1e-10;
/// Averages that have decayed below this are zero: further down they would become subnormal
/// numbers, which are slow.
const FADED: f32 = SILENT * SILENT;

/// Movements of a block: few enough for the deviations of one tile to stay in the first cache.
pub(crate) const BLOCK: usize = 64;
/// Weights of a tile: 32 `f32` are eight of the sixteen vector registers of any x86-64.
pub(crate) const LANES: usize = 32;
/// Rows that share a tile's deviations while these are in the cache.
const ROWS: usize = 8;
/// Weight updates in a block below which threads cost more than they save.
const PARALLEL: usize = 1 << 18;

/// Deviations of a block of movements from the averages as these stood before each movement.
pub(crate) struct Block {
    movements: usize,
    /// g - ḡ as `[tile][movement][lane]`, filled up with zeros.
    g: Vec<[f32; LANES]>,
    /// η (a - ā) as `[output neuron][movement]`.
    a: Vec<f32>,
}

impl Block {
    /// Deviations of the activities `g` (movements × inputs) and `a` (movements × outputs); the
    /// averages are moved to their values after the block.
    pub(crate) fn new(
        config: &CovarianceConfig,
        g: &[f32],
        a: &[f32],
        g_bar: &mut [f32],
        a_bar: &mut [f32],
    ) -> Self {
        let movements = a.len() / a_bar.len();
        let tiles = g_bar.len().div_ceil(LANES);
        let mut block = Self {
            movements,
            g: vec![[0.0; LANES]; tiles * movements],
            a: vec![0.0; a.len()],
        };
        for (m, g) in g.chunks_exact(g_bar.len()).enumerate() {
            for (tile, (g, g_bar)) in g.chunks(LANES).zip(g_bar.chunks_mut(LANES)).enumerate() {
                let deviations = &mut block.g[tile * movements + m];
                for ((d, &g_i), g_bar_i) in deviations.iter_mut().zip(g).zip(g_bar) {
                    *d = deviation(g_i, g_bar_i, config.xi);
                }
            }
        }
        for (m, a) in a.chunks_exact(a_bar.len()).enumerate() {
            for (j, (&a_j, a_bar_j)) in a.iter().zip(a_bar.iter_mut()).enumerate() {
                block.a[j * movements + m] = config.eta * deviation(a_j, a_bar_j, config.xi);
            }
        }
        block
    }

    /// Eq. 7 for all weights `w` (outputs × `n_in`), in this thread.
    pub(crate) fn learn(&self, w: &mut [f32], n_in: usize, w_max: f32) {
        let rows = w.chunks_mut(ROWS * n_in);
        for (rows, a) in rows.zip(self.a.chunks(ROWS * self.movements)) {
            self.learn_rows(rows, a, n_in, w_max);
        }
    }

    /// The same, in the threads of the current rayon pool if there is enough to do.
    pub(crate) fn learn_shared(&self, w: &mut [f32], n_in: usize, w_max: f32) {
        if w.len() * self.movements < PARALLEL {
            return self.learn(w, n_in, w_max);
        }
        w.par_chunks_mut(ROWS * n_in)
            .zip(self.a.par_chunks(ROWS * self.movements))
            .for_each(|(rows, a)| self.learn_rows(rows, a, n_in, w_max));
    }

    /// Eq. 7 for some rows of weights; `a` holds their scaled deviations.
    fn learn_rows(&self, rows: &mut [f32], a: &[f32], n_in: usize, w_max: f32) {
        // Listed once, about half of them silent, so that no tile has to branch.
        let active: Vec<Vec<(usize, f32)>> = a
            .chunks_exact(self.movements)
            .map(|a| {
                a.iter()
                    .copied()
                    .enumerate()
                    .filter(|&(_, a_j)| a_j != 0.0)
                    .collect()
            })
            .collect();
        for (tile, g) in self.g.chunks_exact(self.movements).enumerate() {
            for (row, active) in rows.chunks_exact_mut(n_in).zip(&active) {
                let end = n_in.min((tile + 1) * LANES);
                learn_tile(&mut row[tile * LANES..end], active, g, w_max);
            }
        }
    }
}

/// Eq. 7 for the weights of one tile, one movement after the other.
fn learn_tile(weights: &mut [f32], active: &[(usize, f32)], g: &[[f32; LANES]], w_max: f32) {
    let mut w = [0.0; LANES];
    w[..weights.len()].copy_from_slice(weights);
    for &(m, a_j) in active {
        let g = &g[m];
        for lane in 0..LANES {
            // Rounding may carry |w| one ulp past w_max; from there it must not run away.
            let room = w_max - w[lane].abs();
            let room = if room > 0.0 { room } else { 0.0 };
            w[lane] += a_j * g[lane] * room;
        }
    }
    weights.copy_from_slice(&w[..weights.len()]);
}

/// Deviation of activity `x` from its average, which then moves on.
fn deviation(x: f32, average: &mut f32, xi: f32) -> f32 {
    let deviation = x - *average;
    let moved = xi * *average + (1.0 - xi) * x;
    *average = if moved < FADED { 0.0 } else { moved };
    if deviation.abs() < SILENT {
        0.0
    } else {
        deviation
    }
}
