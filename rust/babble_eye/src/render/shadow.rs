//! Shadows that solids cast on the ground: parallelograms and ellipses in its
//! plane, drawn like any other surface.

use nalgebra::{Matrix3, Vector3};

use super::light::TOWARDS_KEY;
use crate::camera::Pinhole;
use crate::raster::decompose::{Decomposer, perpendicular};
use crate::raster::depth_buffer::DepthBuffer;
use crate::raster::image_plane::ImagePlane;
use crate::raster::origin::Origin;
use crate::raster::outline::Outline;
use crate::raster::surface::FlatSurface;
use crate::raster::window::{Window, meet};
use crate::scene::{Primitive, Shape};

/// A patch of shadow on the ground.
pub(crate) struct Shadow {
    window: Window,
    origin: Origin,
    outline: Outline,
}

impl Shadow {
    /// Turns the pixels of the surface `lit` inside of the shadow into `dark`.
    pub(crate) fn draw(&self, buffer: &mut DepthBuffer, lit: u32, dark: u32, plane: &ImagePlane) {
        let part = self.window.overlap(&buffer.window);
        if part.is_empty() {
            return;
        }
        for j in part.rows.0..part.rows.1 {
            let y = j as f64 - self.origin.row as f64;
            let mut interval = [[0.0; 2]];
            self.outline.intervals(y, &mut interval);
            let columns = meet(self.origin.columns(plane, interval[0]), part.columns);
            if columns.0 < columns.1 {
                for surface in buffer.span(j, columns).0 {
                    *surface = if *surface == lit { dark } else { *surface };
                }
            }
        }
    }
}

/// Shadows of all solids of a scene on a ground at the given height.
pub(crate) fn cast(scene: &[Primitive], height: f64, decomposer: &Decomposer) -> Vec<Shadow> {
    let mut caster = ShadowCaster::new(height, decomposer);
    for primitive in scene {
        caster.cast(&primitive.shape);
    }
    caster.shadows
}

struct ShadowCaster<'a> {
    decomposer: &'a Decomposer<'a>,
    camera: &'a Pinhole,
    height: f64,
    /// Projection along the light into the horizontal, for vectors.
    along_light: Matrix3<f64>,
    towards_key: Vector3<f64>,
    shadows: Vec<Shadow>,
}

impl<'a> ShadowCaster<'a> {
    fn new(height: f64, decomposer: &'a Decomposer<'a>) -> Self {
        let towards_key = Vector3::from(TOWARDS_KEY).normalize();
        let drift = towards_key / towards_key.z;
        let along_light = Matrix3::identity() - drift * Vector3::z().transpose();
        Self {
            decomposer,
            camera: decomposer.camera,
            height,
            along_light,
            towards_key,
            shadows: Vec::new(),
        }
    }

    fn cast(&mut self, shape: &Shape) {
        match shape {
            Shape::Sphere { centre, radius } => {
                let half = perpendicular(&self.towards_key).map(|unit| unit * *radius);
                self.ellipse(centre, half);
            }
            Shape::Capsule { a, b, radius } => {
                let half = perpendicular(&self.towards_key).map(|unit| unit * *radius);
                self.sweep(a, b, half);
            }
            Shape::Cylinder { a, b, radius } => {
                if let Some(axis) = (b - a).try_normalize(0.0) {
                    self.sweep(a, b, perpendicular(&axis).map(|unit| unit * *radius));
                }
            }
            Shape::Cuboid {
                centre,
                rotation,
                half_extents,
            } => {
                for k in 0..3 {
                    let axis = rotation.column(k) * half_extents[k];
                    let side = axis.dot(&self.towards_key).signum();
                    let half =
                        [(k + 1) % 3, (k + 2) % 3].map(|i| rotation.column(i) * half_extents[i]);
                    self.parallelogram(&(centre + axis * side), half);
                }
            }
            Shape::Ground { .. } => {}
        }
    }

    /// Shadow of the volume that an ellipse sweeps from a to b.
    fn sweep(&mut self, a: &Vector3<f64>, b: &Vector3<f64>, half: [Vector3<f64>; 2]) {
        self.ellipse(a, half);
        self.ellipse(b, half);
        let [u, v] = half.map(|axis| self.along_light * axis);
        let sweep = self.along_light * (b - a);
        // Half the width across the sweep, where the ellipse's edge is parallel to it.
        let (cosine, sine) = (cross_z(&u, &sweep), cross_z(&v, &sweep));
        let norm = (cosine * cosine + sine * sine).sqrt();
        if norm > 0.0 {
            let across = (u * cosine + v * sine) / norm;
            self.parallelogram(&(0.5 * (a + b)), [0.5 * (b - a), across]);
        }
    }

    fn ellipse(&mut self, centre: &Vector3<f64>, half: [Vector3<f64>; 2]) {
        self.patch(centre, half, true);
    }

    fn parallelogram(&mut self, centre: &Vector3<f64>, half: [Vector3<f64>; 2]) {
        self.patch(centre, half, false);
    }

    fn patch(&mut self, centre: &Vector3<f64>, half: [Vector3<f64>; 2], round: bool) {
        let above = centre.z - self.height;
        if above < 0.0 {
            return;
        }
        // Down the light by the height above the ground.
        let foot = centre - self.towards_key * (above / self.towards_key.z);
        let to_camera = self.camera.rotation;
        let half = half.map(|axis| to_camera * (self.along_light * axis));
        let centre = self.camera.camera_from_world(&foot);
        let up = to_camera.column(2).into_owned();
        let window = self.decomposer.flat_window(&centre, half);
        if !self.decomposer.sees(&window) {
            return;
        }
        if let Some(flat) = FlatSurface::new(centre, half, up) {
            let origin = Origin::middle(&window, &self.decomposer.plane);
            let outline = if round {
                flat.ellipse(&origin)
            } else {
                flat.parallelogram(&origin)
            };
            self.shadows.push(Shadow {
                window,
                origin,
                outline,
            });
        }
    }
}

/// The vertical component of a × b.
fn cross_z(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}
