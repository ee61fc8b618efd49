//! What all episodes share: when a step ends one, and with which outcome.

use crate::outcome::Outcome;
use crate::task::Phase;

/// How a task's episodes end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ending {
    /// The goal form: episodes run to their time limit, whatever happens.
    pub(crate) goal: bool,
    /// An episode is one step.
    pub(crate) single_step: bool,
    /// Time limit in control steps.
    pub(crate) max_steps: u32,
}

/// Clock and result of an episode, to be changed at the end of a step.
#[derive(Debug)]
pub(crate) struct Progress<'a> {
    pub(crate) phase: &'a mut Phase,
    pub(crate) steps: &'a mut u32,
    pub(crate) outcome: &'a mut Outcome,
    pub(crate) is_success: &'a mut bool,
    pub(crate) ever_success: &'a mut bool,
}

impl Ending {
    /// Ends the step just made, after which the task is `done` or not, and says whether it
    /// terminated or truncated the episode.
    ///
    /// An episode that failed is no success, even where positions alone would make it one.
    pub(crate) fn conclude(self, progress: Progress<'_>, done: bool) -> [bool; 2] {
        let Progress {
            phase,
            steps,
            outcome,
            is_success,
            ever_success,
        } = progress;
        *steps += 1;
        *is_success = done && matches!(*outcome, Outcome::Running | Outcome::Success);
        *ever_success |= *is_success;
        if *outcome == Outcome::Running && *is_success && !self.goal {
            *outcome = Outcome::Success;
        }
        let terminated = self.single_step || (*outcome != Outcome::Running && !self.goal);
        let truncated = !terminated && *steps >= self.max_steps;
        if truncated && *outcome == Outcome::Running {
            *outcome = if *is_success {
                Outcome::Success
            } else {
                Outcome::Timeout
            };
        }
        if terminated || truncated {
            *phase = Phase::Ended;
        }
        [terminated, truncated]
    }
}
