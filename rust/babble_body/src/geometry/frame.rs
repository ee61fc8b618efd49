//! Coordinate frames in space, and rotations in the plane of motion.

use nalgebra::{Matrix3, Vector2, Vector3};

/// A coordinate frame: where its origin is \[m\] and how it is turned.
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

    /// The frame turned about one of its own axes by an angle \[rad\].
    pub(crate) fn turned(self, axis: &Vector3<f64>, angle: f64) -> Self {
        if angle == 0.0 {
            return self;
        }
        // Rodrigues' formula through libm: the same bits on every platform.
        let (s, c) = libm::sincos(angle);
        let k = axis.cross_matrix();
        let matrix = Matrix3::identity() + k * s + k * k * (1.0 - c);
        Self {
            rotation: self.rotation * matrix,
            ..self
        }
    }

    /// The frame moved by a vector of its own \[m\].
    pub(crate) fn shifted(self, by: Vector3<f64>) -> Self {
        Self {
            origin: self.world_from_local(&by),
            ..self
        }
    }
}

/// `v` turned by the angle whose (cos, sin) is `direction`.
pub(crate) fn rotate(v: Vector2<f64>, direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(
        v.x * direction.x - v.y * direction.y,
        v.x * direction.y + v.y * direction.x,
    )
}

/// `v` turned back by the angle whose (cos, sin) is `direction`.
pub(crate) fn unrotate(v: Vector2<f64>, direction: Vector2<f64>) -> Vector2<f64> {
    rotate(v, Vector2::new(direction.x, -direction.y))
}
