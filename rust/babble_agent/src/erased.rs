//! Agents of any task behind one object-safe trait each, by name and from files: for faces that choose
//! the task at run time.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use babble_brain::Association;
use babble_env::{AnyTask, Config, Executor, GraspTask, Outcome, ReachTask, Task, downcast};
use serde_json::Value;

use crate::babbling::{Babble, Column, babble};
use crate::error::AgentError;
use crate::grasp::policy::{self as grasping, GraspPolicy, RandomActions};
use crate::grasp::{self, GraspNetwork};
use crate::learner::Learner;
use crate::network::{Network, Recall};
use crate::policy::{Policy, Random};
use crate::reach::ReachNetwork;
use crate::reach::policy::{self as reaching, ReachPolicy};
use crate::rule::RuleOfOnesOwn;
use crate::tensors;

/// Names of the agents that need no learning.
pub const REFERENCES: [&str; 3] = ["random", "scripted", "oracle"];

/// An agent that needs no learning, by name. The random one goes on with the choices of `random`.
///
/// # Errors
/// [`AgentError::Config`] for an unknown name, or a task or control in which it cannot act.
pub fn reference<'a>(
    name: &str,
    task: &Arc<dyn AnyTask>,
    random: &'a Random,
) -> Result<Box<dyn Policy + 'a>, AgentError> {
    if !REFERENCES.contains(&name) {
        return Err(AgentError::Config {
            field: "agent",
            problem: format!("{name:?} is not one of {}", REFERENCES.join(", ")),
        });
    }
    if let Some(task) = downcast::<ReachTask>(task) {
        return match name {
            "random" => boxed(ReachPolicy::new(task, random)),
            "scripted" => boxed(ReachPolicy::new(task, reaching::Scripted)),
            _ => boxed(ReachPolicy::new(task, reaching::Oracle)),
        };
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    match name {
        "random" => Ok(Box::new(RandomActions::new(task, random))),
        "scripted" => boxed(GraspPolicy::new(task, grasping::Scripted)),
        _ => boxed(GraspPolicy::new(task, grasp::Oracle)),
    }
}

fn boxed<'a>(
    policy: Result<impl Policy + 'a, AgentError>,
) -> Result<Box<dyn Policy + 'a>, AgentError> {
    policy.map(|policy| Box::new(policy) as _)
}

fn other_task() -> AgentError {
    AgentError::Config {
        field: "env",
        problem: "this agent was made for another task".to_owned(),
    }
}

/// A network of any task that learns by babbling. Implemented for every [`Learner`].
#[expect(
    clippy::missing_errors_doc,
    reason = "as the methods of Learner and Network"
)]
pub trait AnyLearner: Any + fmt::Debug + Send + Sync {
    /// Name of its task in the registry.
    fn task(&self) -> &'static str;

    /// Numbers of maps and rule, as JSON.
    fn brain(&self) -> Result<Value, AgentError>;

    /// Seed of its babbling.
    fn seed(&self) -> u64;

    /// How its babbles are simulated, as JSON.
    fn options(&self) -> Result<Value, AgentError>;

    /// Babbles made.
    fn babbled(&self) -> u64;

    /// How many of them were learnt from.
    fn learnt(&self) -> u64;

