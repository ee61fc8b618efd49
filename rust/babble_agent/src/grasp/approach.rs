//! An agent that shows where along the palm a ball must lie to be held.

use std::sync::Arc;

use babble_env::tasks::grasp::at;
use babble_env::{Control, Executor, GraspTask, Task};

use super::policy::{POSTURE, towards};
use crate::chain::infant::ADVANCE_RAD;
use crate::error::AgentError;
use crate::policy::{Grasp, Plan, Policy};

/// Bends the elbow alone, with the hand open, until the palm touches; then the arm stops and the hand closes
/// as the reflex does. It sees nothing.
#[derive(Debug)]
pub struct ElbowApproach {
    task: Arc<GraspTask>,
}

impl ElbowApproach {
    /// An agent for a task.
    ///
    /// # Errors
    /// [`AgentError::Config`] for `torque` control, in which there are no postures.
    pub fn new(task: Arc<GraspTask>) -> Result<Self, AgentError> {
        if task.options.control == Control::Torque {
            return Err(AgentError::Config {
                field: "control",
                problem:
                    "'torque': this agent bends the elbow by postures; use posture or delta_posture"
                        .to_owned(),
            });
        }
        Ok(Self { task })
    }

    /// Shoulder and elbow that a flat observation feels \[rad\].
    fn felt(&self, senses: &[f32]) -> [f64; 2] {
        let shares = [0, 1].map(|i| f64::from(senses[POSTURE[i]]));
        self.task.arm.denormalised(shares)
    }
}

impl Policy for ElbowApproach {
    fn senses_len(&self) -> usize {
        self.task.senses_len()
    }

    fn action_len(&self) -> usize {
        4
    }

    fn plan(&self, senses: &[f32], _executor: &mut Executor) -> Result<Vec<Plan>, AgentError> {
        let all = senses.chunks_exact(self.senses_len());
        let plan = |senses| Plan::Grasp(Grasp::straight(self.felt(senses), self.task.reflex()));
        Ok(all.map(plan).collect())
    }

    fn decide(
        &self,
        _senses: &[f32],
        _executor: &mut Executor,
    ) -> Result<Vec<Vec<f64>>, AgentError> {
        Err(AgentError::Config {
            field: "agent",
            problem: "the agent that bends the elbow chooses nothing beforehand".to_owned(),
        })
    }

    fn act(&self, plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        let Plan::Grasp(grasp) = plan else {
            action.fill(0.0);
            return Ok(());
        };
        if !grasp.touched && senses[at::TOUCH] > 0.0 {
            grasp.touched = true;
            grasp.posture[..2].copy_from_slice(&self.felt(senses));
        }
        let mut wanted = grasp.posture;
        if !grasp.touched {
            grasp.posture[1] += ADVANCE_RAD;
            let ranges = self.task.robot.ranges();
            wanted = [wanted[0], grasp.posture[1], ranges[2][0], ranges[3][0]];
        }
        grasp.step += 1;
        towards(&self.task, wanted, senses, action);
        Ok(())
    }
}
