//! What the states of all tasks hold: how an episode stands, and what decides the next one.

use serde::{Deserialize, Serialize};

use crate::outcome::Outcome;
use crate::stream::Stream;

/// Facts that every task's spec begins with.
pub const SUCCESS_FACTS: [&str; 2] = ["is_success", "ever_success"];
/// Place of [`Progress::is_success`] among the facts.
pub const IS_SUCCESS: usize = 0;
/// Place of [`Progress::ever_success`] among the facts.
pub const EVER_SUCCESS: usize = 1;

/// Whether an episode can be stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Never reset, or abandoned.
    Fresh,
    /// Between reset and end.
    Running,
    /// Terminated or truncated.
    Ended,
}

/// Clock and result of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// Control steps since the reset.
    pub steps: u32,
    /// How it stands.
    pub outcome: Outcome,
    /// Whether the task is done now.
    pub is_success: bool,
    /// Whether it ever was.
    pub ever_success: bool,
}

impl Progress {
    /// At the beginning of an episode.
    pub const START: Self = Self {
        steps: 0,
        outcome: Outcome::Running,
        is_success: false,
        ever_success: false,
    };
}

/// Where an environment is in its sequence of episodes, and what decides the next one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lifecycle<R> {
    /// Whether the episode runs.
    pub phase: Phase,
    /// What the user asked of the cases, kept for autoresets.
    pub request: R,
    /// What the user asks from the next reset on, if that can play it; not checked before.
    pub pending: Option<R>,
    /// Random numbers for the cases to come.
    pub stream: Stream,
}

/// How a task's episodes end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ending {
    /// The goal form: episodes run to their time limit, whatever happens.
    pub goal: bool,
    /// A success does not end an episode.
    pub goes_on: bool,
    /// An episode is one step.
    pub single_step: bool,
    /// Time limit in control steps.
    pub max_steps: u32,
}

impl Ending {
    /// Ends the step just made, after which the task is `done` or not, and says whether it
    /// terminated or truncated the episode.
    ///
    /// The task sets the outcome of a failure; every other outcome is decided here, so that outcome,
    /// success facts and end agree. An episode that failed is no success, even where positions alone
    /// would make it one. An episode that the task ends at the time limit is both, as in Gymnasium's
    /// `TimeLimit`; an episode of one step is complete, and nothing cuts it off.
    pub(crate) fn conclude(self, progress: &mut Progress, done: bool) -> [bool; 2] {
        progress.steps += 1;
        let failed = progress.outcome.is_failure();
        progress.is_success = done && !failed;
        progress.ever_success |= progress.is_success;
        let decided = !self.goal && (failed || (progress.is_success && !self.goes_on));
        let terminated = self.single_step || decided;
        let truncated = !self.single_step && progress.steps >= self.max_steps;
        if !failed {
            progress.outcome = match (terminated || truncated, progress.is_success) {
                (false, _) => Outcome::Running,
                (true, true) => Outcome::Success,
                (true, false) => Outcome::Timeout,
            };
        }
        [terminated, truncated]
    }
}
