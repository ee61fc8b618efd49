//! Time base generators (Eq. 5) and the placing of their trajectory in the workspace (Eq. 6).
//!
//! Eq. 5 as printed never leaves c = 0 and never arrives at c = 1, and a small seed ε instead of 0
//! changes the duration. So each half of the movement is followed in a variable that is regular
//! at its end; the derivation is in the crate's README.

use crate::error::{BrainError, check_range};

/// Intervals of c in `[0, 1/2]` between which [`Half`] interpolates.
const INTERVALS: usize = 16;
/// Nodes of the interpolation.
const NODES: usize = INTERVALS + 1;
/// Terms of the power series; each is at most half of the one before.
const TERMS: usize = 48;

/// Two time base generators with mirrored parameters, which draw one curved movement from (0, 0)
/// to (1, 1) in a time T (Eq. 5):
///
/// ```text
/// ċx = γ cx^b1 (1 - cx)^b2        ċy = γ cy^b2 (1 - cy)^b1
/// ```
///
/// With b2 = 1 - b1, as in babbling, b1 > 1/2 curves to the left of the straight line.
///
/// ```
/// use babble_brain::TimeBaseGenerator;
///
/// let movement = TimeBaseGenerator::new(0.7, 0.3, 8.0)?;
/// let mut c = vec![[0.0; 2]; 160];
/// movement.sample_into(&mut c);
/// assert_eq!(c[159], [1.0, 1.0]);
/// assert!(c[79][1] > c[79][0]);
/// # Ok::<(), babble_brain::BrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TimeBaseGenerator {
    gamma: f64,
    duration: f64,
    /// cx from 0 to 1/2.
    rise: Half,
    /// 1 - cx from 1/2 back to 0.
    fall: Half,
}

impl TimeBaseGenerator {
    /// Movement with parameters 0 < `b1`, `b2` < 1 and `duration` T > 0 \[s\].
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the parameter.
    pub fn new(b1: f64, b2: f64, duration: f64) -> Result<Self, BrainError> {
        check_range(b1 > 0.0 && b1 < 1.0, "b1", b1, "0 < b1 < 1")?;
        check_range(b2 > 0.0 && b2 < 1.0, "b2", b2, "0 < b2 < 1")?;
        check_range(
            duration > 0.0 && duration.is_finite(),
            "duration",
            duration,
            "finite, 0 < duration",
        )?;
        let (mut rise, mut fall) = (Half::new(b1, b2), Half::new(b2, b1));
        // The two halves add up to B(1 - b1, 1 - b2) = γ T.
        let beta = rise.time + fall.time;
        rise.time /= beta;
        fall.time /= beta;
        Ok(Self {
            gamma: beta / duration,
            duration,
            rise,
            fall,
        })
    }

    /// γ = B(1 - b1, 1 - b2) / T \[1/s\], which is π / (T sin π b1) for b2 = 1 - b1.
    #[must_use]
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// T \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Writes (cx, cy) at the times T k/n, k = 1 … n = `out.len()`; the last is exactly (1, 1).
    ///
    /// Solves Eq. 5 to 1e-7 T in time, or to the last bit of `f64` where that is coarser (a
    /// movement with b1 = b2 = 0.99 spends a third of its time within 1e-16 of its end).
    pub fn sample_into(&self, out: &mut [[f64; 2]]) {
        let n = out.len();
        for k in 1..n {
            let [cx, rest] = self.split(k as f64 / n as f64, (n - k) as f64 / n as f64);
            out[k - 1][0] = cx;
            // Eq. 5 run backwards is Eq. 5 with b1 and b2 swapped: cy(t) = 1 - cx(T - t).
            out[n - k - 1][1] = rest;
        }
        if let Some(last) = out.last_mut() {
            *last = [1.0, 1.0];
        }
    }

    /// cx and 1 - cx when the share `elapsed` of T is over and `left` = 1 - `elapsed` is to come.
    fn split(&self, elapsed: f64, left: f64) -> [f64; 2] {
        if elapsed <= self.rise.time {
            let c = self.rise.position(elapsed);
            [c, 1.0 - c]
        } else {
            let c = self.fall.position(left);
            [1.0 - c, c]
        }
    }
}

