//! The eye's two rotations: from gaze to camera and back.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::camera::{Pinhole, axes};
use crate::config::{EyeConfig, GazeFrame};
use crate::error::EyeError;

/// Where the eye looks.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gaze {
    /// Turn to the right \[rad\].
    pub pan: f64,
    /// Turn upwards in the image \[rad\].
    pub tilt: f64,
}

/// An eye with two degrees of freedom about a fixed centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Eye {
    config: EyeConfig,
    position: Vector3<f64>,
    /// Lowest and highest \[rad\].
    pub(crate) pan: [f64; 2],
    pub(crate) tilt: [f64; 2],
    /// The camera at zero pan and tilt.
    zero: Pinhole,
}

impl Eye {
    /// An eye as configured.
    ///
    /// # Errors
    /// [`EyeError::OutOfBound`] as [`EyeConfig::validate`].
    pub fn new(config: EyeConfig) -> Result<Self, EyeError> {
        config.validate()?;
        let position = Vector3::from(config.position_m);
        let zero = Pinhole::from_field(
            position,
            rotation(config.frame, Gaze::default()),
            config.field_deg,
            config.pixels,
            config.pixels,
        );
        Ok(Self {
            position,
            pan: config.pan_deg.map(f64::to_radians),
            tilt: config.tilt_deg.map(f64::to_radians),
            zero,
            config,
        })
    }

    /// The config it was made from.
    #[must_use]
    pub fn config(&self) -> &EyeConfig {
        &self.config
    }

    /// Lowest and highest pan, and tilt \[rad\].
    #[must_use]
    pub const fn ranges(&self) -> [[f64; 2]; 2] {
        [self.pan, self.tilt]
    }

    /// The eye's image at a gaze.
    #[must_use]
    pub fn camera(&self, gaze: Gaze) -> Pinhole {
        Pinhole {
            rotation: rotation(self.config.frame, gaze),
            ..self.zero.clone()
        }
    }

    /// The eye's image at a gaze, sampled at `pixels` × `pixels`.
    #[must_use]
    pub fn camera_sized(&self, gaze: Gaze, pixels: usize) -> Pinhole {
        let scale = pixels as f64 / self.config.pixels as f64;
        Pinhole {
            width: pixels,
            height: pixels,
            focal_px: self.zero.focal_px * scale,
            ..self.camera(gaze)
        }
    }

    /// Pan and tilt over their ranges, the eye's proprioception: [0, 1] each
    /// for a gaze within the ranges.
    #[must_use]
    pub fn normalised(&self, gaze: Gaze) -> [f64; 2] {
        let share = |angle: f64, [low, high]: [f64; 2]| (angle - low) / (high - low);
        [share(gaze.pan, self.pan), share(gaze.tilt, self.tilt)]
    }

    /// The gaze with the given pan and tilt over their ranges: the inverse of
    /// [`normalised`](Self::normalised).
    #[must_use]
    pub fn from_normalised(&self, [pan, tilt]: [f64; 2]) -> Gaze {
        let angle = |share: f64, [low, high]: [f64; 2]| low + share * (high - low);
        Gaze {
            pan: angle(pan, self.pan),
            tilt: angle(tilt, self.tilt),
        }
    }

    /// The gaze at which a world point is in the middle of the image. It is
    /// not clipped to the ranges.
    #[must_use]
    pub fn fixate(&self, point: &Vector3<f64>) -> Gaze {
        let v = point - self.position;
        let length = |a: f64, b: f64| (a * a + b * b).sqrt();
        match self.config.frame {
            GazeFrame::Helmholtz => Gaze {
                pan: libm::atan2(v.x, length(v.y, v.z)),
                tilt: libm::atan2(v.y, -v.z),
            },
            GazeFrame::Fick => Gaze {
                pan: libm::atan2(v.x, v.y),
                tilt: libm::atan2(v.z, length(v.x, v.y)),
            },
        }
    }

    /// The nearest gaze within the ranges; pan wraps where its range is the
    /// full circle.
    #[must_use]
    pub fn clipped(&self, gaze: Gaze) -> Gaze {
        let [low, high] = self.pan;
        let turn = 2.0 * PI;
        let pan = if self.config.pan_deg == [-180.0, 180.0] {
            gaze.pan - turn * ((gaze.pan + PI) / turn).floor()
        } else {
            gaze.pan.clamp(low, high)
        };
        Gaze {
            pan,
            tilt: gaze.tilt.clamp(self.tilt[0], self.tilt[1]),
        }
    }

    /// Where the line of sight meets the horizontal plane at height `z` \[m\]:
    /// (x, y) \[m\], or `None` if it does not.
    #[must_use]
    pub fn target_in_plane(&self, gaze: Gaze, z: f64) -> Option<[f64; 2]> {
        self.point_in_plane(gaze, [0.0, 0.0], z)
    }

    /// The point (x, y) \[m\] of the horizontal plane at height `z` \[m\] that
    /// has the given [direction angles](Pinhole::direction_angles) \[rad\] at a
    /// gaze; `None` if that direction does not meet the plane.
    #[must_use]
    pub fn point_in_plane(&self, gaze: Gaze, angles: [f64; 2], z: f64) -> Option<[f64; 2]> {
        let ray = self.camera(gaze).ray(angles);
        let reach = (z - self.position.z) / ray.z;
        (reach.is_finite() && reach > 0.0).then(|| {
            [
                self.position.x + reach * ray.x,
                self.position.y + reach * ray.y,
            ]
        })
    }

    /// The zero gaze, clipped to the ranges.
    #[must_use]
    pub fn rest(&self) -> Gaze {
        self.clipped(Gaze::default())
    }

    /// Gazes that between them see all around below the eye.
    pub(crate) fn search_gazes(&self) -> impl Iterator<Item = Gaze> {
        let [quarter, half] = [FRAC_PI_2, PI];
        let eighth = 0.5 * quarter;
        let gazes = match self.config.frame {
            GazeFrame::Helmholtz => [
                [0.0, eighth],
                [0.0, -eighth],
                [eighth, 0.0],
                [-eighth, 0.0],
                [0.0, 0.0],
            ],
            GazeFrame::Fick => [
                [0.0, -eighth],
                [quarter, -eighth],
                [-quarter, -eighth],
                [half, -eighth],
                [0.0, -quarter],
            ],
        };
        gazes
            .map(|[pan, tilt]| self.clipped(Gaze { pan, tilt }))
            .into_iter()
    }
}

/// Camera from world at a gaze; rows right, up, forward.
fn rotation(frame: GazeFrame, gaze: Gaze) -> nalgebra::Matrix3<f64> {
    let (sin_p, cos_p) = libm::sincos(gaze.pan);
    let (sin_t, cos_t) = libm::sincos(gaze.tilt);
    match frame {
        GazeFrame::Helmholtz => {
            let tilted = Vector3::new(0.0, sin_t, -cos_t);
            let up = Vector3::new(0.0, cos_t, sin_t);
            axes(
                Vector3::x() * cos_p - tilted * sin_p,
                up,
                Vector3::x() * sin_p + tilted * cos_p,
            )
        }
        GazeFrame::Fick => {
            let level = Vector3::new(sin_p, cos_p, 0.0);
            axes(
                Vector3::new(cos_p, -sin_p, 0.0),
                Vector3::z() * cos_t - level * sin_t,
                level * cos_t + Vector3::z() * sin_t,
            )
        }
    }
}
