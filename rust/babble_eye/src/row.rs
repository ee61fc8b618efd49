//! The image plane: pixels and rays.
//!
//! A pixel's ray is d = (X, Y, 1) in the camera frame, so a point on it at
//! depth z is z d. Everything here is in terms of the inverse depth w = 1/z,
//! which is linear in X on a plane and needs no division on a quadric.

use nalgebra::{Matrix3, Vector3};

use super::window::Window;

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

    /// The columns with x in [low, high], counted from an origin.
    pub(super) fn columns_from(&self, origin: &Origin, [low, high]: [f64; 2]) -> (usize, usize) {
        let start = origin.column as f64;
        index_range(start + low, start + high, self.width)
    }
}

/// A pixel from which columns x and rows y are counted, to the right and down,
/// in the forms of one piece. Near it f32 is exact enough for depths.
///
/// A ray is d = B (x, y, 1), so a linear form l of d is Bᵀ l in (x, y, 1), and
/// a quadratic form Q is Bᵀ Q B.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin {
    pub(super) column: usize,
    pub(super) row: usize,
    /// X and Y there.
    ray: [f64; 2],
    pitch: f64,
}

impl Origin {
    /// The middle of a window. It must not depend on which part of the image
    /// is drawn, so that a pixel has the same depth and colour in each.
    pub(super) fn middle(window: &Window, lens: &Lens) -> Self {
        let column = usize::midpoint(window.columns.0, window.columns.1);
        let row = usize::midpoint(window.rows.0, window.rows.1);
        Self {
            column,
            row,
            ray: [lens.x(column), lens.y(row)],
            pitch: lens.pitch,
        }
    }

    /// Bᵀ l
    pub(super) fn linear(&self, form: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.ray;
        Vector3::new(
            form.x * self.pitch,
            -form.y * self.pitch,
            form.x * x + form.y * y + form.z,
        )
    }

    /// Bᵀ Q B of a symmetric form.
    pub(super) fn quadratic(&self, form: &Matrix3<f64>) -> Matrix3<f64> {
        let columns = [0, 1, 2].map(|k| self.linear(&form.column(k).into_owned()));
        let half = Matrix3::from_columns(&columns).transpose();
        let columns = [0, 1, 2].map(|k| self.linear(&half.column(k).into_owned()));
        Matrix3::from_columns(&columns)
    }
}

/// Whole numbers i with low ≤ i ≤ high and 0 ≤ i < count, as a half-open
/// range. NaN gives the whole range on its side.
fn index_range(low: f64, high: f64, count: usize) -> (usize, usize) {
    let low = low.max(0.0).min(count as f64);
    // Through i32, which all processors convert to in one instruction.
    let whole = |x: f64| x as i32;
    let first = whole(low);
    let first = first + i32::from(f64::from(first) < low);
    let high = high.min(count as f64 - 1.0);
    let end = if high < 0.0 { 0 } else { whole(high) + 1 };
    (first as usize, end as usize)
}

/// Pixels from one to another, in one direction.
#[inline]
pub(super) fn offset(to: usize, from: usize) -> f32 {
    (to.cast_signed() - from.cast_signed()) as f32
}
