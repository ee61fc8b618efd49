//! `LᵀDL` factors of matrices with the tree's sparsity.
//!
//! Velocities are ordered from the root outwards: the ball, shoulder and elbow, then digit by digit.
//! A row's entries are those of its ancestors, and elimination from the tips inwards adds none
//! (Featherstone, *Rigid Body Dynamics Algorithms*, Sect. 6.5). The ball counts as everybody's
//! ancestor, as contacts join it to any link. A row keeps its trunk first and then its own digit, so
//! that loops over either are short and of the same length for all rows.
//!
//! `FIRST` is the first velocity of an operation: 0, or [`BALL`] for the joints alone.

use std::array;
use std::ops::Range;

use crate::robot::kinematics::MAX_JOINTS;
use crate::robot::links::{FOREARM, Link};

/// Velocities of the ball.
pub(super) const BALL: usize = 6;
/// The ball's, the shoulder's and the elbow's: ancestors of all digits.
const TRUNK: usize = BALL + FOREARM + 1;
/// Most joints of a digit: the thumb's.
pub(super) const DIGIT: usize = 4;
/// Most velocities.
pub(super) const SIZE: usize = BALL + MAX_JOINTS;

/// Velocities: of the ball (3), its spin (3), the joints.
pub(super) type Velocities = [f64; SIZE];

/// The entries of a velocity and its ancestors: the trunk's, then those of the own digit.
pub(super) type Row = [f64; TRUNK + DIGIT];

/// A symmetric matrix: the lower triangle, of which ancestors alone count.
pub(super) type Matrix = [Row; SIZE];

/// Who is whose ancestor.
#[derive(Debug, Clone)]
pub(super) struct Sparsity {
    size: usize,
    /// Where the digit of each velocity begins; the trunk begins at 0.
    digit: [usize; SIZE],
    /// The column of each velocity in its own row and those of its digit.
    columns: [usize; SIZE],
}

impl Sparsity {
    pub(super) fn of(links: &[Link]) -> Self {
        let mut digit = [0; SIZE];
        for (i, link) in links.iter().enumerate().skip(FOREARM + 1) {
            digit[BALL + i] = match link.parent {
                Some(FOREARM) | None => BALL + i,
                Some(parent) => digit[BALL + parent],
            };
        }
        Self {
            size: BALL + links.len(),
            digit,
            columns: array::from_fn(|k| match k - digit[k] {
                from_trunk if k < TRUNK => from_trunk,
                from_knuckle => TRUNK + from_knuckle,
            }),
        }
    }

    /// The joints'.
    pub(super) const fn joints(&self) -> Range<usize> {
        BALL..self.size
    }

    /// How many there are.
    pub(super) const fn size(&self) -> usize {
        self.size
    }

    /// The column of velocity `k` in the rows that have it.
    pub(super) const fn column(&self, k: usize) -> usize {
        self.columns[k]
    }

    /// Ancestors of velocity `k` in its own digit, and how many they are.
    fn ancestors(&self, k: usize) -> (Range<usize>, usize) {
        let first = self.digit[k];
        (first..k, (k - first).min(DIGIT - 1))
    }

    /// Factors the rows from `FIRST` to `end` in place. The trunk's upper triangle is scratch: loops over
    /// the whole trunk are quicker than loops that end at the diagonal.
    pub(super) fn factor<const FIRST: usize>(&self, matrix: &mut Matrix, end: usize) {
        for k in (TRUNK..end).rev() {
            if matrix[k][..BALL] == [0.0; BALL] {
                // No contact joins it to the ball.
                self.eliminate::<BALL>(matrix, k);
            } else {
                self.eliminate::<FIRST>(matrix, k);
            }
        }
        if end > BALL {
            factor_trunk::<FIRST, TRUNK>(matrix);
        } else {
            factor_trunk::<FIRST, BALL>(matrix);
        }
    }

