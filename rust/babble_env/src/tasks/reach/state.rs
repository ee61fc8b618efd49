//! What changes in an episode of reaching.

use babble_body::ArmState;
use babble_eye::Gaze;
use serde::{Deserialize, Serialize};

use super::case::ReachCase;
use super::request::CaseRequest;
use crate::episode::Progress;
use crate::outcome::Outcome;
use crate::stream::Stream;
use crate::task::Phase;

/// Numbers in a flat observation: eye 2, obstacle 2, hand 2, arm 2, stretch 2, time 1.
pub const SENSES: usize = 11;
/// What is true or false of an episode.
pub(super) const FACTS: [&str; 2] = ["is_success", "ever_success"];
/// Place of [`ReachState::is_success`] among the facts.
pub const IS_SUCCESS: usize = 0;
/// Place of [`ReachState::ever_success`] among the facts.
pub const EVER_SUCCESS: usize = 1;
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
    /// Control steps since the reset.
    pub steps: u32,
    /// How it stands.
    pub outcome: Outcome,
    /// Whether the fingertip is at the target now.
    pub is_success: bool,
    /// Whether it ever was.
    pub ever_success: bool,
    /// Distance from fingertip to target \[m\].
    pub distance: f64,
    /// Whether the episode runs.
    pub phase: Phase,
    /// What the user asked of the cases, kept for autoresets.
    pub request: CaseRequest,
    /// Random numbers for the cases to come.
    pub stream: Stream,
    /// Postures at the end of each control period, when they are recorded.
    pub trail: Vec<[f64; 2]>,
}

impl ReachState {
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
