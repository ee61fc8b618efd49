//! Surfaces along one row of pixels, in closed form.
//!
//! A pixel's ray is d = (X, Y, 1) in the camera frame, so a point on it at
//! depth z is z d. Everything here is in terms of the inverse depth w = 1/z,
//! which is linear in X on a plane and needs no division on a quadric.

use nalgebra::{Matrix3, Vector3};

/// The image plane: pixel index to ray and back.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lens {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) focal_px: f64,
    pitch: f64,
}

impl Lens {
    pub(super) fn new(camera: &super::Pinhole) -> Self {
        Self {
            width: camera.width,
            height: camera.height,
            focal_px: camera.focal_px,
            pitch: 1.0 / camera.focal_px,
        }
    }

    /// X of the centres of pixels in column i.
    pub(super) fn x(&self, i: usize) -> f64 {
        (i as f64 + 0.5 - 0.5 * self.width as f64) * self.pitch
    }

    /// Y of the centres of pixels in row j.
    pub(super) fn y(&self, j: usize) -> f64 {
        (0.5 * self.height as f64 - 0.5 - j as f64) * self.pitch
    }

    /// The columns whose centres have X in [low, high].
    pub(super) fn columns(&self, [low, high]: [f64; 2]) -> (usize, usize) {
        let middle = 0.5 * self.width as f64 - 0.5;
        index_range(
            middle + self.focal_px * low,
            middle + self.focal_px * high,
            self.width,
        )
    }

    /// The rows whose centres have Y in [low, high].
    pub(super) fn rows(&self, [low, high]: [f64; 2]) -> (usize, usize) {
        let middle = 0.5 * self.height as f64 - 0.5;
        index_range(
            middle - self.focal_px * high,
            middle - self.focal_px * low,
            self.height,
        )
    }

    /// A linear form along a row, as coefficients of (1, δ) in the number δ of
    /// columns to the right of column i.
    pub(super) fn linear_about(&self, form: &Vector3<f64>, y: f64, i: usize) -> [f32; 2] {
        let [slope, offset] = along_row(form, y);
        [
            (slope * self.x(i) + offset) as f32,
            (slope * self.pitch) as f32,
        ]
    }

    /// A quadratic in X, as coefficients of (1, δ, δ²) in the number δ of
    /// columns to the right of column i.
    pub(super) fn quadratic_about(&self, [a, b, c]: [f64; 3], i: usize) -> [f32; 3] {
        let x = self.x(i);
        [
            ((a * x + b) * x + c) as f32,
            ((2.0 * a * x + b) * self.pitch) as f32,
            (a * self.pitch * self.pitch) as f32,
        ]
    }
}

/// Whole numbers i with low ≤ i ≤ high and 0 ≤ i < count, as a half-open
/// range. NaN gives the whole range on its side.
fn index_range(low: f64, high: f64, count: usize) -> (usize, usize) {
    let low = low.max(0.0).min(count as f64);
    let first = low as usize;
    let first = first + usize::from((first as f64) < low);
    let end = if high < 0.0 {
        0
    } else {
        high.min(count as f64 - 1.0) as usize + 1
    };
    (first, end)
}

/// An empty interval of X.
pub(super) const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// A linear form along a row: [slope, offset] in X.
pub(super) fn along_row(form: &Vector3<f64>, y: f64) -> [f64; 2] {
    [form.x, form.y * y + form.z]
}

/// A cone of rays from the camera: those with (l · d)² ≥ dᵀ Q d and l · d > 0.
/// Spheres, cylinders and flat discs are all seen within such a cone.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    /// l
    pub(super) linear: Vector3<f64>,
    /// Q, symmetric and positive semidefinite.
    pub(super) form: Matrix3<f64>,
}

impl Cone {
    /// Coefficients of D(X) = (l · d)² − dᵀ Q d, highest power first.
    pub(super) fn discriminant(&self, y: f64) -> [f64; 3] {
        let [slope, offset] = along_row(&self.linear, y);
        let q = &self.form;
        [
            slope * slope - q.m11,
            2.0 * (slope * offset - q.m12 * y - q.m13),
            offset * offset - (q.m22 * y + 2.0 * q.m23) * y - q.m33,
        ]
    }

    /// The interval of X in which a row's rays are inside of the cone.
    pub(super) fn interval(&self, y: f64, discriminant: [f64; 3]) -> [f64; 2] {
        solve(discriminant, along_row(&self.linear, y))
    }
}

/// Where a X² + b X + c ≥ 0 and slope X + offset > 0, provided that the
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

/// The part of an interval where slope X + offset ≥ 0.
pub(super) fn clip([low, high]: [f64; 2], [slope, offset]: [f64; 2]) -> [f64; 2] {
    let root = -offset / slope;
    if slope > 0.0 {
        [low.max(root), high]
    } else if slope < 0.0 {
        [low, high.min(root)]
    } else if offset >= 0.0 {
        [low, high]
    } else {
        NOWHERE
    }
}
