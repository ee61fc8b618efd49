//! What changes in an episode of reaching.

use babble_body::ArmState;
use babble_eye::Gaze;
use serde::{Deserialize, Serialize};

use super::case::ReachCase;
use super::request::CaseRequest;
use crate::progress::{Lifecycle, Progress};

/// Numbers in a flat observation: eye 2, obstacle 2, hand 2, arm 2, stretch 2, time 1.
pub const SENSES: usize = 11;

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
