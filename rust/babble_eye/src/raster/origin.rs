//! The pixel from which the forms of one surface count columns and rows.

use nalgebra::{Matrix3, Vector3};

use super::image_plane::{ImagePlane, index_range};
use super::window::Window;

/// A pixel from which columns x and rows y are counted, to the right and down,
/// in the forms of one surface. Near it f32 is exact enough for depths.
///
/// A ray is d = B (x, y, 1), so a linear form l of d is Bᵀ l in (x, y, 1), and
/// a quadratic form Q is Bᵀ Q B.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin {
    pub(crate) column: usize,
    pub(crate) row: usize,
    /// X and Y there.
    ray: [f64; 2],
    pitch: f64,
}

impl Origin {
    /// The middle of a window. It must not depend on which part of the image
    /// is drawn, so that a pixel has the same depth and colour in each.
    pub(crate) fn middle(window: &Window, plane: &ImagePlane) -> Self {
        let column = usize::midpoint(window.columns.0, window.columns.1);
        let row = usize::midpoint(window.rows.0, window.rows.1);
        Self {
            column,
            row,
            ray: [plane.x(column), plane.y(row)],
            pitch: plane.pitch,
        }
    }

    /// The columns with x in [low, high], counted from here.
    pub(crate) fn columns(&self, plane: &ImagePlane, [low, high]: [f64; 2]) -> (usize, usize) {
        let start = self.column as f64;
        index_range(start + low, start + high, plane.width)
    }

    /// Bᵀ l
    pub(crate) fn linear(&self, form: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.ray;
        Vector3::new(
            form.x * self.pitch,
            -form.y * self.pitch,
            form.x * x + form.y * y + form.z,
        )
    }

    /// Bᵀ Q B of a symmetric form.
    pub(crate) fn quadratic(&self, form: &Matrix3<f64>) -> Matrix3<f64> {
        let columns = [0, 1, 2].map(|k| self.linear(&form.column(k).into_owned()));
        let half = Matrix3::from_columns(&columns).transpose();
        let columns = [0, 1, 2].map(|k| self.linear(&half.column(k).into_owned()));
        Matrix3::from_columns(&columns)
    }
}