    /// As [`Learner::learn`].
    fn learn(
        &mut self,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError>;

    /// As [`Learner::learn_by`].
    fn learn_by(
        &mut self,
        rule: &mut RuleOfOnesOwn<'_>,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError>;

    /// Names of the associations' tensors, and the associations.
    fn associations(&self) -> Vec<(&'static str, &Association)>;

    /// As [`Network::set`].
    fn set(
        &mut self,
        association: usize,
        weights: &[f32],
        a_mean: &[f32],
        g_mean: &[f32],
    ) -> Result<(), AgentError>;

    /// As [`Network::input_shapes`].
    fn input_shapes(&self) -> Vec<Vec<usize>>;

    /// As [`Network::recall_maps`].
    fn recall(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError>;

    /// As [`Network::decide_from`].
    fn decide(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError>;

    /// As [`Network::policy`].
    fn policy(&self, task: &Arc<dyn AnyTask>) -> Result<Box<dyn Policy + '_>, AgentError>;

    /// As [`Learner::save`].
    fn save(&self, config: Config) -> Result<Vec<u8>, AgentError>;
}

impl<N: Network> AnyLearner for Learner<N> {
    fn task(&self) -> &'static str {
        N::TASK
    }

    fn brain(&self) -> Result<Value, AgentError> {
        serde_json::to_value(self.network.config()).map_err(|e| tensors::file(&e))
    }

    fn seed(&self) -> u64 {
        self.babbling.seed()
    }

    fn options(&self) -> Result<Value, AgentError> {
        serde_json::to_value(self.babbling.options()).map_err(|e| tensors::file(&e))
    }

    fn babbled(&self) -> u64 {
        self.babbling.babbled()
    }

    fn learnt(&self) -> u64 {
        self.babbling.learnt()
    }

    fn learn(
        &mut self,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Self::learn(self, &task, n, executor)
    }

    fn learn_by(
        &mut self,
        rule: &mut RuleOfOnesOwn<'_>,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Self::learn_by(self, rule, &task, n, executor)
    }

    fn associations(&self) -> Vec<(&'static str, &Association)> {
        let names = N::PREFIXES.iter().copied();
        names.zip(self.network.associations()).collect()
    }

    fn set(
        &mut self,
        association: usize,
        weights: &[f32],
        a_mean: &[f32],
        g_mean: &[f32],
    ) -> Result<(), AgentError> {
        self.network.set(association, weights, a_mean, g_mean)
    }

    fn input_shapes(&self) -> Vec<Vec<usize>> {
        self.network.input_shapes()
    }

    fn recall(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError> {
        self.network.recall_maps(senses)
    }

    fn decide(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError> {
        self.network.decide_from(senses)
    }

    fn policy(&self, task: &Arc<dyn AnyTask>) -> Result<Box<dyn Policy + '_>, AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        self.network.policy(task)
    }

    fn save(&self, config: Config) -> Result<Vec<u8>, AgentError> {
        Self::save(self, config)
    }
}

/// A learner for a task of the registry, by its name; `brain` are numbers of maps and rule, `options`
/// say how it babbles, both as JSON.
///
/// # Errors
/// [`AgentError::Config`] naming the task or the number.
pub fn learner(
    task: &str,
    brain: Value,
    seed: u64,
    options: Value,
) -> Result<Box<dyn AnyLearner>, AgentError> {
    match task {
        ReachNetwork::TASK => made::<ReachNetwork>(brain, seed, options),
        GraspNetwork::TASK => made::<GraspNetwork>(brain, seed, options),
        _ => Err(no_learner(task)),
    }
}

/// The numbers of maps and rule of a variant, as JSON.
///
/// # Errors
/// [`AgentError::Config`] naming the task or the variant.
pub fn brain_of(task: &str, variant: &str) -> Result<Value, AgentError> {
    let json = |e: serde_json::Error| tensors::file(&e);
    match task {
        ReachNetwork::TASK => serde_json::to_value(ReachNetwork::variant(variant)?).map_err(json),
        GraspNetwork::TASK => serde_json::to_value(GraspNetwork::variant(variant)?).map_err(json),
        _ => Err(no_learner(task)),
    }
}

fn no_learner(task: &str) -> AgentError {
    AgentError::Config {
        field: "env",
        problem: format!("no agent babbles in the task {task:?}"),
    }
}

fn made<N: Network>(
    brain: Value,
    seed: u64,
    options: Value,
) -> Result<Box<dyn AnyLearner>, AgentError> {
    let brain = serde_json::from_value(brain).map_err(|error| AgentError::Config {
        field: "brain",
        problem: error.to_string(),
    })?;
    let options = options_of::<N::Task>(options)?;
    Ok(Box::new(Learner::<N>::new(brain, seed, options)?))
}

/// How to babble, from JSON; null stands for the defaults.
fn options_of<T: Babble>(options: Value) -> Result<T::Options, AgentError> {
    if options.is_null() {
        return Ok(T::Options::default());
    }
    serde_json::from_value(options).map_err(|error| AgentError::Config {
        field: "babbling",
        problem: error.to_string(),
    })
}

/// The learner in a file's bytes, of whichever task, and the config of its task.
///
/// # Errors
/// As [`Learner::load`].
pub fn load(bytes: &[u8]) -> Result<(Box<dyn AnyLearner>, Config), AgentError> {
    let keys = tensors::keys(bytes)?;
    if keys.iter().any(|key| key == ReachNetwork::KEY) {
        let (learner, config) = Learner::<ReachNetwork>::load(bytes)?;
        return Ok((Box::new(learner), config));
    }
    if keys.iter().any(|key| key == GraspNetwork::KEY) {
        let (learner, config) = Learner::<GraspNetwork>::load(bytes)?;
        return Ok((Box::new(learner), config));
    }
    Err(AgentError::File {
        problem: "a safetensors file, but without an agent of gym_babble in its metadata"
            .to_owned(),
    })
}

/// What babbles of any task left behind, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiences {
    /// What was seen, and done, and what the case was.
    pub columns: Vec<Column>,
    /// Which babbles can be learnt from.
    pub learnable: Vec<bool>,
    /// How each ended.
    pub outcomes: Vec<Outcome>,
}

/// The first `n` babbles of a seed in a task of any kind, as [`babble`](crate::babble).
///
/// # Errors
/// [`AgentError::Config`] for a task without babbles or options that it does not have; an error of the
/// task or the executor.
pub fn babble_any(
    task: &Arc<dyn AnyTask>,
    n: usize,
    seed: u64,
    options: Value,
    executor: &mut Executor,
) -> Result<Experiences, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        return columns(&*task, n, seed, options, executor);
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    columns(&*task, n, seed, options, executor)
}

/// Control steps that a babble takes in a task of any kind.
///
/// # Errors
/// [`AgentError::Config`] for a task without babbles.
pub fn babble_steps(task: &Arc<dyn AnyTask>) -> Result<usize, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        return Ok(task.babble_steps());
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    Ok(task.babble_steps())
}

fn columns<T: Babble + Task>(
    task: &T,
    n: usize,
    seed: u64,
    options: Value,
    executor: &mut Executor,
) -> Result<Experiences, AgentError> {
    let options = options_of::<T>(options)?;
    let all = babble(task, n, seed, options, executor)?;
    Ok(Experiences {
        columns: T::columns(&all),
        learnable: all.iter().map(T::is_learnable).collect(),
        outcomes: all.iter().map(T::outcome).collect(),
    })
}
