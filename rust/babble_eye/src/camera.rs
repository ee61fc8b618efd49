//! The pinhole camera.

use nalgebra::{Matrix3, Vector3};

/// A pinhole camera. Pixel (i, j) has its centre at (i + ½, j + ½), i to the
/// right, j downwards; the axis meets the image at (width / 2, height / 2).
///
/// Camera frame: x right, y up, z forward. It is left-handed, so `rotation`
/// is orthogonal with determinant −1.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    /// Centre of projection in world coordinates \[m\].
    pub position: Vector3<f64>,
    /// Camera from world. Rows: right, up, forward in world coordinates.
    pub rotation: Matrix3<f64>,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Focal length \[pixel\].
    pub focal_px: f64,
}

impl Pinhole {
    /// A camera whose image is `field_deg` \[deg\] wide, in (0, 180).
    #[must_use]
    pub fn from_field(
        position: Vector3<f64>,
        rotation: Matrix3<f64>,
        field_deg: f64,
        width: usize,
        height: usize,
    ) -> Self {
        let half_field = 0.5 * field_deg.to_radians();
        Self {
            position,
            rotation,
            width,
            height,
            focal_px: 0.5 * width as f64 / libm::tan(half_field),
        }
    }

    /// A camera at `position` that looks at `target` with the image's upper
    /// edge towards `up`; the line of sight must not be along `up`.
    #[must_use]
    pub fn look_at(
        position: Vector3<f64>,
        target: Vector3<f64>,
        up: Vector3<f64>,
        field_deg: f64,
        width: usize,
        height: usize,
    ) -> Self {
        let forward = (target - position).normalize();
        let right = forward.cross(&up).normalize();
        let rotation = axes(right, right.cross(&forward), forward);
        Self::from_field(position, rotation, field_deg, width, height)
    }

    /// The same view at another sampling: `factor` times as many pixels each way.
    #[must_use]
    pub fn scaled(&self, factor: usize) -> Self {
        Self {
            width: self.width * factor,
            height: self.height * factor,
            focal_px: self.focal_px * factor as f64,
            ..self.clone()
        }
    }

    /// The middle `width` × `height` pixels of this view, such as the fovea.
    #[must_use]
    pub fn middle(&self, width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            ..self.clone()
        }
    }

    /// A world point in the camera frame \[m\].
    #[must_use]
    pub fn camera_from_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * (point - self.position)
    }

    /// Pixel coordinates of a world point; `None` unless it lies in front of
    /// the camera. Points outside of the frame have coordinates outside of it.
    #[must_use]
    pub fn project(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
        let p = self.camera_from_world(point);
        (p.z > 0.0).then(|| {
            [
                0.5 * self.width as f64 + self.focal_px * p.x / p.z,
                0.5 * self.height as f64 - self.focal_px * p.y / p.z,
            ]
        })
    }

    /// Direction of a world point in the camera frame \[rad\]: azimuth
    /// atan2(x, z) to the right, elevation atan2(y, √(x² + z²)) upwards.
    #[must_use]
    pub fn direction_angles(&self, point: &Vector3<f64>) -> [f64; 2] {
        let p = self.camera_from_world(point);
        [
            libm::atan2(p.x, p.z),
            libm::atan2(p.y, (p.x * p.x + p.z * p.z).sqrt()),
        ]
    }

    /// Unit vector in world coordinates with the given direction angles
    /// \[rad\]: the inverse of [`direction_angles`](Self::direction_angles).
    #[must_use]
    pub fn ray(&self, [azimuth, elevation]: [f64; 2]) -> Vector3<f64> {
        let (sin_a, cos_a) = libm::sincos(azimuth);
        let (sin_e, cos_e) = libm::sincos(elevation);
        self.rotation
            .tr_mul(&Vector3::new(sin_a * cos_e, sin_e, cos_a * cos_e))
    }
}

/// Rotation matrix from its rows.
pub(crate) fn axes(right: Vector3<f64>, up: Vector3<f64>, forward: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_rows(&[right.transpose(), up.transpose(), forward.transpose()])
}
