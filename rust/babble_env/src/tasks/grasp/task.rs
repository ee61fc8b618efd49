//! Everything about grasping that stays the same within and between episodes.

use babble_body::config::Muscles;
use babble_body::description::LinkDescription;
use babble_body::joints::Joint;
use babble_body::robot::World;
use babble_body::{PlanarArm, Robot};
use babble_eye::Eye;
use image::RgbImage;
use nalgebra::{Vector2, Vector3};
use serde::Serialize;
use serde_json::{Value, json};

use super::case::{GraspRequest, MAX_TRIES};
use super::entry::ENTRY;
use super::episode::{Grasp, GraspState, goal_reward};
use super::numbers::RegionNumbers;
use super::options::{GraspOptions, Region};
use super::sight::FOVEA_NEURONS;
use super::{picture, protocol, spec};
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::Executor;
use crate::options::{Control, Reward};
use crate::picture::View;
use crate::spec::Spec;
use crate::stream::{Purpose, Stream};
use crate::task::Task;

/// Params of the grasping task.
#[derive(Debug, Clone)]
pub struct GraspTask {
    /// The config it was made from.
    pub config: Config,
    /// The user's choices.
    pub options: GraspOptions,
    /// Arm, hand and their world.
    pub robot: Robot,
    /// Kinematics of the arm.
    pub arm: PlanarArm,
    /// The eye.
    pub eye: Eye,
}

impl Task for GraspTask {
    type Episode = Grasp;

    const NAME: &'static str = "grasping";
    const MAGIC: [u8; 4] = *b"BBGS";
    const CASE_PARTS: &'static [CasePart] = ENTRY.case_parts;

    fn min_per_thread(&self) -> usize {
        1
    }

    fn action_len(&self) -> usize {
        4
    }

    fn senses_len(&self) -> usize {
        FOVEA_NEURONS + 14
    }

    fn spec(&self) -> Spec {
        spec::spec(self)
    }

    fn fingerprint(&self) -> impl Serialize {
        // Recording is for pictures and changes no episode.
        let options = GraspOptions {
            record: false,
            ..self.options
        };
        let Config {
            profile,
            body,
            grasp,
            ..
        } = &self.config;
        (profile, body, grasp, options)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn quantities(&self) -> Value {
        json!({
            "ranges": self.robot.ranges(),
            "reflex": self.reflex(),
            "delta_posture": self.config.grasp.delta_posture_deg.to_radians(),
        })
    }

    fn robot(&self) -> Vec<LinkDescription> {
        self.robot.description()
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        goal_reward(
            &self.config,
            [0, 1].map(|i| achieved[i]),
            [0, 1].map(|i| desired[i]),
        )
    }

    fn request(&self, asked: &CaseValues) -> GraspRequest {
        GraspRequest::from_values(self, asked)
    }

    fn case(&self, state: &GraspState) -> CaseValues {
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
        let protocol = ENTRY.protocol(name)?;
        let cases = match (protocol.random, protocol.name) {
            (true, _) => {
                let drawn = protocol::random(self, n, seed, purpose, executor)?;
                drawn.into_iter().map(Some).collect()
            }
            (false, "fig7") => protocol::fig7(self),
            (false, _) => protocol::table2(self),
        };
        Ok(cases
            .iter()
            .map(|case| Some(case.as_ref()?.values()))
            .collect())
    }

    fn trail(&self, state: &GraspState) -> Vec<[f64; 2]> {
        state.trail.iter().map(|moment| moment.palm).collect()
    }

    fn moments(&self, state: &GraspState) -> usize {
        state.trail.len()
    }

    fn picture(
        &self,
        state: &GraspState,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        picture::picture(self, state, view, size, frame)
    }
}

impl GraspTask {
    /// A task from a config, which is checked here once.
    ///
    /// # Errors
    /// [`EnvError`] naming the field or option that is out of bounds.
    pub fn new(config: Config, options: GraspOptions) -> Result<Self, EnvError> {
        config.validate()?;
        if options.goal && options.reward == Reward::Progress {
            return Err(EnvError::Option {
                option: "reward",
                value: options.reward.to_string(),
                known: "sparse when obs = \"goal\"".to_owned(),
            });
        }
        if options.control == Control::Pattern {
            return Err(EnvError::Option {
                option: "control",
                value: options.control.to_string(),
                known: "delta_posture, posture, torque in grasping".to_owned(),
            });
        }
        crate::options::check_max_episode_steps(options.max_episode_steps)?;
        check_locks(&config)?;
        Ok(Self {
            robot: Robot::new(&config.body, config.grasp.physics_step_s()),
            arm: PlanarArm::new(&config.body),
            eye: Eye::new(config.body.eye.clone()).map_err(babble_body::BodyError::from)?,
            config,
            options,
        })
    }

    /// Greatest coordinate of a goal \[m\]: a little beyond the arm's reach, where an object can be
    /// pushed.
    #[must_use]
    pub fn goal_bound(&self) -> f64 {
        self.arm.length() + 0.2
    }

    /// Where objects lie and arms start.
    #[must_use]
    pub const fn region(&self) -> &RegionNumbers {
        match self.options.region {
            Region::PalmSide => &self.config.grasp.palm_side,
            Region::Full => &self.config.grasp.full,
        }
    }

