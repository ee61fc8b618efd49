//! Inverse depths along a row of pixels, in columns x and rows y from a
//! surface's [origin](super::origin::Origin).

use nalgebra::{Matrix3, Vector3};

/// A linear form: coefficients of (x, y, 1).
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearForm([f32; 3]);

impl LinearForm {
    pub(crate) fn new(form: &Vector3<f64>) -> Self {
        Self([form.x as f32, form.y as f32, form.z as f32])
    }

    /// Its values along row y.
    #[inline]
    pub(crate) fn row(&self, y: f32) -> impl Fn(f32) -> f32 + use<> {
        let [slope, down, offset] = self.0;
        let offset = offset + down * y;
        move |x| offset + slope * x
    }
}

/// The inverse depth of a quadric: w = l · d + √D with the linear form l and
/// the quadratic form D.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadricDepth {
    linear: LinearForm,
    /// Coefficients of x², xy, y², x, y, 1.
    square: [f32; 6],
}

impl QuadricDepth {
    pub(crate) fn new(linear: &Vector3<f64>, d: &Matrix3<f64>) -> Self {
        let square = [d.m11, 2.0 * d.m12, d.m22, 2.0 * d.m13, 2.0 * d.m23, d.m33];
        Self {
            linear: LinearForm::new(linear),
            square: square.map(|coefficient| coefficient as f32),
        }
    }

    #[inline]
    pub(crate) fn row(&self, y: f32) -> impl Fn(f32) -> f32 + use<> {
        let linear = self.linear.row(y);
        let [xx, xy, yy, x1, y1, one] = self.square;
        let (slope, offset) = (xy * y + x1, (yy * y + y1) * y + one);
        move |x| {
            let square = (xx * x + slope) * x + offset;
            linear(x) + (if square > 0.0 { square } else { 0.0 }).sqrt()
        }
    }
}

/// The inverse depth of a cylinder's side, 0 beyond its ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CylinderDepth {
    square: QuadricDepth,
    along: LinearForm,
    start: f32,
}

impl CylinderDepth {
    pub(crate) fn new(square: QuadricDepth, along: &Vector3<f64>, start: f64) -> Self {
        Self {
            square,
            along: LinearForm::new(along),
            start: start as f32,
        }
    }

    #[inline]
    pub(crate) fn row(&self, y: f32) -> impl Fn(f32) -> f32 + use<> {
        let (square, along, start) = (self.square.row(y), self.along.row(y), self.start);
        move |x| {
            let w = square(x);
            let place = along(x) - start * w;
            if place >= 0.0 && place <= w { w } else { 0.0 }
        }
    }
}

/// The inverse depth of a surface \[1/m\].
#[derive(Debug, Clone, Copy)]
pub(crate) enum InverseDepth {
    Flat(LinearForm),
    Ball(QuadricDepth),
    Side(CylinderDepth),
}

impl InverseDepth {
    pub(crate) fn flat(form: &Vector3<f64>) -> Self {
        Self::Flat(LinearForm::new(form))
    }
}
