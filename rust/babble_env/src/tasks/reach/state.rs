//! What changes in an episode of reaching.

use babble_body::ArmState;
use babble_eye::Gaze;
use serde::{Deserialize, Serialize};

use super::case::ReachCase;
use super::request::CaseRequest;
use crate::progress::{Lifecycle, Progress};

/// Where each sense stands in a flat observation: by name, as Gymnasium flattens a Dict.
pub mod at {
    /// Shoulder and elbow.
    pub const ARM: usize = 0;
    /// Pan and tilt.
    pub const EYE: usize = 2;
    /// Azimuth and elevation of the fingertip.
    pub const HAND: usize = 4;
    /// Azimuth and elevation of the obstacle.
    pub const OBSTACLE: usize = 6;
    /// Shoulder and elbow.
    pub const STRETCH: usize = 8;
    /// Share of the episode.
    pub const TIME: usize = 10;
}

/// Numbers in a flat observation.
pub const SENSES: usize = at::TIME + 1;

/// Everything that changes: what a snapshot holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReachState {
    /// Posture and speeds.
    pub arm: ArmState,
    /// Equilibrium points of the muscles \[rad\].
    pub equilibrium: [f64; 2],
    /// Start, target, obstacle.
    pub case: ReachCase,
    /// Pan and tilt \[rad\].
    pub gaze: Gaze,
    /// Clock and result; it is a success while the fingertip is at the target.
    pub progress: Progress,
    /// Distance from fingertip to target \[m\].
    pub distance: f64,
    /// What decides the next episode.
    pub lifecycle: Lifecycle<CaseRequest>,
    /// Postures at the end of each control period, when they are recorded.
    pub trail: Vec<[f64; 2]>,
}
