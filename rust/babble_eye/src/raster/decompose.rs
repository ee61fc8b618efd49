//! Decomposes the primitives of a scene into the surfaces that a camera may see.

use nalgebra::{Matrix3, Vector3};

use super::image_plane::ImagePlane;
use super::origin::Origin;
use super::surface::{Ends, FlatSurface, Quadric, SurfaceKind};
use super::visible_surface::VisibleSurface;
use super::window::{Frustum, Window, ball_window, corners_window};
use crate::camera::Pinhole;
use crate::scene::{Primitive, Shape};

/// Collects the surfaces of primitives that one camera may see.
pub(crate) struct Decomposer<'a> {
    pub(crate) camera: &'a Pinhole,
    pub(crate) plane: ImagePlane,
    /// Surfaces outside of this window are left out.
    pub(crate) view: Window,
    frustum: Frustum,
    /// The visible surfaces so far.
    pub(crate) surfaces: Vec<VisibleSurface>,
}

impl<'a> Decomposer<'a> {
    pub(crate) fn new(camera: &'a Pinhole) -> Self {
        let plane = ImagePlane::new(camera);
        let view = Window::frame(&plane);
        Self {
            camera,
            plane,
            view,
            frustum: Frustum::new(&plane, &view, 0.0),
            surfaces: Vec::new(),
        }
    }

    /// From now on, leaves out surfaces outside of this window, and shapes of which all has a smaller
    /// inverse depth than `farthest` \[1/m\].
    pub(crate) fn set_view(&mut self, view: Window, farthest: f64) {
        self.view = view;
        self.frustum = Frustum::new(&self.plane, &view, farthest);
    }

    /// Adds the surfaces of one primitive.
    pub(crate) fn add(&mut self, primitive: usize, shape: &Shape) {
        match shape {
            Shape::Sphere { centre, radius } => {
                let centre = self.camera.camera_from_world(centre);
                self.ball(primitive, centre, *radius);
            }
            Shape::Capsule { a, b, radius } => {
                let (a, b) = self.ends(a, b);
                self.capsule(primitive, [a, b], *radius);
            }
            Shape::Cylinder { a, b, radius } => {
                let (a, b) = self.ends(a, b);
                self.cylinder(primitive, [a, b], *radius);
            }
            Shape::Cuboid {
                centre,
                rotation,
                half_extents,
            } => {
                let centre = self.camera.camera_from_world(centre);
                if !self.frustum.misses(&[centre], half_extents.norm()) {
                    let axes = self.camera.rotation * rotation;
                    self.cuboid(primitive, centre, &axes, half_extents);
                }
            }
            Shape::Ground {
                height,
                centre,
                half_extents,
                ..
            } => {
                self.ground(primitive, *height, *centre, *half_extents);
            }
        }
    }

    fn ends(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (
            self.camera.camera_from_world(a),
            self.camera.camera_from_world(b),
        )
    }

    fn push(&mut self, primitive: usize, window: Window, kind: SurfaceKind) {
        let origin = Origin::middle(&window, &self.plane);
        let (outline, depth) = kind.forms(&origin);
        self.surfaces.push(VisibleSurface {
            primitive,
            window,
            kind,
            origin,
            outline,
            depth,
        });
    }

    /// Whether a part of `window` is in view.
    pub(crate) fn sees(&self, window: &Window) -> bool {
        !window.overlap(&self.view).is_empty()
    }

    fn ball(&mut self, primitive: usize, centre: Vector3<f64>, radius: f64) {
        let window = ball_window(&self.plane, &centre, radius);
        self.ball_part(primitive, window, centre, radius, None);
    }

    /// A ball, or with `outward` the half of one on the side of that vector.
    fn ball_part(
        &mut self,
        primitive: usize,
        window: Window,
        centre: Vector3<f64>,
        radius: f64,
        outward: Option<Vector3<f64>>,
    ) {
        if self.frustum.misses(&[centre], radius) || !self.sees(&window) {
            return;
        }
        if let Some(quadric) = Quadric::new(centre, Matrix3::identity(), radius) {
            self.push(primitive, window, SurfaceKind::Ball(quadric, outward));
        }
    }

    fn side(&mut self, primitive: usize, window: Window, [a, b]: [Vector3<f64>; 2], radius: f64) {
        let axis = b - a;
        let square = axis.norm_squared();
        if square == 0.0 {
            return;
        }
        let across = Matrix3::identity() - axis * axis.transpose() / square;
        let along = axis / square;
        let ends = Ends {
            along,
            start: along.dot(&a),
        };
        if let Some(quadric) = Quadric::new(a, across, radius) {
            self.push(primitive, window, SurfaceKind::Side(quadric, ends));
        }
    }

