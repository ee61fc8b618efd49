//! A primitive, taken apart into surfaces that each have a closed form along
//! a row of pixels: ball, cylinder side, rectangle and ellipse.

use nalgebra::{Matrix3, Vector3};

use super::row::{Cone, Lens};
use super::{Pinhole, Primitive, Shape};

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
        let meet = |a: (usize, usize), b: (usize, usize)| (a.0.max(b.0), a.1.min(b.1));
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

/// A ball or the side of a cylinder. Its inverse depth is
/// w = l · d + √((l · d)² − dᵀ Q d), the nearer of the two intersections.
#[derive(Debug, Clone)]
pub(super) struct Quadric {
    pub(super) cone: Cone,
    /// Centre of the ball, or a point on the axis, in the camera frame [m].
    pub(super) centre: Vector3<f64>,
    /// Identity for a ball; projection along the axis for a cylinder.
    pub(super) across: Matrix3<f64>,
    pub(super) radius: f64,
}

impl Quadric {
    /// `None` if the camera is inside.
    fn new(centre: Vector3<f64>, across: Matrix3<f64>, radius: f64) -> Option<Self> {
        let nearest = across * centre;
        let power = nearest.norm_squared() - radius * radius;
        (power > 0.0).then(|| Self {
            cone: Cone {
                linear: nearest / power,
                form: across / power,
            },
            centre,
            across,
            radius,
        })
    }
}

/// Where a cylinder's side ends: 0 ≤ along · d − start w ≤ w.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    pub(super) along: Vector3<f64>,
    pub(super) start: f64,
}

/// A flat surface with inverse depth w · d and two coordinates (u · d) / (w · d)
/// and (v · d) / (w · d), which are ±1 at its edges.
#[derive(Debug, Clone)]
pub(super) struct Flat {
    pub(super) w: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    /// Unit normal towards the camera, in the camera frame.
    pub(super) normal: Vector3<f64>,
}

impl Flat {
    /// The parallelogram or ellipse with the given centre and half axes in the
    /// camera frame; `None` if its front, the side of `outward`, is hidden.
    pub(super) fn new(
        centre: Vector3<f64>,
        [a, b]: [Vector3<f64>; 2],
        outward: Vector3<f64>,
    ) -> Option<Self> {
        let distance = outward.dot(&centre);
        let normal = a.cross(&b);
        let area = normal.norm_squared();
        if distance >= 0.0 || area == 0.0 {
            return None;
        }
        let w = outward / distance;
        // Reciprocal vectors of the half axes within the plane.
        let (a_dual, b_dual) = (b.cross(&normal) / area, normal.cross(&a) / area);
        Some(Self {
            w,
            u: a_dual - w * a_dual.dot(&centre),
            v: b_dual - w * b_dual.dot(&centre),
            normal: outward,
        })
    }

    /// The cone through the ellipse u² + v² = w².
    pub(super) fn cone(&self) -> Cone {
        Cone {
            linear: self.w,
            form: self.u * self.u.transpose() + self.v * self.v.transpose(),
        }
    }
}

/// A surface in the camera frame.
#[derive(Debug, Clone)]
pub(super) enum Surface {
    Ball(Quadric),
    Side(Quadric, Ends),
    Rectangle(Flat),
    Ellipse(Flat, Cone),
}

/// A surface of a primitive and the pixels that it can fall on.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Index of the primitive in the scene.
    pub(super) primitive: usize,
    pub(super) window: Window,
    pub(super) surface: Surface,
}

impl Piece {
    /// The largest inverse depth it can have in a window.
    pub(super) fn nearest_in(&self, window: &Window, lens: &Lens) -> f64 {
        match &self.surface {
            Surface::Rectangle(flat) | Surface::Ellipse(flat, _) => {
                let (left, right) = (window.columns.0, window.columns.1.max(1) - 1);
                let (top, bottom) = (window.rows.0, window.rows.1.max(1) - 1);
                [(left, top), (left, bottom), (right, top), (right, bottom)]
                    .map(|(i, j)| flat.w.dot(&Vector3::new(lens.x(i), lens.y(j), 1.0)))
                    .into_iter()
                    .fold(0.0, f64::max)
            }
            Surface::Ball(ball) => inverse(ball.centre.z - ball.radius),
            Surface::Side(..) => f64::INFINITY,
        }
    }
}

/// 1 / z, infinite for points beside or behind the camera.
fn inverse(z: f64) -> f64 {
    if z > 0.0 { 1.0 / z } else { f64::INFINITY }
}

/// Takes primitives apart for one camera.
pub(super) struct Cutter<'a> {
    pub(super) camera: &'a Pinhole,
    pub(super) lens: Lens,
    /// The visible pieces so far.
    pub(super) pieces: Vec<Piece>,
}

