//! Outlines: where along a row of pixels a surface is seen, in closed form.
//!
//! All forms are in columns x and rows y from a surface's
//! [origin](super::origin::Origin).

use nalgebra::{Matrix3, Vector3};

/// An empty interval of x.
const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// A convex part of the image with straight edges: where linear forms of d
/// are all ≥ 0. Edges are kept as x = p + q y, so that a row needs no division.
#[derive(Debug, Clone)]
pub(crate) struct Edges<const N: usize> {
    /// Lines [p, q] that the part lies to the right of; −∞ where there is none.
    left: [[f64; 2]; N],
    /// Lines that it lies to the left of; +∞ where there is none.
    right: [[f64; 2]; N],
    /// Forms [slope, offset] in y of edges along rows; 1 where there is none.
    level: [[f64; 2]; N],
}

/// An edge is along the rows if x changes its form by less than this share of
/// what the rest of the form does: far less than a pixel over the whole image.
const ALONG_ROWS: f64 = 1e-12;

impl<const N: usize> Edges<N> {
    /// Where all of the forms are ≥ 0.
    pub(crate) fn new(forms: [Vector3<f64>; N]) -> Self {
        let mut edges = Self {
            left: [[f64::NEG_INFINITY, 0.0]; N],
            right: [[f64::INFINITY, 0.0]; N],
            level: [[0.0, 1.0]; N],
        };
        for (k, form) in forms.iter().enumerate() {
            if form.x.abs() <= ALONG_ROWS * (form.y.abs() + form.z.abs()) {
                edges.level[k] = [form.y, form.z];
            } else {
                let inverse = -1.0 / form.x;
                let side = if form.x > 0.0 {
                    &mut edges.left
                } else {
                    &mut edges.right
                };
                side[k] = [form.z * inverse, form.y * inverse];
            }
        }
        edges
    }

    /// The interval of x of row y.
    fn interval(&self, y: f64) -> [f64; 2] {
        let [mut low, mut high] = [NOWHERE[1], NOWHERE[0]];
        let mut inside = true;
        for k in 0..N {
            let at = |[p, q]: [f64; 2]| p + q * y;
            let (left, right) = (at(self.left[k]), at(self.right[k]));
            low = if left > low { left } else { low };
            high = if right < high { right } else { high };
            inside &= self.level[k][0] * y + self.level[k][1] >= 0.0;
        }
        [low, if inside { high } else { NOWHERE[1] }]
    }
}

/// What is seen of a surface.
#[derive(Debug, Clone)]
pub(crate) enum Outline {
    Round(Cone),
    /// A cone cut by an edge.
    Half(Cone, Edges<1>),
    Straight(Edges<4>),
}

impl Outline {
    /// The intervals of x of row y and of the rows below it.
    pub(crate) fn intervals(&self, y: f64, rows: &mut [[f64; 2]]) {
        match self {
            Self::Round(cone) => cone.intervals(y, rows),
            Self::Half(cone, edge) => {
                cone.intervals(y, rows);
                for (row, [low, high]) in (0_i32..).zip(rows) {
                    let [left, right] = edge.interval(y + f64::from(row));
                    *low = if left > *low { left } else { *low };
                    *high = if right < *high { right } else { *high };
                }
            }
            Self::Straight(edges) => fill(y, rows, |y| edges.interval(y)),
        }
    }
}

/// Fills in row y and the rows below it.
#[inline]
fn fill(y: f64, rows: &mut [[f64; 2]], interval: impl Fn(f64) -> [f64; 2]) {
    for (k, row) in (0_i32..).zip(rows) {
        *row = interval(y + f64::from(k));
    }
}

/// A cone of rays from the camera: those with D = (l · d)² − dᵀ Q d ≥ 0 and
/// l · d > 0. Spheres and flat discs are seen within such a cone.
#[derive(Debug, Clone)]
pub(crate) enum Cone {
    Ellipse(Ellipse),
    /// l and the matrix of D, if the image is no ellipse, or hardly.
    Any(Vector3<f64>, Matrix3<f64>),
}

