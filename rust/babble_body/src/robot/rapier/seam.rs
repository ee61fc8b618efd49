//! Where the engine's glam types in `f32` meet the body's nalgebra types in `f64`.

use nalgebra::Vector3;
use rapier3d::math::{Pose, Rotation, Vector};

pub(super) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

pub(super) fn from_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x.into(), v.y.into(), v.z.into())
}

/// The frame of a joint about the vertical: its free axis, local x, points up, or down for a joint
/// that turns clockwise; `direction` turns it about the vertical first \[rad\].
pub(super) fn hinge(origin: &Vector3<f64>, direction: f64, clockwise: bool) -> Pose {
    let quarter = if clockwise { 1.0 } else { -1.0 };
    // Quaternions by hand: half angles through libm.
    let (s, c) = libm::sincos(0.5 * direction);
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let about_z = Rotation::from_xyzw(0.0, 0.0, s as f32, c as f32);
    let x_to_axis = Rotation::from_xyzw(0.0, (quarter * h) as f32, 0.0, h as f32);
    Pose::from_parts(vector(origin), about_z * x_to_axis)
}
