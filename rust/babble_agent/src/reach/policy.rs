//! Agents that choose whole movements, and how they act in each control.

use std::fmt;
use std::sync::Arc;

use babble_env::tasks::reach::{SENSES, at};
use babble_env::{Control, EnvError, Executor, ReachTask};

use super::reference::{case_from_senses, oracle, plan, scripted};
use crate::error::AgentError;
use crate::policy::{Decisions, Plan, Policy, Random};

/// How an agent chooses a movement.
pub trait ChooseMovement: fmt::Debug + Send + Sync {
    /// Parameters (b1, b2) of the movement for what is seen at its beginning.
    ///
    /// # Errors
    /// [`AgentError`] for senses that point nowhere.
    fn choose(&self, task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError>;

    /// The same for each of these flat observations.
    ///
    /// # Errors
    /// As [`choose`](Self::choose), or an error of the executor.
    fn choose_all(
        &self,
        task: &ReachTask,
        all: &[[f32; SENSES]],
        executor: &mut Executor,
    ) -> Result<Vec<[f64; 2]>, AgentError> {
        if let [one] = all {
            return Ok(vec![self.choose(task, one)?]);
        }
        executor.map(0..all.len(), |i, _| self.choose(task, &all[i]))
    }
}

/// Bulges towards the shoulder, where the arm folds away from the obstacle.
#[derive(Debug, Clone, Copy)]
pub struct Scripted;

/// Simulates up to 99 movements and takes the middle of the longest run that succeeds.
#[derive(Debug, Clone, Copy)]
pub struct Oracle;

/// b1 uniform in its range, b2 = 1 − b1.
impl ChooseMovement for Random {
    fn choose(&self, task: &ReachTask, _senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        let [low, high] = task.config.reach.b_range;
        let b1 = self.next().uniform(low, high);
        Ok([b1, 1.0 - b1])
    }
}

impl ChooseMovement for Scripted {
    fn choose(&self, task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        Ok(scripted(&case_from_senses(task, senses)?))
    }
}

impl ChooseMovement for Oracle {
    fn choose(&self, task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        Ok(oracle(task, &case_from_senses(task, senses)?)?)
    }
}

impl ChooseMovement for Decisions<'_> {
    fn choose(&self, _task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        Ok(self.of(senses, 1)?[0])
    }

    fn choose_all(
        &self,
        _task: &ReachTask,
        all: &[[f32; SENSES]],
        _executor: &mut Executor,
    ) -> Result<Vec<[f64; 2]>, AgentError> {
        self.of(all.as_flattened(), all.len())
    }
}

impl<C: ChooseMovement> ChooseMovement for &C {
    fn choose(&self, task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        (*self).choose(task, senses)
    }
}

/// An agent that chooses once per movement.
///
/// In `pattern` control an action is its choice. In `posture` and `delta_posture` control it plays the
/// path of the pattern generators open loop: the start from the arm's proprioception, the target from
/// the eye's, a posture a control step from inverse kinematics.
#[derive(Debug)]
pub struct ReachPolicy<C> {
    task: Arc<ReachTask>,
    choice: C,
}

impl<C: ChooseMovement> ReachPolicy<C> {
    /// An agent for a task.
    ///
    /// # Errors
    /// [`AgentError::Config`] for `torque` control, in which there are no postures to plan.
    pub fn new(task: Arc<ReachTask>, choice: C) -> Result<Self, AgentError> {
        if task.options.control == Control::Torque {
            return Err(AgentError::Config {
                field: "control",
                problem: "'torque': this agent plans postures; use pattern, posture or \
                          delta_posture"
                    .to_owned(),
            });
        }
        Ok(Self { task, choice })
    }

    /// Parameters (b1, b2) of a movement for each flat observation of `senses`.
    ///
    /// # Errors
    /// As [`Policy::plan`].
    pub fn choose(
        &self,
        senses: &[f32],
        executor: &mut Executor,
    ) -> Result<Vec<[f64; 2]>, AgentError> {
        let (all, _) = senses.as_chunks::<SENSES>();
        self.choice.choose_all(&self.task, all, executor)
    }

    fn begin(&self, senses: &[f32; SENSES], b: [f64; 2]) -> Result<Plan, EnvError> {
        if self.task.options.control == Control::Pattern {
            return Ok(Plan::Movement(b.map(|b| (2.0 * b - 1.0) as f32)));
        }
        let case = case_from_senses(&self.task, senses)?;
        Ok(Plan::Trajectory {
            shares: plan(&self.task, &case, b)?.into(),
            step: 0,
        })
    }
}

impl<C: ChooseMovement> Policy for ReachPolicy<C> {
    fn senses_len(&self) -> usize {
        SENSES
    }

    fn action_len(&self) -> usize {
        2
    }

    fn plan(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Plan>, AgentError> {
        let chosen = self.choose(senses, executor)?;
        let (all, _) = senses.as_chunks::<SENSES>();
        let plans = all.iter().zip(chosen).map(|(s, b)| self.begin(s, b));
        Ok(plans.collect::<Result<_, _>>()?)
    }

    fn decide(&self, senses: &[f32], executor: &mut Executor) -> Result<Vec<Vec<f64>>, AgentError> {
        let chosen = self.choose(senses, executor)?;
        Ok(chosen.into_iter().map(|b| b.to_vec()).collect())
    }

    fn act(&self, plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        match plan {
            Plan::Movement(chosen) => action.copy_from_slice(chosen),
            Plan::Trajectory { shares, step } => {
                let share = shares[(*step).min(shares.len() - 1)];
                *step += 1;
                for i in 0..2 {
                    action[i] = self.towards(i, share[i], senses);
                }
            }
            Plan::Steps | Plan::Grasp(_) | Plan::Chain(_) => action.fill(0.0),
        }
        Ok(())
    }
}

impl<C> ReachPolicy<C> {
    /// The action that moves the equilibrium point of joint `i` to a share of its range.
    fn towards(&self, i: usize, share: f32, senses: &[f32]) -> f32 {
        if self.task.options.control == Control::Posture {
            return 2.0 * share - 1.0;
        }
        let (arm, unit) = (&self.task.arm, self.task.config.reach.delta_posture_deg);
        let width = arm.upper_limit[i] - arm.lower[i];
        // The equilibrium point is angle plus stretch.
        let wanted = f64::from(share - senses[at::ARM + i]) * width;
        let change = wanted - f64::from(senses[at::STRETCH + i]);
        (change / unit.to_radians()).clamp(-1.0, 1.0) as f32
    }
}
