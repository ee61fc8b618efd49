//! The image plane: pixels and rays.
//!
//! A pixel's ray is d = (X, Y, 1) in the camera frame, so a point on it at
//! depth z is z d. Everything here is in terms of the inverse depth w = 1/z,
//! which is linear in X on a plane and needs no division on a quadric.

use crate::camera::Pinhole;

/// The image plane: pixel index to ray and back.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImagePlane {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) focal_px: f64,
    /// Width of a pixel in X.
    pub(crate) pitch: f64,
}

impl ImagePlane {
    pub(crate) fn new(camera: &Pinhole) -> Self {
        Self {
            width: camera.width,
            height: camera.height,
            focal_px: camera.focal_px,
            pitch: 1.0 / camera.focal_px,
        }
    }

    /// X of the centres of pixels in column i.
    pub(crate) fn x(&self, i: usize) -> f64 {
        (i as f64 + 0.5 - 0.5 * self.width as f64) * self.pitch
    }

    /// Y of the centres of pixels in row j.
    pub(crate) fn y(&self, j: usize) -> f64 {
        (0.5 * self.height as f64 - 0.5 - j as f64) * self.pitch
    }

    /// The columns whose centres have X in [low, high].
    pub(crate) fn columns(&self, [low, high]: [f64; 2]) -> (usize, usize) {
        let middle = 0.5 * self.width as f64 - 0.5;
        index_range(
            middle + self.focal_px * low,
            middle + self.focal_px * high,
            self.width,
        )
    }

    /// The rows whose centres have Y in [low, high].
    pub(crate) fn rows(&self, [low, high]: [f64; 2]) -> (usize, usize) {
        let middle = 0.5 * self.height as f64 - 0.5;
        index_range(
            middle - self.focal_px * high,
            middle - self.focal_px * low,
            self.height,
        )
    }
}

/// Whole numbers i with low ≤ i ≤ high and 0 ≤ i < count, as a half-open
/// range. NaN gives the whole range on its side.
pub(super) fn index_range(low: f64, high: f64, count: usize) -> (usize, usize) {
    // Comparisons, as `max` and `min` are calls in WebAssembly.
    let count = count as f64;
    let low = if low > 0.0 { low } else { 0.0 };
    let low = if low < count { low } else { count };
    // Through i32, which all processors convert to in one instruction.
    let whole = |x: f64| x as i32;
    let first = whole(low);
    let first = first + i32::from(f64::from(first) < low);
    let high = if high < count - 1.0 {
        high
    } else {
        count - 1.0
    };
    let end = if high < 0.0 { 0 } else { whole(high) + 1 };
    (first as usize, end as usize)
}

/// Pixels from one to another, in one direction.
#[inline]
pub(crate) fn offset(to: usize, from: usize) -> f32 {
    (to.cast_signed() - from.cast_signed()) as f32
}