    fn capsule(&mut self, primitive: usize, [a, b]: [Vector3<f64>; 2], radius: f64) {
        if self.frustum.misses(&[a, b], radius) {
            return;
        }
        let ends = [a, b].map(|end| ball_window(&self.plane, &end, radius));
        // The hull of the ends, but where the camera's plane cuts between them.
        let window = if a.z.min(b.z) > radius || a.z.max(b.z) <= -radius {
            ends[0].hull(&ends[1])
        } else {
            Window::frame(&self.plane)
        };
        if distance_to_segment(&a, &b) > radius && self.sees(&window) {
            self.side(primitive, window, [a, b], radius);
            let outward = (b - a).try_normalize(0.0);
            self.ball_part(primitive, ends[0], a, radius, outward.map(|axis| -axis));
            self.ball_part(primitive, ends[1], b, radius, outward);
        }
    }

    fn cylinder(&mut self, primitive: usize, [a, b]: [Vector3<f64>; 2], radius: f64) {
        let Some(axis) = (b - a).try_normalize(0.0) else {
            return;
        };
        let [u, v] = perpendicular(&axis).map(|unit| unit * radius);
        let corners = [a, b].map(|end| [end + u + v, end + u - v, end - u + v, end - u - v]);
        let window = corners_window(&self.plane, corners.as_flattened());
        if !self.sees(&window) {
            return;
        }
        self.side(primitive, window, [a, b], radius);
        for (end, outward) in [(a, -axis), (b, axis)] {
            if let Some(flat) = FlatSurface::new(end, [u, v], outward) {
                self.push(primitive, window, SurfaceKind::Ellipse(flat));
            }
        }
    }

    fn cuboid(
        &mut self,
        primitive: usize,
        centre: Vector3<f64>,
        axes: &Matrix3<f64>,
        half_extents: &Vector3<f64>,
    ) {
        for k in 0..3 {
            let axis = axes.column(k).into_owned();
            let half = [(k + 1) % 3, (k + 2) % 3].map(|i| axes.column(i) * half_extents[i]);
            for outward in [axis, -axis] {
                let middle = centre + outward * half_extents[k];
                self.rectangle(primitive, middle, half, outward);
            }
        }
    }

    fn ground(&mut self, primitive: usize, height: f64, [x, y]: [f64; 2], half: [f64; 2]) {
        let camera = self.camera;
        let centre = camera.camera_from_world(&Vector3::new(x, y, height));
        let axis = |k| camera.rotation.column(k).into_owned();
        let half = [axis(0) * half[0], axis(1) * half[1]];
        self.rectangle(primitive, centre, half, axis(2));
    }

    fn rectangle(
        &mut self,
        primitive: usize,
        centre: Vector3<f64>,
        half: [Vector3<f64>; 2],
        outward: Vector3<f64>,
    ) {
        if outward.dot(&centre) >= 0.0 {
            return;
        }
        let window = self.flat_window(&centre, half);
        if !self.sees(&window) {
            return;
        }
        if let Some(flat) = FlatSurface::new(centre, half, outward) {
            self.push(primitive, window, SurfaceKind::Rectangle(flat));
        }
    }

    /// Window of the parallelogram with the given half axes.
    pub(crate) fn flat_window(&self, centre: &Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> Window {
        let corners = [a + b, a - b, b - a, -a - b].map(|offset| centre + offset);
        corners_window(&self.plane, &corners)
    }
}

/// The surfaces of a scene that may be seen in a window; without one, in the whole image.
pub(crate) fn decompose<'a>(
    scene: &[Primitive],
    camera: &'a Pinhole,
    view: Option<Window>,
) -> Decomposer<'a> {
    let mut decomposer = Decomposer::new(camera);
    if let Some(view) = view {
        decomposer.set_view(view, 0.0);
    }
    decomposer.surfaces.reserve(3 * scene.len());
    for (index, primitive) in scene.iter().enumerate() {
        decomposer.add(index, &primitive.shape);
    }
    decomposer
}

/// Two unit vectors perpendicular to a unit vector and to each other.
pub(crate) fn perpendicular(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let helper = if axis.x.abs() < 0.6 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let u = axis.cross(&helper).normalize();
    [u, axis.cross(&u)]
}

/// Distance of the origin to a segment.
fn distance_to_segment(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let axis = b - a;
    let square = axis.norm_squared();
    let share = if square > 0.0 {
        (-a.dot(&axis) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + axis * share).norm()
}