    /// Flexions that the enclosure reflex asks of thumb and fingers \[rad\].
    #[must_use]
    pub fn reflex(&self) -> [f64; 2] {
        self.config.body.grip.reflex_deg.map(f64::to_radians)
    }

    /// Muscles of shoulder, elbow, thumb and finger.
    #[must_use]
    pub const fn muscles(&self) -> [Muscles; 4] {
        let grip = &self.config.body.grip;
        [
            grip.arm_muscles,
            grip.arm_muscles,
            grip.hand_muscles,
            grip.hand_muscles,
        ]
    }

    /// Greatest difference between equilibrium point and joint angle that is shown \[rad\].
    #[must_use]
    pub fn stretch_bounds(&self) -> [f64; 4] {
        let (muscles, ranges) = (self.muscles(), self.robot.ranges());
        std::array::from_fn(|i| match self.options.control {
            Control::Torque => muscles[i].torque_max / muscles[i].kp,
            _ => ranges[i][1] - ranges[i][0],
        })
    }

    /// Shoulder and elbow \[rad\] that bring the palm to an object at rest, if the arm can; the
    /// object then lies against the palm.
    #[must_use]
    pub fn grasp_posture(&self, object: [f64; 2], radius: f64) -> Option<[f64; 2]> {
        self.arm
            .with_tip(self.pocket_in_forearm(radius))
            .posture_at(object.into())
            .filter(|&q| self.arm.in_range(q) && self.clears_upper_arm(q[1], radius))
    }

    /// A diameter of the config \[m\].
    pub fn draw_diameter(&self, stream: &mut Stream) -> f64 {
        let numbers = &self.config.grasp;
        let share = stream.uniform(0.0, 1.0);
        if numbers.any_diameter_between {
            let [low, high] = numbers.diameter_range_m();
            return low + share * (high - low);
        }
        let all = &numbers.diameters_m;
        all[((share * all.len() as f64) as usize).min(all.len() - 1)]
    }

    /// Centre of a ball that lies `gap` \[m\] before the palm of the arm in a posture \[rad\].
    #[must_use]
    pub fn before_palm(&self, arm: [f64; 2], radius: f64, gap: f64) -> [f64; 2] {
        let pocket = self.pocket_in_forearm(radius) + Vector2::new(0.0, gap);
        self.arm.with_tip(pocket).fingertip(arm).into()
    }

    /// Whether a ball in the hand is clear of the upper arm with the elbow at `elbow` \[rad\].
    #[must_use]
    pub fn clears_upper_arm(&self, elbow: f64, radius: f64) -> bool {
        let [x, y] = self.before_palm([0.0, elbow], radius, 0.0);
        let beside = (x - x.clamp(0.0, self.arm.upper)).abs();
        libm::hypot(beside, y) > self.arm.half_width + radius
    }

    /// A random posture of the arm in which a ball in the hand is clear of the upper arm \[rad\].
    ///
    /// # Errors
    /// [`EnvError::NoGraspCase`] if the elbow cannot stretch that far.
    pub fn draw_free_posture(
        &self,
        radius: f64,
        stream: &mut Stream,
    ) -> Result<[f64; 2], EnvError> {
        for _ in 0..MAX_TRIES {
            let share = [0, 1].map(|_| stream.uniform(0.0, 1.0));
            let posture = self.arm.denormalised(share);
            if self.clears_upper_arm(posture[1], radius) {
                return Ok(posture);
            }
        }
        Err(EnvError::NoGraspCase {
            tries: MAX_TRIES,
            problem: "an object in the hand is not clear of the upper arm".to_owned(),
        })
    }

    /// Whether the object is on the palm's side and near it.
    #[must_use]
    pub fn in_hand(&self, world: &World, radius: f64) -> bool {
        let centre = self.robot.object(world);
        let local = self.robot.palm(world).local_from_world(&centre);
        local.y > 0.0 && local.norm() <= radius + self.config.grasp.palm_reach_m
    }

    /// From where the palm would hold the object to where it is, in the palm's frame \[m\].
    #[must_use]
    pub fn pocket_offset(&self, world: &World, radius: f64) -> Vector3<f64> {
        let centre = self.robot.object(world);
        self.robot.palm(world).local_from_world(&centre) - self.robot.pocket(radius)
    }

    fn pocket_in_forearm(&self, radius: f64) -> Vector2<f64> {
        self.robot.pocket(radius).xy() + Vector2::new(self.robot.palm_centre(), 0.0)
    }
}

/// The hand's own joints flex as the grip has it, and all others are straight: a lock that reaching
/// can have would go unseen here.
fn check_locks(config: &Config) -> Result<(), EnvError> {
    let bent = |joint: &Joint| joint.locked_deg.is_some_and(|angle| angle != 0.0);
    match config.body.joints.iter().find(|(_, joint)| bent(joint)) {
        None => Ok(()),
        Some((name, _)) => Err(EnvError::Config {
            field: format!("body.joints.{name}.locked_deg"),
            problem: "must be 0 in grasping, whose hand is set by body.grip".to_owned(),
        }),
    }
}
