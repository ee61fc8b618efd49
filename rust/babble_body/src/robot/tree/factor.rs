//! `LᵀDL` factors of matrices with the tree's sparsity.
//!
//! Velocities are ordered from the root outwards: the ball, shoulder and elbow, then digit by digit.
//! A row's entries are those of its ancestors, and elimination from the tips inwards adds none
//! (Featherstone, *Rigid Body Dynamics Algorithms*, Sect. 6.5). The ball counts as everybody's
//! ancestor, as contacts join it to any link.

use std::ops::Range;

use crate::robot::kinematics::MAX_JOINTS;
use crate::robot::links::{FOREARM, Link};

/// Velocities of the ball.
pub(super) const BALL: usize = 6;
/// The ball's, the shoulder's and the elbow's: ancestors of all digits.
const TRUNK: usize = BALL + FOREARM + 1;
/// Most velocities.
pub(super) const SIZE: usize = BALL + MAX_JOINTS;

/// Velocities: of the ball (3), its spin (3), the joints.
pub(super) type Velocities = [f64; SIZE];

/// A symmetric matrix: the lower triangle, of which ancestors alone count.
pub(super) type Matrix = [[f64; SIZE]; SIZE];

/// Who is whose ancestor.
#[derive(Debug, Clone)]
pub(super) struct Sparsity {
    size: usize,
    /// Where the digit of each velocity begins.
    digit: [usize; SIZE],
}

impl Sparsity {
    pub(super) fn of(links: &[Link]) -> Self {
        let mut digit: [usize; SIZE] = std::array::from_fn(|k| k);
        for (i, link) in links.iter().enumerate().skip(FOREARM + 1) {
            digit[BALL + i] = match link.parent {
                Some(FOREARM) | None => BALL + i,
                Some(parent) => digit[BALL + parent],
            };
        }
        Self {
            size: BALL + links.len(),
            digit,
        }
    }

    /// The joints'.
    pub(super) const fn joints(&self) -> Range<usize> {
        BALL..self.size
    }

    /// All.
    pub(super) const fn all(&self) -> Range<usize> {
        0..self.size
    }

    /// Ancestors of velocity `k`, from `first` on: a range of the trunk and one of the own digit.
    pub(super) fn ancestors(&self, k: usize, first: usize) -> [Range<usize>; 2] {
        [first..k.min(TRUNK).max(first), self.digit[k].min(k)..k]
    }

    /// Factors some rows in place. The upper triangle is scratch: loops over the whole trunk are
    /// quicker than loops that end at the diagonal.
    pub(super) fn factor(&self, matrix: &mut Matrix, rows: &Range<usize>) {
        for k in rows.clone().rev() {
            let (above, rest) = matrix.split_at_mut(k);
            let row = &mut rest[0];
            let inverse = 1.0 / row[k];
            row[k] = inverse;
            let [trunk, digit] = self.ancestors(k, rows.start);
            for i in trunk.clone() {
                let share = row[i] * inverse;
                subtract_trunk(&mut above[i], row, share);
            }
            for i in digit.clone() {
                let share = row[i] * inverse;
                subtract_trunk(&mut above[i], row, share);
                for j in digit.start..=i {
                    above[i][j] -= share * row[j];
                }
            }
            for i in trunk.chain(digit) {
                row[i] *= inverse;
            }
        }
    }

    /// Solves for some velocities, with factors of their rows; `b` becomes the solution.
    pub(super) fn solve(&self, factors: &Matrix, b: &mut [f64; SIZE], rows: &Range<usize>) {
        for k in rows.clone().rev() {
            let (row, value) = (&factors[k], b[k]);
            let [trunk, digit] = self.ancestors(k, rows.start);
            for i in trunk.chain(digit) {
                b[i] -= row[i] * value;
            }
        }
        for k in rows.clone() {
            let row = &factors[k];
            let [trunk, digit] = self.ancestors(k, rows.start);
            let mut value = b[k] * row[k];
            for i in trunk.chain(digit) {
                value -= row[i] * b[i];
            }
            b[k] = value;
        }
    }

    /// The product of some rows with a vector.
    pub(super) fn product(
        &self,
        matrix: &Matrix,
        x: &[f64; SIZE],
        rows: &Range<usize>,
    ) -> [f64; SIZE] {
        let mut product = [0.0; SIZE];
        for k in rows.clone() {
            let row = &matrix[k];
            let mut sum = row[k] * x[k];
            let [trunk, digit] = self.ancestors(k, rows.start);
            for i in trunk.chain(digit) {
                sum += row[i] * x[i];
                product[i] += row[i] * x[k];
            }
            product[k] += sum;
        }
        product
    }
}

fn subtract_trunk(from: &mut [f64; SIZE], row: &[f64; SIZE], share: f64) {
    for j in 0..TRUNK {
        from[j] -= share * row[j];
    }
}
