//! What changes in an episode of grasping.

use babble_body::robot::{Ball, Posture, Setup, World};
use babble_eye::Gaze;
use serde::{Deserialize, Serialize};

use super::case::{GraspCase, GraspRequest};
use super::enclosure::Enclosure;
use super::task::GraspTask;
use crate::episode::Progress;
use crate::outcome::Outcome;
use crate::stream::Stream;
use crate::task::Phase;

/// What is true or false of an episode.
pub const FACTS: [&str; 5] = ["is_success", "ever_success", "reach", "palm_reach", "held"];
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
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a fact of the episode"
)]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct GraspState {
    /// Arm, hand, object, support and obstacle.
    pub world: World,
    /// Equilibrium points of the muscles \[rad\].
    pub equilibrium: Posture,
    /// Start, object, goal.
    pub case: GraspCase,
    /// Pan and tilt \[rad\].
    pub gaze: Gaze,
    /// Mean normal forces of palm, thumb and fingers over the last control step \[N\].
    pub touch: [f64; 3],
    /// How far the grasp has come.
    pub enclosure: Enclosure,
    /// Whether the reflex has closed the hand.
    pub reflex: bool,
    /// Control steps since the reset.
    pub steps: u32,
    /// How it stands.
    pub outcome: Outcome,
    /// Whether the task is done now.
    pub is_success: bool,
    /// Whether it ever was.
    pub ever_success: bool,
    /// Whether any part of arm or hand has touched the object.
    pub reach: bool,
    /// Whether the palm has.
    pub palm_reach: bool,
    /// Distance of the object's centre from where the palm would hold it \[m\].
    pub distance: f64,
    /// Whether the episode runs.
    pub phase: Phase,
    /// What the user asked of the cases, kept for autoresets.
    pub request: GraspRequest,
    /// Random numbers for the cases to come.
    pub stream: Stream,
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

impl GraspState {
    /// Clock and result.
    pub(super) fn progress(&mut self) -> Progress<'_> {
        Progress {
            phase: &mut self.phase,
            steps: &mut self.steps,
            outcome: &mut self.outcome,
            is_success: &mut self.is_success,
            ever_success: &mut self.ever_success,
        }
    }
}