/// The solution of ċ = c^b (1 - c)^d from c = 0 to c = 1/2, as a function of
/// x = ((1 - b) t)^(1/(1 - b)), the solution without the factor (1 - c)^d.
#[derive(Debug, Clone, PartialEq)]
struct Half {
    /// Time at which c = 1/2; shares of T once the generator is built.
    time: f64,
    /// 1 / (1 - b).
    power: f64,
    /// ln x at c = 1/2.
    ln_x: f64,
    /// x, c and dc/dx at c = 0, 1/32 … 1/2.
    nodes: [Node; NODES],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    x: f64,
    c: f64,
    slope: f64,
}

impl Half {
    fn new(b: f64, d: f64) -> Self {
        let excess = excess(b, d);
        let power = 1.0 / (1.0 - b);
        let mut nodes = [Node {
            x: 0.0,
            c: 0.0,
            slope: 1.0,
        }; NODES];
        // ln(x / c) = ln(1 + (1 - b) excess) / (1 - b), well conditioned as b -> 1.
        let mut lead = 0.0;
        for (node, &(c, excess)) in nodes.iter_mut().zip(&excess).skip(1) {
            lead = libm::log1p((1.0 - b) * excess) * power;
            node.c = c;
            node.x = c * libm::exp(lead);
            node.slope = libm::exp(d * libm::log1p(-c) - b * lead);
        }
        let ln_x = lead - core::f64::consts::LN_2;
        Self {
            time: power * libm::exp((1.0 - b) * ln_x),
            power,
            ln_x,
            nodes,
        }
    }

    /// c at time `t` ≤ `time`.
    fn position(&self, t: f64) -> f64 {
        let x = libm::exp(self.ln_x + self.power * libm::log(t / self.time));
        let after = self.nodes[1..INTERVALS].partition_point(|node| node.x < x) + 1;
        hermite(self.nodes[after - 1], self.nodes[after], x)
    }
}

/// For each node's c the sum of (d)_k / k! · c^k / (k + 1 - b) over k ≥ 1: the braking factor
/// (1 - c)^-d expanded and integrated term by term.
fn excess(b: f64, d: f64) -> [(f64, f64); NODES] {
    let mut coefficients = [0.0; TERMS];
    let mut binomial = 1.0;
    for (k, coefficient) in (1..).zip(&mut coefficients) {
        let k = f64::from(k);
        binomial *= (d + k - 1.0) / k;
        *coefficient = binomial / (k + 1.0 - b);
    }
    let mut sums = [(0.0, 0.0); NODES];
    for (i, (c, _)) in sums.iter_mut().enumerate() {
        *c = 0.5 * i as f64 / INTERVALS as f64;
    }
    // Horner's scheme for all nodes at once, which the compiler turns into vector instructions.
    for coefficient in coefficients.iter().rev() {
        for (c, sum) in &mut sums {
            *sum = (*sum + coefficient) * *c;
        }
    }
    sums
}

/// Cubic through two nodes and their slopes.
fn hermite(from: Node, to: Node, x: f64) -> f64 {
    let h = to.x - from.x;
    let s = (x - from.x) / h;
    let chord = (to.c - from.c) / h;
    let bend = (chord - from.slope) + (1.0 - s) * (2.0 * chord - from.slope - to.slope);
    // Written around from.c = c(0) = 0, this keeps the leading digits of a small c.
    from.c + h * s * (from.slope + s * bend)
}

/// Eq. 6: the point of the workspace at (cx, cy), for a movement from `start` to `target`
/// (any unit of length).
///
/// Printed as dist · R(θ) · c, this misses the target: (0, 0) → (1, 1) is √2 long and points to
/// 45°. So here it is start + dist/√2 · R(θ - 45°) · c, which is the same as going
/// (cx + cy)/2 of the way and (cx - cy)/2 of the distance to the right of it.
#[must_use]
pub fn place(start: [f64; 2], target: [f64; 2], c: [f64; 2]) -> [f64; 2] {
    let way = [target[0] - start[0], target[1] - start[1]];
    let along = 0.5 * (c[0] + c[1]);
    let right = 0.5 * (c[0] - c[1]);
    [
        start[0] + way[0] * along + way[1] * right,
        start[1] + way[1] * along - way[0] * right,
    ]
}
