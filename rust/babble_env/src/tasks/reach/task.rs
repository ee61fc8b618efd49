//! Everything about reaching that stays the same within and between episodes.

use std::f64::consts::{FRAC_PI_2, PI};

use babble_body::config::Muscles;
use babble_body::{ArmState, ContactWatch, Dynamics, Obstacle, PlanarArm, Pull};
use babble_eye::{Eye, Pinhole};
use nalgebra::{Vector2, Vector3};

use super::options::ReachOptions;
use crate::config::Config;
use crate::error::EnvError;
use crate::noise::{self, Errors};
use crate::options::{Control, Reward, check_max_episode_steps};

/// Params of the reaching task.
#[derive(Debug, Clone)]
pub struct ReachTask {
    /// The config it was made from.
    pub config: Config,
    /// The user's choices.
    pub options: ReachOptions,
    /// Kinematics.
    pub arm: PlanarArm,
    /// Equations of motion.
    pub dynamics: Dynamics,
    /// The eye.
    pub eye: Eye,
}

impl ReachTask {
    /// A task from a config, which is checked here once.
    ///
    /// # Errors
    /// [`EnvError`] naming the field or option that is out of bounds.
    pub fn new(config: Config, options: ReachOptions) -> Result<Self, EnvError> {
        config.validate()?;
        if options.goal && options.reward == Reward::Progress {
            return Err(EnvError::Option {
                option: "reward",
                value: options.reward.to_string(),
                known: "sparse when obs = \"goal\"".to_owned(),
            });
        }
        if options.goal && options.settled {
            return Err(EnvError::Option {
                option: "settled",
                value: "True".to_owned(),
                known: "False when obs = \"goal\", whose reward depends on positions alone"
                    .to_owned(),
            });
        }
        check_max_episode_steps(options.max_episode_steps)?;
        let arm = PlanarArm::new(&config.body);
        Ok(Self {
            dynamics: Dynamics::new(&config.body, &arm),
            eye: Eye::new(config.body.eye.clone()).map_err(babble_body::BodyError::from)?,
            arm,
            config,
            options,
        })
    }

    /// A watch for the arm's first touch of `obstacle` from posture `q` on.
    #[must_use]
    pub fn watch(&self, obstacle: Option<Obstacle>, q: [f64; 2]) -> ContactWatch {
        ContactWatch::new(obstacle, &self.arm, q)
    }

    /// One control period of physics; true if the arm touched the obstacle, and then stands there.
    pub fn advance(&self, arm: &mut ArmState, watch: &mut ContactWatch, pull: Pull) -> bool {
        let reach = &self.config.reach;
        let steps = (reach.physics_steps, reach.physics_step_s());
        self.dynamics.play(&self.arm, arm, watch, pull, steps)
    }

    /// The equilibrium points that the muscles pull to \[rad\] when these are asked for.
    #[must_use]
    pub fn with_errors(&self, asked: [f64; 2], errors: &mut Errors) -> [f64; 2] {
        if errors.are_none() {
            return asked;
        }
        let error: [f64; 2] = errors.angles(self.config.noise.motor_deg);
        self.arm.clamp([0, 1].map(|i| asked[i] + error[i]))
    }

    /// Adds errors to felt pan and tilt, shares of their ranges.
    pub fn add_eye_errors(&self, errors: &mut Errors, eye: &mut [f32]) {
        for (felt, [low, high]) in eye.iter_mut().zip(self.eye.ranges()) {
            let [error] = errors.angles(self.config.noise.eye_deg);
            noise::add(felt, error / (high - low), [0.0, 1.0]);
        }
    }

    /// Adds errors to a seen direction, azimuth and elevation \[rad\].
    pub fn add_sight_errors(&self, errors: &mut Errors, seen: &mut [f32]) {
        for (angle, bound) in seen.iter_mut().zip([PI, FRAC_PI_2]) {
            let [error] = errors.angles(self.config.noise.sight_deg);
            noise::add(angle, error, [-bound, bound]);
        }
    }

    /// The torques of the muscles \[N·m\] when these are asked for.
    pub(super) fn with_torque_errors(&self, asked: [f64; 2], errors: &mut Errors) -> [f64; 2] {
        let error: [f64; 2] = errors.angles(self.config.noise.motor_deg);
        let Muscles { kp, torque_max, .. } = self.config.body.muscles;
        [0, 1].map(|i| (asked[i] + kp * error[i]).clamp(-torque_max, torque_max))
    }

    /// Greatest difference between equilibrium point and joint angle that is shown \[rad\].
    pub(super) fn stretch_bounds(&self) -> [f64; 2] {
        let muscles = &self.config.body.muscles;
        [0, 1].map(|i| match self.options.control {
            Control::Torque => muscles.torque_max / muscles.kp,
            _ => self.arm.upper_limit[i] - self.arm.lower[i],
        })
    }

    /// Control periods that the arm is given to settle after a movement.
    #[must_use]
    pub fn settle_steps(&self) -> usize {
        let muscles = &self.config.body.muscles;
        let settle_s = self.config.reach.settle_time_constants * muscles.kd / muscles.kp;
        (settle_s / self.config.reach.control_period_s).round() as usize
    }

    /// Physics steps of a whole movement, settling included.
    pub(super) fn movement_physics_steps(&self) -> usize {
        let periods = self.config.reach.movement_steps() + self.settle_steps();
        periods * self.config.reach.physics_steps as usize
    }

    /// Angles of a point of the plane in the camera frame \[rad\].
    #[must_use]
    pub fn angles(camera: &Pinhole, point: Vector2<f64>) -> [f64; 2] {
        camera.direction_angles(&Vector3::new(point.x, point.y, 0.0))
    }

    /// Angles of the obstacle's axis in the plane \[rad\]; without an obstacle the lowest angles,
    /// straight behind the eye.
    #[must_use]
    pub fn obstacle_angles(camera: &Pinhole, obstacle: Option<&Obstacle>) -> [f64; 2] {
        obstacle.map_or([-PI, -FRAC_PI_2], |obstacle| {
            Self::angles(camera, obstacle.centre)
        })
    }
}
