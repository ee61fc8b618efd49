//! The choices a user makes when a grasping environment is made.

use serde::{Deserialize, Serialize};

use crate::named_enum::named_enum;
use crate::options::{Control, Reward};

named_enum!(
    /// Where objects lie and arms start.
    Region, "region",
    /// Objects that the palm faces.
    PalmSide = "palm_side",
    /// All of the plane.
    Full = "full"
);

impl Region {
    /// Time limit of an episode in control steps: 12 s, or 25 s to go around the object first.
    #[must_use]
    pub const fn max_episode_steps(self) -> u32 {
        match self {
            Self::PalmSide => 240,
            Self::Full => 500,
        }
    }
}

/// The choices a user makes when a grasping environment is made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option by itself")]
pub struct GraspOptions {
    /// Meaning of the action; not `pattern`.
    pub control: Control,
    /// What is rewarded.
    pub reward: Reward,
    /// The goal form, carrying: reward −1/0, episodes run to their time limit.
    pub goal: bool,
    /// Where objects lie and arms start.
    pub region: Region,
    /// Whether the hand closes by reflex from the first touch of the palm on, whatever the action.
    pub enclosure_reflex: bool,
    /// Whether an action that opens the hand stops that reflex, until the palm is touched again.
    #[serde(default, skip_serializing_if = "is_off")]
    pub reflex_releases: bool,
    /// Whether the object's support is never taken away. The hand can then grasp and release over and
    /// over: an episode goes on to its time limit, and is a success while the hand holds the object.
    #[serde(default, skip_serializing_if = "is_off")]
    pub support_stays: bool,
    /// Whether upper arm, forearm and the back of the hand feel the object.
    #[serde(default, skip_serializing_if = "is_off")]
    pub arm_touch: bool,
    /// Share of the sampled cases that begin with the object at the palm of the open hand.
    pub in_hand_starts: f64,
    /// Time limit in control steps.
    pub max_episode_steps: u32,
    /// Whether moments are recorded, for pictures.
    pub record: bool,
}

impl Default for GraspOptions {
    fn default() -> Self {
        Self {
            control: Control::DeltaPosture,
            reward: Reward::Progress,
            goal: false,
            region: Region::PalmSide,
            enclosure_reflex: false,
            reflex_releases: false,
            support_stays: false,
            arm_touch: false,
            in_hand_starts: 0.0,
            max_episode_steps: Region::PalmSide.max_episode_steps(),
            record: false,
        }
    }
}

/// Whether an option is off. Such an option is left out of a snapshot's fingerprint, so that states
/// from before it existed still load.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it")]
const fn is_off(option: &bool) -> bool {
    !*option
}
