//! A learning rule for a block of movements: the inner loop of learning.
//!
//! The averages depend on the activities alone, so the signals of a whole block are computed first.
//! They then pass, in order, over one tile of weights after the other, held in registers.

#[cfg(feature = "threads")]
use rayon::prelude::*;

use crate::rules::LearningRule;

/// Averages that have decayed below this are zero: further down they would become subnormal
/// numbers, which are slow.
const FADED: f32 = 1e-10 * 1e-10;

/// Movements of a block: few enough for the signals of one tile to stay in the first cache.
pub(super) const BLOCK: usize = 64;
/// Weights of a tile: 32 `f32` are eight of the sixteen vector registers of any x86-64.
pub(super) const LANES: usize = 32;
/// Output neurons that share a tile's signals while these are in the cache.
const NEURONS: usize = 8;
/// Weight updates in a block below which threads cost more than they save.
#[cfg(feature = "threads")]
const PARALLEL: usize = 1 << 18;

/// Signals of a block of movements.
pub(super) struct Block<'a, R> {
    rule: &'a R,
    movements: usize,
    /// Signals of the input as `[tile][movement][lane]`, filled up with zeros.
    pre: Vec<[f32; LANES]>,
    /// Signals of the output as `[output neuron][movement]`.
    post: Vec<f32>,
}

impl<'a, R: LearningRule> Block<'a, R> {
    /// Signals of the activities `g` (movements × inputs) and `a` (movements × outputs); the
    /// averages are moved to their values after the block.
    pub(super) fn new(
        rule: &'a R,
        g: &[f32],
        a: &[f32],
        g_mean: &mut [f32],
        a_mean: &mut [f32],
    ) -> Self {
        let movements = a.len() / a_mean.len();
        let tiles = g_mean.len().div_ceil(LANES);
        let mut block = Self {
            rule,
            movements,
            pre: vec![[0.0; LANES]; tiles * movements],
            post: vec![0.0; a.len()],
        };
        let xi = rule.xi();
        for (m, g) in g.chunks_exact(g_mean.len()).enumerate() {
            for (tile, (g, g_mean)) in g.chunks(LANES).zip(g_mean.chunks_mut(LANES)).enumerate() {
                let signals = &mut block.pre[tile * movements + m];
                for ((signal, &g_i), g_mean_i) in signals.iter_mut().zip(g).zip(g_mean) {
                    *signal = rule.pre(g_i, *g_mean_i);
                    *g_mean_i = moved(*g_mean_i, g_i, xi);
                }
            }
        }
        for (m, a) in a.chunks_exact(a_mean.len()).enumerate() {
            for (j, (&a_j, a_mean_j)) in a.iter().zip(a_mean.iter_mut()).enumerate() {
                block.post[j * movements + m] = rule.post(a_j, *a_mean_j);
                *a_mean_j = moved(*a_mean_j, a_j, xi);
            }
        }
        block
    }

    /// The rule for all weights `w` (outputs × `n_in`), in the threads of the current rayon pool if
    /// there is enough to do.
    pub(super) fn learn(&self, w: &mut [f32], n_in: usize) {
        #[cfg(feature = "threads")]
        if w.len() * self.movements >= PARALLEL {
            return w
                .par_chunks_mut(NEURONS * n_in)
                .zip(self.post.par_chunks(NEURONS * self.movements))
                .for_each(|(w, post)| self.learn_neurons(w, post, n_in));
        }
        let neurons = w.chunks_mut(NEURONS * n_in);
        for (w, post) in neurons.zip(self.post.chunks(NEURONS * self.movements)) {
            self.learn_neurons(w, post, n_in);
        }
    }

    /// The rule for the weights of some output neurons with the signals `post`.
    fn learn_neurons(&self, w: &mut [f32], post: &[f32], n_in: usize) {
        // Listed once, about half of them silent, so that no tile has to branch.
        let active: Vec<Vec<(usize, f32)>> = post
            .chunks_exact(self.movements)
            .map(|post| {
                post.iter()
                    .copied()
                    .enumerate()
                    .filter(|&(_, signal)| signal != 0.0)
                    .collect()
            })
            .collect();
        for (tile, pre) in self.pre.chunks_exact(self.movements).enumerate() {
            for (w_j, active) in w.chunks_exact_mut(n_in).zip(&active) {
                let end = n_in.min((tile + 1) * LANES);
                self.learn_tile(&mut w_j[tile * LANES..end], active, pre);
            }
        }
    }

    /// The rule for the weights of one tile, one movement after the other.
    fn learn_tile(&self, weights: &mut [f32], active: &[(usize, f32)], pre: &[[f32; LANES]]) {
        let mut w = [0.0; LANES];
        w[..weights.len()].copy_from_slice(weights);
        for &(m, post) in active {
            let pre = &pre[m];
            for lane in 0..LANES {
                w[lane] += self.rule.change(post, pre[lane], w[lane]);
            }
        }
        weights.copy_from_slice(&w[..weights.len()]);
    }
}

/// A running average after an activity `x`: ξ of the old value, 1 - ξ of the new.
pub(super) fn moved(mean: f32, x: f32, xi: f32) -> f32 {
    let moved = xi * mean + (1.0 - xi) * x;
    if moved < FADED { 0.0 } else { moved }
}
