//! The part of a config that grasping has for itself.

use serde::{Deserialize, Serialize};

use crate::bounds::within;
use crate::error::EnvError;
use crate::option_spec::MOST_NUMBERS;

/// Longest physics step \[s\]: in longer ones contacts tell nothing.
const LONGEST_STEP_S: f64 = 0.02;

/// Where objects lie and arms start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionConfig {
    /// Distance of the object's centre from the shoulder: lowest and highest \[m\].
    pub radius_m: [f64; 2],
    /// Direction of the object from the shoulder, counter-clockwise from x: lowest and highest
    /// \[deg\].
    pub polar_deg: [f64; 2],
    /// Shoulder at the start: lowest and highest \[deg\], cut to the joint range.
    pub shoulder_deg: [f64; 2],
    /// Elbow at the start: lowest and highest \[deg\], cut to the joint range.
    pub elbow_deg: [f64; 2],
}

/// Values of grasping in a config.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraspConfig {
    /// Diameters of the objects \[m\]; 0.024 and 0.06 \[F\]. The 12 and 30 cm that the paper prints
    /// cannot be enclosed.
    pub diameters_m: Vec<f64>,
    /// Whether a diameter is drawn from all between the smallest and the largest of
    /// `diameters_m`, and not from the list; false \[C\].
    pub any_diameter_between: bool,
    /// Objects on the palm's side of the arm: radius 0.15…0.29 m, polar 40…160°, shoulder
    /// −75…−15°, elbow 5…90° \[C\] (body `icub`: polar 90…160°, shoulder −10…10°, elbow 15…90°).
    pub palm_side: RegionConfig,
    /// Objects and starts all over the plane: radius 0.13…0.29 m, polar −20…160°, all postures \[C\].
    pub full: RegionConfig,
    /// Least distance from the open hand and the arm to the object at the start \[m\]; 0.005 \[C\].
    pub clearance_m: f64,
    /// Control steps over which a grasp must enclose the object, and over which it must then hold
    /// it without support; 20 \[C\], that is 1 s.
    pub hold_steps: u32,
    /// Least share of physics steps in which the hand alone encloses the object, before the support
    /// goes; 0.95 \[C\].
    pub enclosed_share: f64,
    /// Share of such physics steps that must be exceeded after it went; 0.9 \[C\].
    pub held_share: f64,
    /// The object counts as in the hand when its centre is on the palm's side and at most its
    /// radius and this far from the palm's centre \[m\]; 0.06 \[C\].
    pub palm_reach_m: f64,
    /// In the goal form the object is where it should be within this distance \[m\]; 0.02 \[C\].
    pub success_radius_m: f64,
    /// Change of an equilibrium point by an action of 1 in `delta_posture` control \[deg\]; 5 \[C\].
    pub delta_posture_deg: f64,
    /// Normal force that the sense of touch calls 1 \[N\]; 20 \[C\]. More is felt as 1.
    pub touch_max_n: f64,
    /// Time between two actions \[s\]; 0.05 \[C\].
    pub control_period_s: f64,
    /// Physics steps in a control period; 10 \[C\], that is 5 ms each. At 10 ms grasps slip, and 20 ms
    /// are the most that one may be.
    pub physics_steps: u32,
}

impl GraspConfig {
    /// The values of profile `paper`.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            diameters_m: vec![0.024, 0.06],
            any_diameter_between: false,
            palm_side: RegionConfig {
                radius_m: [0.15, 0.29],
                polar_deg: [40.0, 160.0],
                shoulder_deg: [-75.0, -15.0],
                elbow_deg: [5.0, 90.0],
            },
            full: RegionConfig {
                radius_m: [0.13, 0.29],
                polar_deg: [-20.0, 160.0],
                shoulder_deg: [-360.0, 360.0],
                elbow_deg: [0.0, 180.0],
            },
            clearance_m: 0.005,
            hold_steps: 20,
            enclosed_share: 0.95,
            held_share: 0.9,
            palm_reach_m: 0.06,
            success_radius_m: 0.02,
            delta_posture_deg: 5.0,
            touch_max_n: 20.0,
            control_period_s: 0.05,
            physics_steps: 10,
        }
    }

    /// The values of profile `icub`, whose shoulder turns less.
    #[must_use]
    pub fn icub() -> Self {
        let paper = Self::paper();
        Self {
            palm_side: RegionConfig {
                polar_deg: [90.0, 160.0],
                shoulder_deg: [-10.0, 10.0],
                elbow_deg: [15.0, 90.0],
                ..paper.palm_side
            },
            ..paper
        }
    }

    /// Physics step \[s\].
    #[must_use]
    pub fn physics_step_s(&self) -> f64 {
        self.control_period_s / f64::from(self.physics_steps)
    }

    /// Smallest and largest diameter \[m\].
    #[must_use]
    pub fn diameter_range_m(&self) -> [f64; 2] {
        let all = self.diameters_m.iter().copied();
        [
            all.clone().fold(f64::INFINITY, f64::min),
            all.fold(0.0, f64::max),
        ]
    }

    /// Checks every field.
    pub(crate) fn validate(&self) -> Result<(), EnvError> {
        if !(1..=MOST_NUMBERS).contains(&self.diameters_m.len()) {
            return Err(EnvError::Config {
                field: "grasp.diameters_m".to_owned(),
                problem: format!(
                    "there are {} diameters: there must be at least one and at most {MOST_NUMBERS}",
                    self.diameters_m.len()
                ),
            });
        }
        for (i, &diameter) in self.diameters_m.iter().enumerate() {
            within(&format!("grasp.diameters_m[{i}]"), diameter, 0.005, 0.2)?;
        }
        self.palm_side.validate("grasp.palm_side")?;
        self.full.validate("grasp.full")?;
        let steps = f64::from(self.hold_steps);
        let physics = f64::from(self.physics_steps);
        for (field, value, low, high) in [
            ("clearance_m", self.clearance_m, 0.0, 0.1),
            ("hold_steps", steps, 1.0, 1000.0),
            ("enclosed_share", self.enclosed_share, 0.01, 1.0),
            ("held_share", self.held_share, 0.01, 0.999),
            ("palm_reach_m", self.palm_reach_m, 0.01, 0.2),
            ("success_radius_m", self.success_radius_m, 1e-4, 0.2),
            ("delta_posture_deg", self.delta_posture_deg, 0.01, 180.0),
            ("touch_max_n", self.touch_max_n, 1e-3, 1e4),
            ("control_period_s", self.control_period_s, 1e-3, 1.0),
            ("physics_steps", physics, 1.0, 250.0),
        ] {
            within(&format!("grasp.{field}"), value, low, high)?;
        }
        let least = (self.control_period_s / LONGEST_STEP_S).ceil();
        within("grasp.physics_steps", physics, least, 250.0)
    }
}

impl RegionConfig {
    fn validate(&self, name: &str) -> Result<(), EnvError> {
        for (field, [first, last], low, high) in [
            ("radius_m", self.radius_m, 0.01, 2.0),
            ("polar_deg", self.polar_deg, -360.0, 360.0),
            ("shoulder_deg", self.shoulder_deg, -360.0, 360.0),
            ("elbow_deg", self.elbow_deg, -360.0, 360.0),
        ] {
            within(&format!("{name}.{field}[0]"), first, low, high)?;
            within(&format!("{name}.{field}[1]"), last, first, high)?;
        }
        Ok(())
    }
}
