//! A surface of a primitive, and the part of the image that it can cover.

use nalgebra::Vector3;

use super::image_plane::ImagePlane;
use super::inverse_depth::InverseDepth;
use super::origin::Origin;
use super::outline::Outline;
use super::surface::SurfaceKind;
use super::window::{Window, meet};

/// A surface of a primitive, with all that drawing it needs.
#[derive(Debug, Clone)]
pub(crate) struct VisibleSurface {
    /// Index of the primitive in the scene.
    pub(crate) primitive: usize,
    /// Pixels that it can cover.
    pub(crate) window: Window,
    pub(crate) kind: SurfaceKind,
    /// The middle of the window, from which outline and depth count.
    pub(crate) origin: Origin,
    pub(crate) outline: Outline,
    pub(crate) depth: InverseDepth,
}

impl VisibleSurface {
    /// Calls `see` with each row in which the surface is seen, and its columns there.
    #[inline]
    pub(crate) fn rows(
        &self,
        within: &Window,
        plane: &ImagePlane,
        mut see: impl FnMut(usize, (usize, usize)),
    ) {
        // Some rows at a time: what is done with a row depends on its columns
        // in ways that a processor cannot foresee, so they must be there early.
        const ROWS: usize = 16;
        let mut intervals = [[0.0; 2]; ROWS];
        let mut columns = [(0, 0); ROWS];
        let mut first = within.rows.0;
        while first < within.rows.1 {
            let count = ROWS.min(within.rows.1 - first);
            let y = first as f64 - self.origin.row as f64;
            self.outline.intervals(y, &mut intervals[..count]);
            for (columns, interval) in columns.iter_mut().zip(&intervals[..count]) {
                *columns = meet(self.origin.columns(plane, *interval), within.columns);
            }
            for (j, columns) in (first..).zip(&columns[..count]) {
                if columns.0 < columns.1 {
                    see(j, *columns);
                }
            }
            first += count;
        }
    }

    /// The largest inverse depth it can have in a window.
    pub(crate) fn nearest_in(&self, window: &Window, plane: &ImagePlane) -> f64 {
        at_corners(&self.kind.above(), window, plane)
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// The smallest inverse depth at which it can be seen, at least 0.
    pub(crate) fn farthest(&self, plane: &ImagePlane) -> f64 {
        at_corners(&self.kind.below(), &self.window, plane)
            .into_iter()
            .fold(f64::INFINITY, f64::min)
            .max(0.0)
    }
}

/// Values of a linear form of d at the corners of a window; the others are between them.
fn at_corners(form: &Vector3<f64>, window: &Window, plane: &ImagePlane) -> [f64; 4] {
    let (left, right) = (window.columns.0, window.columns.1.max(1) - 1);
    let (top, bottom) = (window.rows.0, window.rows.1.max(1) - 1);
    [(left, top), (left, bottom), (right, top), (right, bottom)]
        .map(|(i, j)| form.dot(&Vector3::new(plane.x(i), plane.y(j), 1.0)))
}
