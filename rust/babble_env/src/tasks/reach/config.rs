//! The part of a config that reaching has for itself.

use babble_body::config::Muscles;
use serde::{Deserialize, Serialize};

use crate::bounds::within;
use crate::error::EnvError;

/// Values of reaching in a config.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReachConfig {
    /// Distance from start to target: lowest and highest \[m\]; 0.08 and 0.25 \[F\] (body `icub`:
    /// 0.10 and 0.20 \[C\]).
    pub distance_m: [f64; 2],
    /// Success when the fingertip is at most this far from the target \[m\]; 0.02 \[C\].
    pub success_radius_m: f64,
    /// Lowest and highest b1 and b2 of a movement; 0.01 and 0.99 \[C\].
    pub b_range: [f64; 2],
    /// Movement time T of the pattern generators \[s\]; 8 \[C\]. Shorter movements lose their
    /// curvature to the muscles' lag.
    pub movement_s: f64,
    /// Time to settle after T, in muscle time constants `K_D/K_P`; 4 \[C\]. 120 s at most.
    pub settle_time_constants: f64,
    /// Change of the equilibrium point by an action of 1 in `delta_posture` control \[deg\]; 5 \[C\].
    pub delta_posture_deg: f64,
    /// Joint speed below which the arm counts as settled, if that is asked for \[rad/s\]; 0.05 \[C\].
    pub settled_speed_rad_s: f64,
    /// Time between two actions \[s\]; 0.05 \[C\].
    pub control_period_s: f64,
    /// Physics steps in a control period; 10 \[C\], that is 5 ms each.
    pub physics_steps: u32,
}

impl ReachConfig {
    /// Physics step \[s\].
    #[must_use]
    pub fn physics_step_s(&self) -> f64 {
        self.control_period_s / f64::from(self.physics_steps)
    }

    /// Control periods of the pattern generators' movement time.
    #[must_use]
    pub fn movement_steps(&self) -> usize {
        (self.movement_s / self.control_period_s).round().max(1.0) as usize
    }

    /// The values of profile `paper`.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            distance_m: [0.08, 0.25],
            success_radius_m: 0.02,
            b_range: [0.01, 0.99],
            movement_s: 8.0,
            settle_time_constants: 4.0,
            delta_posture_deg: 5.0,
            settled_speed_rad_s: 0.05,
            control_period_s: 0.05,
            physics_steps: 10,
        }
    }

    /// The values of profile `icub`.
    #[must_use]
    pub const fn icub() -> Self {
        Self {
            distance_m: [0.1, 0.2],
            ..Self::paper()
        }
    }

    /// Checks every field. The time to settle depends on the muscles.
    pub(crate) fn validate(&self, muscles: &Muscles) -> Result<(), EnvError> {
        let [near, far] = self.distance_m;
        within("reach.distance_m[0]", near, 1e-3, 1.0)?;
        within("reach.distance_m[1]", far, near, 2.0)?;
        within("reach.success_radius_m", self.success_radius_m, 1e-4, near)?;
        within("reach.b_range[0]", self.b_range[0], 0.01, 0.99)?;
        within("reach.b_range[1]", self.b_range[1], self.b_range[0], 0.99)?;
        // Before the movement time, which is bounded by it.
        within("reach.control_period_s", self.control_period_s, 1e-3, 1.0)?;
        within(
            "reach.movement_s",
            self.movement_s,
            self.control_period_s,
            120.0,
        )?;
        within(
            "reach.settle_time_constants",
            self.settle_time_constants,
            0.0,
            20.0,
        )?;
        let settle_s = self.settle_time_constants * muscles.kd / muscles.kp;
        within(
            "reach.settle_time_constants K_D/K_P in seconds",
            settle_s,
            0.0,
            120.0,
        )?;
        within(
            "reach.delta_posture_deg",
            self.delta_posture_deg,
            0.01,
            180.0,
        )?;
        within(
            "reach.settled_speed_rad_s",
            self.settled_speed_rad_s,
            1e-6,
            100.0,
        )?;
        within(
            "reach.physics_steps",
            f64::from(self.physics_steps),
            1.0,
            1000.0,
        )
    }
}
