//! Everything about reaching that stays the same within and between episodes.

use babble_body::description::{self, LinkDescription};
use babble_body::visual;
use babble_body::{ArmState, Body, ContactWatch, Dynamics, Obstacle, PlanarArm};
use babble_eye::{Eye, Gaze, Pinhole};
use image::RgbImage;
use nalgebra::{Vector2, Vector3};
use serde::Serialize;
use serde_json::{Value, json};

use super::case::{CaseRequest, ReachCase};
use super::entry::ENTRY;
use super::episode::{Reach, ReachState, SENSES, goal_reward};
use super::options::ReachOptions;
use super::{picture, protocol, spec};
use crate::case::{CasePart, CaseValues};
use crate::config::{Config, ReachNumbers};
use crate::error::EnvError;
use crate::executor::Executor;
use crate::options::{Control, Reward, check_max_episode_steps};
use crate::outcome::Outcome;
use crate::picture::View;
use crate::spec::Spec;
use crate::stream::Purpose;
use crate::task::Task;

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

/// The part of a config that reaching depends on.
#[derive(Serialize)]
struct Fingerprint<'a> {
    profile: &'a str,
    body: &'a Body,
    reach: &'a ReachNumbers,
}

impl Task for ReachTask {
    type Episode = Reach;

    const NAME: &'static str = "reaching";
    const MAGIC: [u8; 4] = *b"BBRS";
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn min_per_thread(&self) -> usize {
        // A whole movement, or a control step of about a microsecond.
        match self.options.control {
            Control::Pattern => 1,
            _ => 8,
        }
    }

    fn action_len(&self) -> usize {
        2
    }

    fn senses_len(&self) -> usize {
        SENSES
    }

    fn spec(&self) -> Spec {
        spec::spec(self)
    }

    fn fingerprint(&self) -> impl Serialize {
        // Recording is for pictures and changes no episode.
        let options = ReachOptions {
            record: false,
            ..self.options
        };
        let Config {
            profile,
            body,
            reach,
            ..
        } = &self.config;
        let config = Fingerprint {
            profile,
            body,
            reach,
        };
        (config, options)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn quantities(&self) -> Value {
        let width = |i: usize| self.arm.upper_limit[i] - self.arm.lower[i];
        json!({
            "joint_range": [width(0), width(1)],
            "delta_posture": self.config.reach.delta_posture_deg.to_radians(),
            "b_range": self.config.reach.b_range,
        })
    }

    fn robot(&self) -> Vec<LinkDescription> {
        description::reaching(&self.config.body).to_vec()
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        goal_reward(
            &self.config,
            [0, 1].map(|i| achieved[i]),
            [0, 1].map(|i| desired[i]),
        )
    }

    fn request(&self, asked: &CaseValues) -> CaseRequest {
        CaseRequest::from_values(self, asked)
    }

    fn case(&self, state: &ReachState) -> CaseValues {
        state.case.values()
    }

    fn cases(
        &self,
        name: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError> {
        let cases = if ENTRY.protocol(name)?.random {
            let sampled = protocol::table1(self, n, seed, purpose, executor)?;
            sampled.into_iter().map(Some).collect()
        } else {
            protocol::fig4(self)
        };
        Ok(cases
            .iter()
            .map(|case| Some(case.as_ref()?.values()))
            .collect())
    }

    fn trail(&self, state: &ReachState) -> Vec<[f64; 2]> {
        let tip = |&q| self.arm.fingertip(q).into();
        state.trail.iter().map(tip).collect()
    }

    fn moments(&self, state: &ReachState) -> usize {
        state.trail.len()
    }

    fn picture(
        &self,
        state: &ReachState,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        picture::picture(self, state, view, size, frame)
    }
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
    #[inline]
    pub fn advance(
        &self,
        arm: &mut ArmState,
        watch: &mut ContactWatch,
        step: impl Fn(ArmState, f64) -> ArmState,
    ) -> bool {
        let dt = self.config.reach.physics_step_s();
        for _ in 0..self.config.reach.physics_steps {
            let next = step(*arm, dt);
            if let Some(share) = watch.touch(&self.arm, arm.q, next.q) {
                let q = [0, 1].map(|i| arm.q[i] + share * (next.q[i] - arm.q[i]));
                *arm = ArmState::at_rest(q);
                return true;
            }
            *arm = next;
        }
        false
    }

    /// Control periods that the arm is given to settle after a movement.
    #[must_use]
    pub fn settle_steps(&self) -> usize {
        let muscles = &self.config.body.muscles;
        let settle_s = self.config.reach.settle_time_constants * muscles.kd / muscles.kp;
        (settle_s / self.config.reach.control_period_s).round() as usize
    }

    /// Outcome of a movement that ended undisturbed in posture `q`.
    #[must_use]
    pub fn end_of_movement(&self, case: &ReachCase, q: [f64; 2]) -> Outcome {
        if self.distance(case, q) <= self.config.reach.success_radius_m {
            Outcome::Success
        } else {
            Outcome::Timeout
        }
    }

    /// Distance from the fingertip to the target \[m\].
    #[must_use]
    pub fn distance(&self, case: &ReachCase, q: [f64; 2]) -> f64 {
        (self.arm.fingertip(q) - Vector2::from(case.target)).norm()
    }

    /// The gaze that the reflex of Eq. 1 ends in for `case`, from pixels.
    ///
    /// The red of the target shows through obstacle and arm: Sect. II-A assumes that the eye always
    /// foveates the target, and a solid obstacle of any height would hide it in some cases.
    ///
    /// # Errors
    /// [`EnvError::Body`] when the eye cannot find the target.
    pub fn foveate(&self, case: &ReachCase) -> Result<Gaze, EnvError> {
        let scene = [visual::target(&self.config.body, case.target)];
        Ok(self
            .eye
            .foveate(&scene, self.eye.rest())
            .map_err(babble_body::BodyError::from)?)
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
        use std::f64::consts::{FRAC_PI_2, PI};
        obstacle.map_or([-PI, -FRAC_PI_2], |obstacle| {
            Self::angles(camera, obstacle.centre)
        })
    }
}