/// How negative the coefficient a of x² in D must be for an ellipse, as a share
/// of (l · d)²'s part in it: then few digits are lost in 1 / a.
const ELLIPSE: f64 = 1e-3;

impl Cone {
    /// From l and the matrix of D.
    pub(crate) fn new(linear: Vector3<f64>, form: Matrix3<f64>) -> Self {
        if form.m11 < -ELLIPSE * linear.x * linear.x {
            Self::Ellipse(Ellipse::new(&linear, &form))
        } else {
            Self::Any(linear, form)
        }
    }

    /// The intervals of x in which rows' rays are inside of the cone.
    fn intervals(&self, y: f64, rows: &mut [[f64; 2]]) {
        match self {
            Self::Ellipse(ellipse) => fill(y, rows, |y| ellipse.interval(y)),
            Self::Any(l, d) => fill(y, rows, |y| {
                let quadratic = [
                    d.m11,
                    2.0 * (d.m12 * y + d.m13),
                    (d.m22 * y + 2.0 * d.m23) * y + d.m33,
                ];
                solve(quadratic, [l.x, l.y * y + l.z])
            }),
        }
    }
}

/// An ellipse, row by row: x = m₀ + m₁ y ± √(s₀ + s₁ y + s₂ y²).
#[derive(Debug, Clone)]
pub(crate) struct Ellipse {
    middle: [f64; 2],
    swing: [f64; 3],
    /// l · d in the middle, which is positive before the camera.
    front: [f64; 2],
}

impl Ellipse {
    fn new(linear: &Vector3<f64>, form: &Matrix3<f64>) -> Self {
        let inverse = 1.0 / form.m11;
        let middle = [-form.m13 * inverse, -form.m12 * inverse];
        let [m0, m1] = middle;
        Self {
            middle,
            swing: [
                m0 * m0 - form.m33 * inverse,
                2.0 * (m0 * m1 - form.m23 * inverse),
                m1 * m1 - form.m22 * inverse,
            ],
            front: [linear.x * m0 + linear.z, linear.x * m1 + linear.y],
        }
    }

    fn interval(&self, y: f64) -> [f64; 2] {
        let [s0, s1, s2] = self.swing;
        let square = (s2 * y + s1) * y + s0;
        let seen = square >= 0.0 && self.front[1] * y + self.front[0] > 0.0;
        let swing = (if square > 0.0 { square } else { 0.0 }).sqrt();
        let swing = if seen { swing } else { f64::NEG_INFINITY };
        let middle = self.middle[1] * y + self.middle[0];
        [middle - swing, middle + swing]
    }
}

/// Where a x² + b x + c ≥ 0 and slope x + offset > 0, provided that the
/// linear form has no zero where the quadratic is positive.
fn solve([a, b, c]: [f64; 3], [slope, offset]: [f64; 2]) -> [f64; 2] {
    let half = 0.5 * b;
    let square = half * half - a * c;
    let row_or_nothing = |inside| {
        if inside {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            NOWHERE
        }
    };
    if square < 0.0 {
        return row_or_nothing(a > 0.0 && offset > 0.0);
    }
    // The sum without cancellation, so that a may go through zero.
    let sum = -(half + square.sqrt().copysign(half));
    if sum == 0.0 {
        return row_or_nothing(a >= 0.0 && c >= 0.0 && offset > 0.0);
    }
    let (p, q) = (sum / a, c / sum);
    let (low, high) = if p < q { (p, q) } else { (q, p) };
    if a < 0.0 {
        if slope * 0.5 * (low + high) + offset > 0.0 {
            [low, high]
        } else {
            NOWHERE
        }
    } else if slope > 0.0 {
        [high, f64::INFINITY]
    } else {
        [f64::NEG_INFINITY, low]
    }
}
