//! What follows a grasp in the goal form: the arm carries the object to where it is to be.
//!
//! What the sight of an object at a place recalls as the posture of contact is the posture in which the
//! hand holds an object there. So nothing more has to be learnt: the eye looks at the goal, and the agent
//! imagines the object, of the size that it saw, at that place.

use babble_env::tasks::grasp::{FOVEA_NEURONS, at};
use babble_env::{GraspTask, Task};

use super::acting::{ChainPolicy, Felt, LOOSE_STEPS};
use super::code::size;
use super::network::ChainNetwork;
use super::plan::{ChainPlan, Phase};
use super::targets::ChooseTargets;
use crate::error::AgentError;

/// Control steps with a grip before the arm moves.
const GRIP_STEPS: u32 = 10;

impl ChainNetwork {
    /// Shoulder and elbow that hold the object which is seen at the goal that comes after the senses, a
    /// place (x, y) \[m\]; None in a task without goals.
    ///
    /// # Errors
    /// [`AgentError`] as [`contact`](Self::contact).
    pub(super) fn imagine(
        &self,
        task: &GraspTask,
        senses: &[f32],
    ) -> Result<Option<[f64; 2]>, AgentError> {
        let goal = senses.get(task.senses_len()..);
        let Some(&[x, y]) = goal.and_then(<[f32]>::first_chunk) else {
            return Ok(None);
        };
        let eye = task.gaze_on([x, y].map(f64::from));
        let size = size(&senses[at::FOVEA..][..FOVEA_NEURONS]);
        let posture = self.contact(eye.map(|x| x as f32), size)?;
        Ok(Some(task.arm.denormalised(posture)))
    }
}

impl<C: ChooseTargets> ChainPolicy<C> {
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
    ///
    /// # Errors
    /// As [`look`](Self::look).
    pub(super) fn keep(
        &self,
        plan: &mut ChainPlan,
        felt: &Felt,
        senses: &[f32],
    ) -> Result<(), AgentError> {
        plan.loose = if felt.grips { 0 } else { plan.loose + 1 };
        if plan.loose > LOOSE_STEPS {
            if let Some(carrying) = &mut plan.carrying {
                carrying.gripped = 0;
            }
            self.look(plan, senses)?;
            plan.enter(Phase::Reach, felt.arm);
        }
        Ok(())
    }
}
