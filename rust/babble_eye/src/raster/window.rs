//! Windows: rectangular parts of the image that a surface can cover.

use nalgebra::Vector3;

use super::image_plane::ImagePlane;

/// A rectangle of pixels: half-open ranges of columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) columns: (usize, usize),
    pub(crate) rows: (usize, usize),
}

impl Window {
    pub(crate) fn frame(plane: &ImagePlane) -> Self {
        Self {
            columns: (0, plane.width),
            rows: (0, plane.height),
        }
    }

    pub(crate) fn overlap(&self, other: &Self) -> Self {
        Self {
            columns: meet(self.columns, other.columns),
            rows: meet(self.rows, other.rows),
        }
    }

    pub(crate) fn hull(&self, other: &Self) -> Self {
        let join = |a: (usize, usize), b: (usize, usize)| (a.0.min(b.0), a.1.max(b.1));
        Self {
            columns: join(self.columns, other.columns),
            rows: join(self.rows, other.rows),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.columns.0 >= self.columns.1 || self.rows.0 >= self.rows.1
    }

    pub(crate) fn width(&self) -> usize {
        self.columns.1.saturating_sub(self.columns.0)
    }

    pub(crate) fn height(&self) -> usize {
        self.rows.1.saturating_sub(self.rows.0)
    }
}

pub(crate) fn meet(a: (usize, usize), b: (usize, usize)) -> (usize, usize) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// What a window can show: the space between four planes from the camera along its edges, before a
/// plane across the line of sight.
#[derive(Debug, Clone)]
pub(crate) struct Frustum {
    /// Unit normals of the planes through the camera, away from the window.
    outward: [Vector3<f64>; 4],
    /// Depth of the plane across, infinite without one \[m\].
    far: f64,
}

impl Frustum {
    /// With the inverse depth of the plane across \[1/m\].
    pub(crate) fn new(plane: &ImagePlane, window: &Window, farthest: f64) -> Self {
        // Half a pixel beyond the centres of the outermost pixels.
        let pitch = 1.0 / plane.focal_px;
        let [left, right] =
            [window.columns.0, window.columns.1].map(|column| plane.x(column) - 0.5 * pitch);
        let [top, bottom] = [window.rows.0, window.rows.1].map(|row| plane.y(row) + 0.5 * pitch);
        Self {
            outward: [
                Vector3::new(-1.0, 0.0, left).normalize(),
                Vector3::new(1.0, 0.0, -right).normalize(),
                Vector3::new(0.0, 1.0, -top).normalize(),
                Vector3::new(0.0, -1.0, bottom).normalize(),
            ],
            far: 1.0 / farthest,
        }
    }

    /// Whether all within `radius` of the hull of points is beyond one plane.
    pub(crate) fn misses<const N: usize>(&self, points: &[Vector3<f64>; N], radius: f64) -> bool {
        let outside = |normal: &Vector3<f64>| points.iter().all(|p| normal.dot(p) > radius);
        points.iter().all(|point| point.z > self.far + radius) || self.outward.iter().any(outside)
    }
}

/// Window of a ball: its tangent planes through the camera's right and up axes.
pub(crate) fn ball_window(plane: &ImagePlane, centre: &Vector3<f64>, radius: f64) -> Window {
    if centre.z <= -radius {
        return Window {
            columns: (0, 0),
            rows: (0, 0),
        };
    }
    let depth = centre.z * centre.z - radius * radius;
    if centre.z <= radius || depth <= 0.0 {
        return Window::frame(plane);
    }
    let tangents = |offset: f64| {
        let swing = radius * (offset * offset + depth).sqrt();
        [
            (offset * centre.z - swing) / depth,
            (offset * centre.z + swing) / depth,
        ]
    };
    Window {
        columns: plane.columns(tangents(centre.x)),
        rows: plane.rows(tangents(centre.y)),
    }
}

/// Window of the convex hull of points: all of the frame if some lie behind.
pub(crate) fn corners_window(plane: &ImagePlane, corners: &[Vector3<f64>]) -> Window {
    let behind = corners.iter().filter(|p| p.z <= 1e-9).count();
    if behind == corners.len() {
        return Window {
            columns: (0, 0),
            rows: (0, 0),
        };
    }
    if behind > 0 {
        return Window::frame(plane);
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
        columns: plane.columns(span(|p| p.x / p.z)),
        rows: plane.rows(span(|p| p.y / p.z)),
    }
}