    /// Eliminates velocity `k` of a digit from the rows of its ancestors.
    fn eliminate<const FIRST: usize>(&self, matrix: &mut Matrix, k: usize) {
        let (ancestors, count) = self.ancestors(k);
        let (trunk, digits) = matrix.split_at_mut(TRUNK);
        let (above, rest) = digits.split_at_mut(k - TRUNK);
        let row = &mut rest[0];
        let inverse = 1.0 / row[TRUNK + count];
        row[TRUNK + count] = inverse;
        for i in FIRST..TRUNK {
            let share = row[i] * inverse;
            // To the diagonal, in whole pairs.
            for j in FIRST..=(i | 1) {
                trunk[i][j] -= share * row[j];
            }
        }
        let own = above[ancestors.start - TRUNK..].iter_mut().take(count);
        for (i, above) in own.enumerate() {
            let share = row[TRUNK + i] * inverse;
            subtract_trunk::<FIRST>(above, row, share);
            for j in TRUNK..=TRUNK + i {
                above[j] -= share * row[j];
            }
        }
        row[FIRST..TRUNK + count]
            .iter_mut()
            .for_each(|x| *x *= inverse);
    }

    /// Solves for the velocities from `FIRST` to `end`, with factors of their rows; `b` becomes the
    /// solution.
    pub(super) fn solve<const FIRST: usize>(
        &self,
        factors: &Matrix,
        b: &mut Velocities,
        end: usize,
    ) {
        for k in (TRUNK..end).rev() {
            let (row, value) = (&factors[k], b[k]);
            for i in FIRST..TRUNK {
                b[i] -= row[i] * value;
            }
            let (ancestors, _) = self.ancestors(k);
            for (b_i, x) in b[ancestors].iter_mut().zip(&row[TRUNK..]) {
                *b_i -= x * value;
            }
        }
        if end > BALL {
            solve_trunk::<FIRST, TRUNK>(factors, b);
        } else {
            solve_trunk::<FIRST, BALL>(factors, b);
        }
        for k in TRUNK..end {
            let row = &factors[k];
            let (ancestors, count) = self.ancestors(k);
            let mut value = b[k] * row[TRUNK + count];
            for i in FIRST..TRUNK {
                value -= row[i] * b[i];
            }
            for (b_i, x) in b[ancestors].iter().zip(&row[TRUNK..]) {
                value -= x * b_i;
            }
            b[k] = value;
        }
    }

    /// The product of the rows up to `end` with a vector, for a matrix in which nothing joins the ball to
    /// anything.
    pub(super) fn product(&self, matrix: &Matrix, x: &Velocities, end: usize) -> Velocities {
        let mut product = [0.0; SIZE];
        for k in 0..BALL {
            product[k] += matrix[k][k] * x[k];
        }
        for k in BALL..end.min(TRUNK) {
            let row = &matrix[k];
            let mut sum = row[k] * x[k];
            for i in BALL..k {
                sum += row[i] * x[i];
                product[i] += row[i] * x[k];
            }
            product[k] += sum;
        }
        for k in TRUNK..end {
            let row = &matrix[k];
            let (ancestors, count) = self.ancestors(k);
            let mut sum = row[TRUNK + count] * x[k];
            for i in BALL..TRUNK {
                sum += row[i] * x[i];
                product[i] += row[i] * x[k];
            }
            let own = product[ancestors.clone()].iter_mut().zip(&x[ancestors]);
            for ((product, x_i), entry) in own.zip(&row[TRUNK..]) {
                sum += entry * x_i;
                *product += entry * x[k];
            }
            product[k] += sum;
        }
        product
    }
}

fn factor_trunk<const FIRST: usize, const END: usize>(matrix: &mut Matrix) {
    for k in (FIRST..END).rev() {
        let (above, rest) = matrix.split_at_mut(k);
        let row = &mut rest[0];
        let inverse = 1.0 / row[k];
        row[k] = inverse;
        for i in FIRST..k {
            subtract_trunk::<FIRST>(&mut above[i], row, row[i] * inverse);
        }
        row[FIRST..k].iter_mut().for_each(|x| *x *= inverse);
    }
}

fn solve_trunk<const FIRST: usize, const END: usize>(factors: &Matrix, b: &mut Velocities) {
    for k in (FIRST..END).rev() {
        let (row, value) = (&factors[k], b[k]);
        for i in FIRST..k {
            b[i] -= row[i] * value;
        }
    }
    for k in FIRST..END {
        let row = &factors[k];
        let mut value = b[k] * row[k];
        for i in FIRST..k {
            value -= row[i] * b[i];
        }
        b[k] = value;
    }
}

fn subtract_trunk<const FIRST: usize>(from: &mut Row, row: &Row, share: f64) {
    for j in FIRST..TRUNK {
        from[j] -= share * row[j];
    }
}
