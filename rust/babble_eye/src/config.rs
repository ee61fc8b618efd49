//! Settings of the eye.

use serde::{Deserialize, Serialize};

use crate::error::EyeError;

/// Order of the eye's rotations, and the gaze at zero pan and tilt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GazeFrame {
    /// Tilt about the fixed left-right axis, then pan. Zero looks straight
    /// down, with y upwards in the image.
    Helmholtz,
    /// Pan about the vertical, then tilt. Zero looks straight ahead along y,
    /// with z upwards in the image.
    Fick,
}

/// Where the eye is, how it turns and what its retina resolves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyeConfig {
    /// Centre of the eye from the shoulder \[m\], each within ±10; 10 cm ahead and 25 cm above.
    pub position_m: [f64; 3],
    /// Edge of the square image \[pixel\], 8 to 4096; the paper has 630.
    pub pixels: usize,
    /// Field of view, both ways \[deg\], 1 to 170; the paper has 120.
    pub field_deg: f64,
    /// Order of rotations and zero.
    pub frame: GazeFrame,
    /// Lowest and highest pan \[deg\]: within ±90 in the Helmholtz frame,
    /// within ±180 in the Fick frame.
    pub pan_deg: [f64; 2],
    /// Lowest and highest tilt \[deg\]: within ±180 in the Helmholtz frame,
    /// within ±90 in the Fick frame.
    pub tilt_deg: [f64; 2],
}

impl Default for EyeConfig {
    fn default() -> Self {
        Self::helmholtz()
    }
}

impl EyeConfig {
    /// The eye of body profile `paper`: zero straight down, ±65°.
    #[must_use]
    pub fn helmholtz() -> Self {
        Self {
            position_m: [0.0, 0.10, 0.25],
            pixels: 630,
            field_deg: 120.0,
            frame: GazeFrame::Helmholtz,
            pan_deg: [-65.0, 65.0],
            tilt_deg: [-65.0, 65.0],
        }
    }

    /// The eye of body profile `icub`: zero straight ahead, all round.
    #[must_use]
    pub fn fick() -> Self {
        Self {
            frame: GazeFrame::Fick,
            pan_deg: [-180.0, 180.0],
            tilt_deg: [-90.0, 0.0],
            ..Self::helmholtz()
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`EyeError::OutOfBound`] for the first field outside of its bound.
    pub fn validate(&self) -> Result<(), EyeError> {
        for value in self.position_m {
            let fits = (-10.0..=10.0).contains(&value);
            within("position_m", value, fits, "from -10 to 10 [m]")?;
        }
        let pixels = self.pixels as f64;
        let fits = (8..=4096).contains(&self.pixels);
        within("pixels", pixels, fits, "from 8 to 4096")?;
        let fits = (1.0..=170.0).contains(&self.field_deg);
        within("field_deg", self.field_deg, fits, "from 1 to 170 [deg]")?;
        match self.frame {
            GazeFrame::Helmholtz => {
                range("pan_deg", self.pan_deg, 90.0, "low < high within ±90 [deg]")?;
                range(
                    "tilt_deg",
                    self.tilt_deg,
                    180.0,
                    "low < high within ±180 [deg]",
                )
            }
            GazeFrame::Fick => {
                range(
                    "pan_deg",
                    self.pan_deg,
                    180.0,
                    "low < high within ±180 [deg]",
                )?;
                range(
                    "tilt_deg",
                    self.tilt_deg,
                    90.0,
                    "low < high within ±90 [deg]",
                )
            }
        }
    }
}

fn within(
    field: &'static str,
    value: f64,
    fits: bool,
    bound: &'static str,
) -> Result<(), EyeError> {
    if fits {
        Ok(())
    } else {
        Err(EyeError::OutOfBound {
            field,
            value,
            bound,
        })
    }
}

fn range(
    field: &'static str,
    [low, high]: [f64; 2],
    limit: f64,
    bound: &'static str,
) -> Result<(), EyeError> {
    within(field, low, low >= -limit && low < high, bound)?;
    within(field, high, high <= limit, bound)
}
