//! Noise of senses and muscles: independent errors in each control step, normal with mean zero.

use serde::{Deserialize, Serialize};

use crate::bounds::within;
use crate::error::EnvError;
use crate::stream::{Purpose, Stream};

/// Standard deviations of the errors; all are 0 unless given, and then no random number is drawn.
///
/// The errors of one control step come from one number of the episode's stream, so they depend on
/// its seed and on nothing else. What is sensed is cut to the bounds of its sense. Goals, rewards and
/// facts have no errors.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseConfig {
    /// Felt joint angles \[deg\]: the senses `arm`, `stretch` and, in grasping, `hand`. A joint has one
    /// error, which `stretch` shows with the opposite sign.
    pub joint_deg: f64,
    /// Felt pan and tilt of the eye \[deg\]: the sense `eye`. The gaze itself has no error.
    pub eye_deg: f64,
    /// Seen directions \[deg\]: the senses `hand` and `obstacle` of reaching.
    pub sight_deg: f64,
    /// Edges in the fovea, of which the strongest is 1: the sense `fovea`.
    pub fovea: f64,
    /// Felt normal forces \[N\]: the sense `touch`.
    pub touch_n: f64,
    /// Equilibrium points that the muscles pull to \[deg\], cut to the joint ranges. In `torque` control
    /// the torque of a muscle has this error times `K_P`.
    pub motor_deg: f64,
}

/// Where errors are drawn from; without a stream they are all zero.
#[derive(Debug, Clone)]
pub struct Errors(Option<Stream>);

impl NoiseConfig {
    /// Whether there is no noise.
    #[must_use]
    pub fn is_off(&self) -> bool {
        *self == Self::default()
    }

    /// The muscles' errors in the control step that begins. The stream moves on by one number, if
    /// there is noise.
    #[must_use]
    pub fn muscles(&self, stream: &mut Stream) -> Errors {
        Errors((!self.is_off()).then(|| stream.branch(Purpose::Muscles)))
    }

    /// The senses' errors before that control step. The stream does not move on: the same state shows
    /// the same errors.
    #[must_use]
    pub fn senses(&self, stream: &Stream) -> Errors {
        Errors((!self.is_off()).then(|| stream.clone().branch(Purpose::Senses)))
    }

    /// Checks every field.
    pub(crate) fn validate(&self) -> Result<(), EnvError> {
        for (field, value, most) in [
            ("joint_deg", self.joint_deg, 90.0),
            ("eye_deg", self.eye_deg, 90.0),
            ("sight_deg", self.sight_deg, 90.0),
            ("fovea", self.fovea, 1.0),
            ("touch_n", self.touch_n, 1e4),
            ("motor_deg", self.motor_deg, 90.0),
        ] {
            within(&format!("noise.{field}"), value, 0.0, most)?;
        }
        Ok(())
    }
}

impl Errors {
    /// No errors.
    #[must_use]
    pub const fn none() -> Self {
        Self(None)
    }

    /// The next error of a standard deviation.
    pub fn next(&mut self, deviation: f64) -> f64 {
        match &mut self.0 {
            Some(stream) if deviation > 0.0 => deviation * stream.normal(),
            _ => 0.0,
        }
    }

    /// The next errors of one standard deviation in degrees \[rad\].
    pub fn angles<const N: usize>(&mut self, deviation_deg: f64) -> [f64; N] {
        std::array::from_fn(|_| self.next(deviation_deg.to_radians()))
    }

    /// Whether all are zero.
    #[must_use]
    pub const fn are_none(&self) -> bool {
        self.0.is_none()
    }
}

/// Adds an error to a sensed number and cuts it to the bounds of its sense.
pub(crate) fn add(sensed: &mut f32, error: f64, [low, high]: [f64; 2]) {
    *sensed = (f64::from(*sensed) + error).clamp(low, high) as f32;
}