impl<'a> Cutter<'a> {
    pub(super) fn new(camera: &'a Pinhole) -> Self {
        Self {
            camera,
            lens: Lens::new(camera),
            pieces: Vec::new(),
        }
    }

    /// Adds the pieces of one primitive.
    pub(super) fn cut(&mut self, primitive: usize, shape: &Shape) {
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
                let axes = self.camera.rotation * rotation;
                self.cuboid(primitive, centre, &axes, half_extents);
            }
            Shape::Ground {
                height,
                centre,
                half_extents,
                ..
            } => {
                let to_camera = self.camera.rotation;
                let centre = self
                    .camera
                    .camera_from_world(&Vector3::new(centre[0], centre[1], *height));
                let half = [
                    to_camera.column(0) * half_extents[0],
                    to_camera.column(1) * half_extents[1],
                ];
                let up = to_camera.column(2).into_owned();
                self.rectangle(primitive, centre, half, up);
            }
        }
    }

    fn ends(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (
            self.camera.camera_from_world(a),
            self.camera.camera_from_world(b),
        )
    }

    fn push(&mut self, primitive: usize, window: Window, surface: Surface) {
        if !window.is_empty() {
            self.pieces.push(Piece {
                primitive,
                window,
                surface,
            });
        }
    }

    fn ball(&mut self, primitive: usize, centre: Vector3<f64>, radius: f64) {
        let window = ball_window(&self.lens, &centre, radius);
        if let Some(quadric) = Quadric::new(centre, Matrix3::identity(), radius) {
            self.push(primitive, window, Surface::Ball(quadric));
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
            self.push(primitive, window, Surface::Side(quadric, ends));
        }
    }

    fn capsule(&mut self, primitive: usize, [a, b]: [Vector3<f64>; 2], radius: f64) {
        let window = self.capsule_window(&a, &b, radius);
        if distance_to_segment(&a, &b) > radius && !window.is_empty() {
            self.side(primitive, window, [a, b], radius);
            self.ball(primitive, a, radius);
            self.ball(primitive, b, radius);
        }
    }

    fn cylinder(&mut self, primitive: usize, [a, b]: [Vector3<f64>; 2], radius: f64) {
        let Some(axis) = (b - a).try_normalize(0.0) else {
            return;
        };
        let [u, v] = perpendicular(&axis).map(|unit| unit * radius);
        let corners = [a, b].map(|end| [end + u + v, end + u - v, end - u + v, end - u - v]);
        let window = corners_window(&self.lens, corners.as_flattened());
        self.side(primitive, window, [a, b], radius);
        for (end, outward) in [(a, -axis), (b, axis)] {
            if let Some(flat) = Flat::new(end, [u, v], outward) {
                let cone = flat.cone();
                self.push(primitive, window, Surface::Ellipse(flat, cone));
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

    fn rectangle(
        &mut self,
        primitive: usize,
        centre: Vector3<f64>,
        half: [Vector3<f64>; 2],
        outward: Vector3<f64>,
    ) {
        if let Some(flat) = Flat::new(centre, half, outward) {
            let window = self.flat_window(&centre, half);
            self.push(primitive, window, Surface::Rectangle(flat));
        }
    }

    /// Window of the parallelogram with the given half axes.
    pub(super) fn flat_window(&self, centre: &Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> Window {
        let corners = [a + b, a - b, b - a, -a - b].map(|offset| centre + offset);
        corners_window(&self.lens, &corners)
    }

    fn capsule_window(&self, a: &Vector3<f64>, b: &Vector3<f64>, radius: f64) -> Window {
        if a.z.min(b.z) > radius || a.z.max(b.z) <= -radius {
            ball_window(&self.lens, a, radius).hull(&ball_window(&self.lens, b, radius))
        } else {
            Window::frame(&self.lens)
        }
    }
}

/// Takes every primitive apart.
pub(super) fn cut_scene<'a>(scene: &[Primitive], camera: &'a Pinhole) -> Cutter<'a> {
    let mut cutter = Cutter::new(camera);
    cutter.pieces.reserve(4 * scene.len());
    for (index, primitive) in scene.iter().enumerate() {
        cutter.cut(index, &primitive.shape);
    }
    cutter
}

/// Two unit vectors perpendicular to a unit vector and to each other.
pub(super) fn perpendicular(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
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
    let way = b - a;
    let square = way.norm_squared();
    let share = if square > 0.0 {
        (-a.dot(&way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + way * share).norm()
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
fn corners_window(lens: &Lens, corners: &[Vector3<f64>]) -> Window {
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
