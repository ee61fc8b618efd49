//! A primitive, taken apart into surfaces that each have a closed form along
//! a row of pixels: ball, cylinder side, rectangle and ellipse.

use nalgebra::{Matrix3, Vector3};

use super::row::{Cone, Lens};
use super::window::{Window, ball_window, corners_window};
use super::{Pinhole, Primitive, Shape};

/// A ball or the side of a cylinder. Its inverse depth is
/// w = l · d + √((l · d)² − dᵀ Q d), the nearer of the two intersections.
#[derive(Debug, Clone)]
pub(super) struct Quadric {
    pub(super) cone: Cone,
    /// Centre of the ball, or a point on the axis, in the camera frame \[m\].
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
