//! What changes in an episode of grasping.

use babble_body::robot::{Ball, Posture, Setup, World};
use babble_eye::Gaze;
use serde::{Deserialize, Serialize};

use super::case::{GraspCase, GraspRequest};
use super::enclosure::Enclosure;
use super::sight::FOVEA_NEURONS;
use super::task::GraspTask;
use crate::progress::{Lifecycle, Progress, SUCCESS_FACTS};
use crate::spec::Measure;

/// Where each sense stands in a flat observation: by name, as Gymnasium flattens a Dict.
pub mod at {
    use super::FOVEA_NEURONS;

    /// Shoulder and elbow.
    pub const ARM: usize = 0;
    /// Pan and tilt.
    pub const EYE: usize = 2;
    /// Edges, row by row.
    pub const FOVEA: usize = 4;
    /// Thumb and virtual finger.
    pub const HAND: usize = FOVEA + FOVEA_NEURONS;
    /// Shoulder, elbow, thumb and finger.
    pub const STRETCH: usize = HAND + 2;
    /// Share of the episode.
    pub const TIME: usize = STRETCH + 4;
    /// Palm, thumb and fingers.
    pub const TOUCH: usize = TIME + 1;
}

/// Numbers in a flat observation, before those of `touch_arm`, which the option `arm_touch` adds.
pub const SENSES: usize = at::TOUCH + 3;
/// Upper arm, forearm, back of the hand.
pub(super) const ARM_TOUCHES: usize = 3;

/// What is true or false of an episode.
pub const FACTS: [&str; 6] = [
    SUCCESS_FACTS[0],
    SUCCESS_FACTS[1],
    "reach",
    "palm_reach",
    "held",
    "in_sight",
];

/// What an episode shows beside.
pub(super) const MEASURES: &[Measure] = &[Measure {
    name: "object",
    labels: &["x", "y", "z"],
    unit: "m",
    description: "centre of the object; from the shoulder, x right, y forward, z up",
}];

/// A recorded moment, for pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Angles of all joints \[rad\].
    pub joints: Vec<f64>,
    /// Centre of the object \[m\].
    pub object: [f64; 3],
    /// Centre of the palm \[m\].
    pub palm: [f64; 2],
    /// Where the eye looks \[rad\].
    pub gaze: Gaze,
}

/// Everything that changes: what a snapshot holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact by itself")]
pub struct GraspState {
    /// Arm, hand, object, support and obstacle.
    pub world: World,
    /// Equilibrium points of the muscles \[rad\].
    pub equilibrium: Posture,
    /// Start, object, goal.
    pub case: GraspCase,
    /// Pan and tilt \[rad\].
    pub gaze: Gaze,
    /// Whether the eye sees any of the object. Made again from the scene when a state is read.
    #[serde(skip)]
    pub in_sight: bool,
    /// Mean normal forces of palm, thumb and fingers over the last control step \[N\].
    pub touch: [f64; 3],
    /// How far the grasp has come.
    pub enclosure: Enclosure,
    /// Whether the reflex has closed the hand.
    pub reflex: bool,
    /// Clock and result.
    pub progress: Progress,
    /// Whether any part of arm or hand has touched the object.
    pub reach: bool,
    /// Whether the palm has.
    pub palm_reach: bool,
    /// Distance of the object's centre from where the palm would hold it \[m\].
    pub distance: f64,
    /// What decides the next episode.
    pub lifecycle: Lifecycle<GraspRequest>,
    /// Moments at the end of each control period, when they are recorded.
    pub trail: Vec<Moment>,
}

/// How the world of a case begins.
pub(super) fn setup(task: &GraspTask, case: &GraspCase) -> Setup {
    Setup {
        posture: task.robot.open_hand(case.start),
        ball: Ball {
            centre: case.object,
            radius: case.radius(),
        },
        support: true,
        obstacle: case.obstacle,
    }
}
