//! Where on the image a surface can fall.

use nalgebra::Vector3;

use super::row::Lens;

/// Pixels a surface can fall on: half-open ranges of columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) columns: (usize, usize),
    pub(super) rows: (usize, usize),
}

impl Window {
    pub(super) fn frame(lens: &Lens) -> Self {
        Self {
            columns: (0, lens.width),
            rows: (0, lens.height),
        }
    }

    pub(super) fn overlap(&self, other: &Self) -> Self {
        Self {
            columns: meet(self.columns, other.columns),
            rows: meet(self.rows, other.rows),
        }
    }

    pub(super) fn hull(&self, other: &Self) -> Self {
        let join = |a: (usize, usize), b: (usize, usize)| (a.0.min(b.0), a.1.max(b.1));
        Self {
            columns: join(self.columns, other.columns),
            rows: join(self.rows, other.rows),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.columns.0 >= self.columns.1 || self.rows.0 >= self.rows.1
    }

    pub(super) fn width(&self) -> usize {
        self.columns.1.saturating_sub(self.columns.0)
    }

    pub(super) fn height(&self) -> usize {
        self.rows.1.saturating_sub(self.rows.0)
    }
}

pub(super) fn meet(a: (usize, usize), b: (usize, usize)) -> (usize, usize) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// The four planes from the camera along the edges of a window.
#[derive(Debug, Clone)]
pub(super) struct Frustum {
    /// Unit normals, away from the window.
    outward: [Vector3<f64>; 4],
}

impl Frustum {
    pub(super) fn new(lens: &Lens, window: &Window) -> Self {
        // Half a pixel beyond the centres of the outermost pixels.
        let pitch = 1.0 / lens.focal_px;
        let [left, right] =
            [window.columns.0, window.columns.1].map(|column| lens.x(column) - 0.5 * pitch);
        let [top, bottom] = [window.rows.0, window.rows.1].map(|row| lens.y(row) + 0.5 * pitch);
        Self {
            outward: [
                Vector3::new(-1.0, 0.0, left).normalize(),
                Vector3::new(1.0, 0.0, -right).normalize(),
                Vector3::new(0.0, 1.0, -top).normalize(),
                Vector3::new(0.0, -1.0, bottom).normalize(),
            ],
        }
    }

    /// Whether all within `radius` of the hull of points is beyond one plane.
    pub(super) fn misses(&self, points: &[Vector3<f64>], radius: f64) -> bool {
        self.outward
            .iter()
            .any(|normal| points.iter().all(|point| normal.dot(point) > radius))
    }
}

/// Window of a ball: its tangent planes through the camera's right and up axes.
pub(super) fn ball_window(lens: &Lens, centre: &Vector3<f64>, radius: f64) -> Window {
    if centre.z <= -radius {
        return Window {
            columns: (0, 0),
            rows: (0, 0),
        };
    }
    let depth = centre.z * centre.z - radius * radius;
    if centre.z <= radius || depth <= 0.0 {
        return Window::frame(lens);
    }
    let tangents = |offset: f64| {
        let swing = radius * (offset * offset + depth).sqrt();
        [
            (offset * centre.z - swing) / depth,
            (offset * centre.z + swing) / depth,
        ]
    };
    Window {
        columns: lens.columns(tangents(centre.x)),
        rows: lens.rows(tangents(centre.y)),
    }
}

/// Window of the convex hull of points: all of the frame if some lie behind.
pub(super) fn corners_window(lens: &Lens, corners: &[Vector3<f64>]) -> Window {
    let behind = corners.iter().filter(|p| p.z <= 1e-9).count();
    if behind == corners.len() {
        return Window {
            columns: (0, 0),
            rows: (0, 0),
        };
    }
    if behind > 0 {
        return Window::frame(lens);
    }
    let span = |coordinate: fn(&Vector3<f64>) -> f64| {
        corners
            .iter()
            .map(coordinate)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
                [low.min(c), high.max(c)]
            })
    };
    Window {
        columns: lens.columns(span(|p| p.x / p.z)),
        rows: lens.rows(span(|p| p.y / p.z)),
    }
}
