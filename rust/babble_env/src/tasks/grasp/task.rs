//! Everything about grasping that stays the same within and between episodes.

use babble_body::config::Muscles;
use babble_body::joints::Joint;
use babble_body::robot::{MuscleCommand, MuscleCommands, World};
use babble_body::{PlanarArm, Robot};
use babble_eye::Eye;
use nalgebra::{Vector2, Vector3};

use super::config::RegionConfig;
use super::options::{GraspOptions, Region};
use crate::config::Config;
use crate::error::EnvError;
use crate::options::{Control, Reward};
use crate::stream::Stream;
use crate::task::GoalSpace;

/// Gap between the open hand's palm and the object that is put there \[m\]; 1 mm \[C\].
const GAP_M: f64 = 0.001;
/// How often a case is drawn before the config is called impossible.
pub(super) const MAX_TRIES: u32 = 10_000;

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
        if !(0.0..=1.0).contains(&options.in_hand_starts) {
            return Err(EnvError::OutOfBounds {
                option: "in_hand_starts",
                value: options.in_hand_starts.to_string(),
                bound: "in [0, 1]".to_owned(),
            });
        }
        if options.reflex_releases && !options.enclosure_reflex {
            return Err(EnvError::OptionKind {
                option: "reflex_releases",
                value: "true".to_owned(),
                expected: "possible without enclosure_reflex: there is no reflex to stop"
                    .to_owned(),
            });
        }
        check_locks(&config)?;
        Ok(Self {
            robot: Robot::new(&config.body, config.grasp.physics_step_s()),
            arm: PlanarArm::new(&config.body),
            eye: Eye::new(config.body.eye.clone()).map_err(babble_body::BodyError::from)?,
            config,
            options,
        })
    }

    /// What the goal form can achieve: its positions lie a little beyond the arm's reach, where an
    /// object can be pushed.
    pub(super) fn goal_space(&self) -> GoalSpace {
        GoalSpace {
            bound: self.arm.length() + 0.2,
            radius: self.config.grasp.success_radius_m,
        }
    }

    /// Where objects lie and arms start.
    #[must_use]
    pub const fn region(&self) -> &RegionConfig {
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

    /// What the muscles do when this is asked of them and their equilibrium points have these errors
    /// \[rad\].
    #[must_use]
    pub fn with_errors(&self, asked: MuscleCommands, errors: [f64; 4]) -> MuscleCommands {
        if self.config.noise.motor_deg == 0.0 {
            return asked;
        }
        let (muscles, ranges) = (self.muscles(), self.robot.ranges());
        std::array::from_fn(|i| match asked[i] {
            MuscleCommand::EquilibriumPoint(q) => {
                let [low, high] = ranges[i];
                MuscleCommand::EquilibriumPoint((q + errors[i]).clamp(low, high))
            }
            MuscleCommand::Torque(torque) => {
                let Muscles { kp, torque_max, .. } = muscles[i];
                MuscleCommand::Torque((torque + kp * errors[i]).clamp(-torque_max, torque_max))
            }
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

    /// Pan and tilt, over their ranges, of an eye that looks at a place in the arm's plane \[m\].
    #[must_use]
    pub fn gaze_on(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let gaze = self.eye.fixate(&Vector3::new(x, y, 0.0));
        self.eye.normalised(self.eye.clipped(gaze))
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

    /// Centre of a ball that is put into the open hand of the arm in a posture \[rad\].
    #[must_use]
    pub fn at_palm(&self, arm: [f64; 2], radius: f64) -> [f64; 2] {
        self.before_palm(arm, radius, GAP_M)
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
