//! Every number of the body, with its unit and source.
//!
//! Sources: \[P\] the paper, \[A\] derived, \[F\] fitted to the paper's tables, \[C\] a free choice.

use serde::{Deserialize, Serialize};

use crate::arm::PlanarArm;
use crate::error::{BodyError, within};
use crate::eye::EyeConfig;
use crate::joints::{self, Joints};
use crate::skeleton;

/// The arm's two segments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// Length of the upper arm \[m\]; 0.15 \[P\].
    pub upper_arm_m: f64,
    /// Length of the forearm \[m\]; 0.13 \[P\].
    pub forearm_m: f64,
    /// Half-width of arm and hand \[m\]; 0.01 \[F\]. Larger touches obstacles earlier.
    pub half_width_m: f64,
    /// Density of arm and hand \[kg/m³\]; 1100 \[C\]. Hardly matters beside the muscles' damping.
    pub density_kg_m3: f64,
}

/// The hand's segments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// Length of the palm from the wrist to the fingers' pivots \[m\]; 0.055 \[C\].
    pub palm_m: f64,
    /// Height of the palm across the plane of motion \[m\]; 0.06 \[C\].
    pub palm_height_m: f64,
    /// Pivot segment and three phalanges of each finger \[m\]; 0.01, 0.02, 0.017, 0.014 \[P\].
    pub finger_m: [f64; 4],
    /// Pivot segment and three phalanges of the thumb \[m\]; 0.02, 0.02, 0.017, 0.014 \[P\].
    pub thumb_m: [f64; 4],
    /// Distance between neighbouring fingers \[m\]; 0.015 \[C\].
    pub finger_spacing_m: f64,
}

/// The muscles of Eq. 2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Muscles {
    /// Stiffness `K_P` \[N·m/rad\]; 50 \[P\].
    pub kp: f64,
    /// Damping `K_D` \[N·m·s/rad\]; 40 \[P\]. The arm's time constant is `kd / kp` seconds.
    pub kd: f64,
    /// Torque of an action of 1 in torque control \[N·m\]; 50 \[C\].
    pub torque_max: f64,
}

/// The vertical cylinder in the way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Radius \[m\]; 0.035 \[F\] (body `icub`: 0.02 \[C\]).
    pub radius_m: f64,
    /// Height \[m\], half of it above the arm's plane; 0.12 \[C\].
    pub height_m: f64,
}

/// The red sphere to be reached. It is immaterial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Radius \[m\]; 0.012 \[C\].
    pub radius_m: f64,
}

/// The whole body and the things in its world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Upper arm and forearm.
    pub arm: Arm,
    /// Palm, thumb and fingers.
    pub hand: Hand,
    /// Ranges and locks of the 26 joints.
    pub joints: Joints,
    /// Stiffness and damping.
    pub muscles: Muscles,
    /// Camera and its frame.
    pub eye: EyeConfig,
    /// The obstacle.
    pub obstacle: Cylinder,
    /// The target.
    pub target: Target,
}

impl Body {
    /// The body fitted to the paper's Table I: shoulder −75…180°, elbow 5…130° \[F\], camera in
    /// Helmholtz coordinates \[F\].
    #[must_use]
    pub fn paper() -> Self {
        Self {
            arm: Arm {
                upper_arm_m: 0.15,
                forearm_m: 0.13,
                half_width_m: 0.01,
                density_kg_m3: 1100.0,
            },
            hand: Hand {
                palm_m: 0.055,
                palm_height_m: 0.06,
                finger_m: [0.01, 0.02, 0.017, 0.014],
                thumb_m: [0.02, 0.02, 0.017, 0.014],
                finger_spacing_m: 0.015,
            },
            joints: joints::reaching_joints([-75.0, 180.0], [5.0, 130.0]),
            muscles: Muscles {
                kp: 50.0,
                kd: 40.0,
                torque_max: 50.0,
            },
            eye: EyeConfig::helmholtz(),
            obstacle: Cylinder {
                radius_m: 0.035,
                height_m: 0.12,
            },
            target: Target { radius_m: 0.012 },
        }
    }

    /// The iCub's joint ranges (shoulder −10…95°, elbow 15…106°), a pan-tilt head in Fick
    /// coordinates and a thinner obstacle \[C\].
    #[must_use]
    pub fn icub() -> Self {
        Self {
            joints: joints::reaching_joints([-10.0, 95.0], [15.0, 106.0]),
            eye: EyeConfig::fick(),
            obstacle: Cylinder {
                radius_m: 0.02,
                height_m: 0.12,
            },
            ..Self::paper()
        }
    }

    /// Checks every field and that the parts fit together.
    ///
    /// # Errors
    /// A [`BodyError`] that names the field, its value and its bound.
    pub fn validate(&self) -> Result<(), BodyError> {
        self.validate_lengths()?;
        within("arm.density_kg_m3", self.arm.density_kg_m3, 1.0, 1e5)?;
        within("muscles.kp", self.muscles.kp, 1e-3, 1e6)?;
        within("muscles.kd", self.muscles.kd, 1e-3, 1e6)?;
        within("muscles.torque_max", self.muscles.torque_max, 1e-3, 1e6)?;
        joints::validate(&self.joints)?;
        self.eye.validate()?;
        skeleton::validate_plane(self)?;
        PlanarArm::new(self).validate()
    }

    fn validate_lengths(&self) -> Result<(), BodyError> {
        let hand = &self.hand;
        let named = |name: &'static str, all: [f64; 4]| {
            all.into_iter()
                .enumerate()
                .map(move |(i, v)| (format!("hand.{name}[{i}]"), v))
        };
        let lengths = [
            ("arm.upper_arm_m".to_owned(), self.arm.upper_arm_m),
            ("arm.forearm_m".to_owned(), self.arm.forearm_m),
            ("arm.half_width_m".to_owned(), self.arm.half_width_m),
            ("hand.palm_m".to_owned(), hand.palm_m),
            ("hand.palm_height_m".to_owned(), hand.palm_height_m),
            ("hand.finger_spacing_m".to_owned(), hand.finger_spacing_m),
            ("obstacle.radius_m".to_owned(), self.obstacle.radius_m),
            ("obstacle.height_m".to_owned(), self.obstacle.height_m),
            ("target.radius_m".to_owned(), self.target.radius_m),
        ];
        let segments = named("finger_m", hand.finger_m).chain(named("thumb_m", hand.thumb_m));
        for (field, value) in lengths.into_iter().chain(segments) {
            within(&field, value, 1e-4, 1.0)?;
        }
        Ok(())
    }
}
