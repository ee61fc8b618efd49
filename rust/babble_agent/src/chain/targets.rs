//! Where arm and hand go in a grasp, and who says so: a network, or an agent of a user's own.

use std::fmt;

use babble_env::tasks::grasp::SENSES;
use babble_env::{GraspTask, Task};

use super::plan::Targets;
use super::route::{RouteChoice, State};
use crate::error::AgentError;
use crate::policy::Decisions;

/// What an agent has to know to act by the chain.
pub trait ChooseTargets: fmt::Debug + Send + Sync {
    /// The postures for a flat observation.
    ///
    /// # Errors
    /// [`AgentError`] for percepts that are no activities, or targets that are no postures.
    fn targets(&self, task: &GraspTask, senses: &[f32; SENSES]) -> Result<Targets, AgentError>;

    /// The way to the posture before the grasp; straight unless it knows others.
    fn route(&self, state: &State) -> RouteChoice {
        RouteChoice::new(0, state)
    }

    /// Numbers in a flat observation.
    fn senses_len(&self, task: &GraspTask) -> usize {
        task.senses_len()
    }

    /// Shoulder and elbow that hold the object at the goal which comes after the senses \[rad\]; None if
    /// it is not to be carried.
    ///
    /// # Errors
    /// As [`targets`](Self::targets).
    fn at_goal(&self, _task: &GraspTask, _senses: &[f32]) -> Result<Option<[f64; 2]>, AgentError> {
        Ok(None)
    }

    /// Whether a touch of the palm stops the arm and closes the hand.
    fn reflex(&self) -> bool {
        true
    }

    /// Whether the arm advances beyond the posture at contact until the palm touches.
    fn advance(&self) -> bool {
        true
    }
}

/// Six numbers: shoulder and elbow before the grasp, shoulder and elbow at contact, thumb and finger.
impl ChooseTargets for Decisions<'_> {
    fn targets(&self, _task: &GraspTask, senses: &[f32; SENSES]) -> Result<Targets, AgentError> {
        let decided: [f64; 6] = self.of(senses, 1)?[0];
        let pair = |first: usize| [decided[first], decided[first + 1]];
        Ok(Targets {
            pregrasp: pair(0),
            contact: pair(2),
            hand: pair(4),
            grip: decided[5].to_degrees() / 90.0,
        })
    }
}
