//! What follows a grasp in the goal form: the arm carries the object to where it is to be.
//!
//! What the sight of an object at a place recalls as the posture of contact is the posture in which the
//! hand holds an object there. So nothing more has to be learnt: the eye looks at the goal, and the agent
//! imagines the object, of the size that it saw, at that place.

use babble_env::Task;
use babble_env::tasks::grasp::{FOVEA_NEURONS, at};

use super::acting::{ChainPolicy, Felt, LOOSE_STEPS};
use super::code::size;
use super::plan::{Carrying, ChainPlan, Phase};
use crate::error::AgentError;

/// Control steps with a grip before the arm moves.
const GRIP_STEPS: u32 = 10;

impl ChainPolicy<'_> {
    /// How to carry the object that is seen to the goal that comes after the senses, a place (x, y) \[m\];
    /// None in a task without goals.
    ///
    /// # Errors
    /// [`AgentError`] as [`ChainNetwork::contact`](super::ChainNetwork::contact).
    pub(super) fn carrying(&self, senses: &[f32]) -> Result<Option<Carrying>, AgentError> {
        let goal = senses.get(self.task.senses_len()..);
        let Some(&[x, y]) = goal.and_then(<[f32]>::first_chunk) else {
            return Ok(None);
        };
        let eye = self.task.gaze_on([x, y].map(f64::from));
        let size = size(&senses[at::FOVEA..][..FOVEA_NEURONS]);
        let posture = self.network.contact(eye.map(|x| x as f32), size)?;
        Ok(Some(Carrying {
            posture: self.task.arm.denormalised(posture),
            gripped: 0,
        }))
    }

    /// Goes over from closing to carrying once the hand has had a grip for a while.
    pub(super) fn lift(plan: &mut ChainPlan, felt: &Felt) {
        let Some(carrying) = &mut plan.carrying else {
            return;
        };
        carrying.gripped = if felt.grips { carrying.gripped + 1 } else { 0 };
        if carrying.gripped >= GRIP_STEPS {
            plan.enter(Phase::Carry, felt.arm);
        }
    }

    /// Begins the grasp anew if the hand has lost the object on the way.
    pub(super) fn keep(&self, plan: &mut ChainPlan, felt: &Felt, senses: &[f32]) {
        plan.loose = if felt.grips { 0 } else { plan.loose + 1 };
        if plan.loose > LOOSE_STEPS {
            if let Some(carrying) = &mut plan.carrying {
                carrying.gripped = 0;
            }
            self.look(plan, senses);
            plan.enter(Phase::Reach, felt.arm);
        }
    }
}
