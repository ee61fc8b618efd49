//! Where the engine's glam types in `f32` meet the body's nalgebra types in `f64`.

use nalgebra::{Matrix3, Vector3};
use rapier3d::math::{Pose, Rotation, Vector};

/// A frame: where its origin is \[m\] and how it is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Origin in world coordinates \[m\].
    pub origin: Vector3<f64>,
    /// Columns: the frame's axes in world coordinates.
    pub rotation: Matrix3<f64>,
}

impl Frame {
    /// A point of the frame in world coordinates \[m\].
    #[must_use]
    pub fn world_from_local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.origin + self.rotation * point
    }

    /// A world point in the frame \[m\].
    #[must_use]
    pub fn local_from_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(point - self.origin))
    }
}

pub(super) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

pub(super) fn from_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x.into(), v.y.into(), v.z.into())
}

pub(super) fn from_pose(pose: &Pose) -> Frame {
    // Written out: exact sums and products alone, so the same bits everywhere.
    let [x, y, z, w] = pose.rotation.to_array().map(f64::from);
    Frame {
        origin: from_vector(pose.translation),
        rotation: Matrix3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ),
    }
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
