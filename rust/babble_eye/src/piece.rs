//! A primitive, taken apart into surfaces, each in a window.

use nalgebra::{Matrix3, Vector3};

use super::depth::Depth;
use super::outline::Outline;
use super::row::{Lens, Origin};
use super::surface::{Ends, Flat, Quadric, Surface};
use super::window::{Frustum, Window, ball_window, corners_window, meet};
use super::{Pinhole, Primitive, Shape};

/// A surface of a primitive and the pixels that it can fall on.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Index of the primitive in the scene.
    pub(super) primitive: usize,
    pub(super) window: Window,
    pub(super) surface: Surface,
    /// The middle of the window, from which outline and depth count.
    pub(super) origin: Origin,
    pub(super) outline: Outline,
    pub(super) depth: Depth,
}

impl Piece {
    /// The columns in which it is seen, row by row. `see` takes a row and its columns.
    #[inline]
    pub(super) fn rows(
        &self,
        within: &Window,
        lens: &Lens,
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
                *columns = meet(lens.columns_from(&self.origin, *interval), within.columns);
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
    pub(super) fn nearest_in(&self, window: &Window, lens: &Lens) -> f64 {
        let above = self.surface.nearest();
        let (left, right) = (window.columns.0, window.columns.1.max(1) - 1);
        let (top, bottom) = (window.rows.0, window.rows.1.max(1) - 1);
        [(left, top), (left, bottom), (right, top), (right, bottom)]
            .map(|(i, j)| above.dot(&Vector3::new(lens.x(i), lens.y(j), 1.0)))
            .into_iter()
            .fold(0.0, f64::max)
    }
}

/// Takes primitives apart for one camera.
pub(super) struct Cutter<'a> {
    pub(super) camera: &'a Pinhole,
    pub(super) lens: Lens,
    /// Pieces that cannot fall into this window are left out.
    pub(super) view: Window,
    frustum: Frustum,
    /// The visible pieces so far.
    pub(super) pieces: Vec<Piece>,
}

impl<'a> Cutter<'a> {
    pub(super) fn new(camera: &'a Pinhole) -> Self {
        let lens = Lens::new(camera);
        let view = Window::frame(&lens);
        Self {
            camera,
            lens,
            view,
            frustum: Frustum::new(&lens, &view),
            pieces: Vec::new(),
        }
    }

    /// Leaves out what does not fall into a window from now on.
    pub(super) fn look_at(&mut self, view: Window) {
        self.view = view;
        self.frustum = Frustum::new(&self.lens, &view);
    }

    /// Adds the pieces of one primitive.
    pub(super) fn cut(&mut self, primitive: usize, shape: &Shape) {
        match shape {
            Shape::Sphere { centre, radius } => {
                let centre = self.camera.camera_from_world(centre);
                self.ball(primitive, centre, *radius, None);
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

    fn push(&mut self, primitive: usize, window: Window, surface: Surface) {
        let origin = Origin::middle(&window, &self.lens);
        let (outline, depth) = surface.forms(&origin);
        self.pieces.push(Piece {
            primitive,
            window,
            surface,
            origin,
            outline,
            depth,
        });
    }

    pub(super) fn sees(&self, window: &Window) -> bool {
        !window.overlap(&self.view).is_empty()
    }

    /// A ball, or with `outward` the half of one on the side of that vector.
    fn ball(
        &mut self,
        primitive: usize,
        centre: Vector3<f64>,
        radius: f64,
        outward: Option<Vector3<f64>>,
    ) {
        if self.frustum.misses(&[centre], radius) {
            return;
        }
        let window = ball_window(&self.lens, &centre, radius);
        if !self.sees(&window) {
            return;
        }
        if let Some(quadric) = Quadric::new(centre, Matrix3::identity(), radius) {
            self.push(primitive, window, Surface::Ball(quadric, outward));
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
        if self.frustum.misses(&[a, b], radius) {
            return;
        }
        let window = self.capsule_window(&a, &b, radius);
        if distance_to_segment(&a, &b) > radius && self.sees(&window) {
            self.side(primitive, window, [a, b], radius);
            let outward = (b - a).try_normalize(0.0);
            self.ball(primitive, a, radius, outward.map(|axis| -axis));
            self.ball(primitive, b, radius, outward);
        }
    }

    fn cylinder(&mut self, primitive: usize, [a, b]: [Vector3<f64>; 2], radius: f64) {
        let Some(axis) = (b - a).try_normalize(0.0) else {
            return;
        };
        let [u, v] = perpendicular(&axis).map(|unit| unit * radius);
        let corners = [a, b].map(|end| [end + u + v, end + u - v, end - u + v, end - u - v]);
        let window = corners_window(&self.lens, corners.as_flattened());
        if !self.sees(&window) {
            return;
        }
        self.side(primitive, window, [a, b], radius);
        for (end, outward) in [(a, -axis), (b, axis)] {
            if let Some(flat) = Flat::new(end, [u, v], outward) {
                self.push(primitive, window, Surface::Ellipse(flat));
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
        if let Some(flat) = Flat::new(centre, half, outward) {
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

/// Takes every primitive apart that can be seen in a window.
pub(super) fn cut_scene<'a>(
    scene: &[Primitive],
    camera: &'a Pinhole,
    view: Option<Window>,
) -> Cutter<'a> {
    let mut cutter = Cutter::new(camera);
    if let Some(view) = view {
        cutter.look_at(view);
    }
    cutter.pieces.reserve(3 * scene.len());
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
