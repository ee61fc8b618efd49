//! The choices a user makes when a reaching environment is made.

use serde::{Deserialize, Serialize};

use crate::options::{Control, Reward};

/// Time limit of an episode in control steps; 240 are 12 s.
pub const MAX_EPISODE_STEPS: u32 = 240;

/// The choices a user makes when a reaching environment is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReachOptions {
    /// Meaning of the action.
    pub control: Control,
    /// What is rewarded.
    pub reward: Reward,
    /// The goal form: reward −1/0, episodes run to their time limit.
    pub goal: bool,
    /// Whether success also needs the arm to have come to rest.
    pub settled: bool,
    /// Time limit in control steps; a movement in `pattern` control is one step.
    pub max_episode_steps: u32,
    /// Whether postures are recorded, for pictures.
    pub record: bool,
}

impl Default for ReachOptions {
    fn default() -> Self {
        Self {
            control: Control::DeltaPosture,
            reward: Reward::Progress,
            goal: false,
            settled: false,
            max_episode_steps: MAX_EPISODE_STEPS,
            record: false,
        }
    }
}
