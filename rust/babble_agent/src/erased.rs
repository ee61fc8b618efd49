//! Agents of any task behind one object-safe trait each, by name and from files: for faces that choose
//! the task at run time.

use std::any::Any;
use std::fmt;
use std::iter;
use std::sync::Arc;

use babble_brain::Association;
use babble_env::{AnyTask, Config, Executor, GraspTask, Outcome, ReachTask, Task, downcast};
use serde_json::Value;

use crate::babbling::{Babble, Babbling, Column, babble};
use crate::chain::ChainNetwork;
use crate::chain::acting::ChainPolicy;
use crate::error::AgentError;
use crate::grasp::babbling::POSTURES;
use crate::grasp::policy::{self as grasping, GraspPolicy, RandomActions};
use crate::grasp::{self, ElbowApproach, GraspNetwork};
use crate::learner::{BabbleFilm, Learner, Practice};
use crate::network::{Axis, Network, Percept, Recall};
use crate::policy::{Decisions, Policy, Random};
use crate::reach::ReachNetwork;
use crate::reach::policy::{self as reaching, ReachPolicy};
use crate::rule::RuleOfOnesOwn;
use crate::tensors;

/// Names of the agents that need no learning and act in all tasks; "reflex" acts in grasping alone.
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
    if !(REFERENCES.contains(&name) || name == "reflex") {
        return Err(AgentError::Config {
            field: "agent",
            problem: format!("{name:?} is not one of {}", REFERENCES.join(", ")),
        });
    }
    if let Some(task) = downcast::<ReachTask>(task) {
        return match name {
            "random" => boxed(ReachPolicy::new(task, random)),
            "scripted" => boxed(ReachPolicy::new(task, reaching::Scripted)),
            "reflex" => Err(AgentError::Config {
                field: "env",
                problem: "a hand closes by reflex in grasping alone".to_owned(),
            }),
            _ => boxed(ReachPolicy::new(task, reaching::Oracle)),
        };
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    match name {
        "random" => Ok(Box::new(RandomActions::new(task, random))),
        "scripted" => boxed(GraspPolicy::new(task, grasping::Scripted)),
        "reflex" => boxed(GraspPolicy::new(task, random)),
        _ => boxed(GraspPolicy::new(task, grasp::Oracle)),
    }
}

/// The agent that bends the elbow until the palm touches an object, and then closes the hand.
///
/// # Errors
/// [`AgentError::Config`] for a task or control in which it cannot act.
pub fn approach(task: &Arc<dyn AnyTask>) -> Result<Box<dyn Policy>, AgentError> {
    let task = downcast::<GraspTask>(task).ok_or_else(|| AgentError::Config {
        field: "env",
        problem: "there is no palm to touch with but in grasping".to_owned(),
    })?;
    Ok(Box::new(ElbowApproach::new(task)?))
}

/// An agent that acts on decisions which somebody else makes: in reaching, parameters (b1, b2) of a
/// movement; in grasping, shoulder, elbow, and flexions of thumb and finger once the hand closes \[rad\].
///
/// # Errors
/// [`AgentError::Config`] for a task or control in which it cannot act.
pub fn deciding<'a>(
    task: &Arc<dyn AnyTask>,
    decisions: Decisions<'a>,
) -> Result<Box<dyn Policy + 'a>, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        return boxed(ReachPolicy::new(task, decisions));
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    boxed(GraspPolicy::new(task, decisions))
}

/// An agent of grasping that acts by the chain on postures which somebody else chooses: shoulder and elbow
/// before the grasp and at contact, and flexions of thumb and finger once the hand closes \[rad\].
///
/// # Errors
/// As [`deciding`].
pub fn chaining<'a>(
    task: &Arc<dyn AnyTask>,
    decisions: Decisions<'a>,
) -> Result<Box<dyn Policy + 'a>, AgentError> {
    let task = downcast::<GraspTask>(task).ok_or_else(|| AgentError::Config {
        field: "env",
        problem: "the chain acts in grasping alone".to_owned(),
    })?;
    boxed(ChainPolicy::new(task, decisions))
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

    /// As [`Learner::config`].
    fn config(&self) -> &Config;

    /// Numbers of maps and rule, as JSON.
    fn brain(&self) -> Result<Value, AgentError>;

    /// Seed of its babbling.
    fn seed(&self) -> u64;

    /// As [`Learner::shuffled`].
    fn shuffled(&self) -> bool;

    /// As [`Learner::shuffle`].
    fn shuffle(&mut self);

    /// As [`Learner::move_to`].
    ///
    /// # Errors
    /// [`AgentError::Config`] for another task.
    fn move_to(&mut self, task: &Arc<dyn AnyTask>) -> Result<(), AgentError>;

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

    /// As [`Learner::practise`].
    fn practise(
        &mut self,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError>;

    /// As [`Learner::practice`].
    fn practice(&self) -> Practice;

    /// As [`Learner::film`].
    fn film(&self, task: &Arc<dyn AnyTask>, ahead: u64) -> Result<BabbleFilm, AgentError>;

    /// Control steps that a babble takes in a task.
    fn babble_steps(&self, task: &Arc<dyn AnyTask>) -> Result<usize, AgentError>;

    /// Names of the associations' tensors, and the associations.
    fn associations(&self) -> Vec<(&'static str, &Association)>;

    /// As [`Network::set`], for all associations in their order; all or nothing.
    fn set(&mut self, parts: &[[Vec<f32>; 3]]) -> Result<(), AgentError>;

    /// As [`Network::input_shapes`].
    fn input_shapes(&self) -> Vec<Vec<usize>>;

    /// As [`Network::axes`].
    fn axes(&self) -> Vec<[Vec<Axis>; 2]>;

    /// As [`Network::perceive_maps`].
    fn perceive(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError>;

    /// As [`Network::recall_maps`].
    fn recall(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError>;

    /// As [`Network::decide_from`].
    fn decide(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError>;

    /// As [`Network::policy`].
    fn policy(&self, task: &Arc<dyn AnyTask>) -> Result<Box<dyn Policy + '_>, AgentError>;

    /// As [`Learner::save`].
    fn save(&self) -> Result<Vec<u8>, AgentError>;

    /// A copy, which learns on by itself.
    fn copied(&self) -> Box<dyn AnyLearner>;
}

impl<N: Network> AnyLearner for Learner<N> {
    fn task(&self) -> &'static str {
        N::TASK
    }

    fn config(&self) -> &Config {
        Self::config(self)
    }

    fn brain(&self) -> Result<Value, AgentError> {
        serde_json::to_value(self.network.config()).map_err(|e| tensors::file(&e))
    }

    fn seed(&self) -> u64 {
        self.babbling.seed()
    }

    fn shuffled(&self) -> bool {
        Self::shuffled(self)
    }

    fn shuffle(&mut self) {
        Self::shuffle(self);
    }

    fn move_to(&mut self, task: &Arc<dyn AnyTask>) -> Result<(), AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Self::move_to(self, &task);
        Ok(())
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

    fn practise(
        &mut self,
        task: &Arc<dyn AnyTask>,
        n: usize,
        executor: &mut Executor,
    ) -> Result<(), AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Self::practise(self, &task, n, executor)
    }

    fn practice(&self) -> Practice {
        Self::practice(self)
    }

    fn film(&self, task: &Arc<dyn AnyTask>, ahead: u64) -> Result<BabbleFilm, AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Self::film(self, &task, ahead)
    }

    fn babble_steps(&self, task: &Arc<dyn AnyTask>) -> Result<usize, AgentError> {
        let task = downcast::<N::Task>(task).ok_or_else(other_task)?;
        Ok(task.babble_steps(self.babbling.options()))
    }

    fn associations(&self) -> Vec<(&'static str, &Association)> {
        let names = N::PREFIXES.iter().copied();
        names.zip(self.network.associations()).collect()
    }

    fn set(&mut self, parts: &[[Vec<f32>; 3]]) -> Result<(), AgentError> {
        let mut changed = self.network.clone();
        for (i, [weights, a_mean, g_mean]) in parts.iter().enumerate() {
            changed.set(i, weights, a_mean, g_mean)?;
        }
        self.network = changed;
        Ok(())
    }

    fn input_shapes(&self) -> Vec<Vec<usize>> {
        self.network.input_shapes()
    }

    fn axes(&self) -> Vec<[Vec<Axis>; 2]> {
        self.network.axes()
    }

    fn perceive(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError> {
        self.network.perceive_maps(senses)
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

    fn save(&self) -> Result<Vec<u8>, AgentError> {
        Self::save(self)
    }

    fn copied(&self) -> Box<dyn AnyLearner> {
        Box::new(self.clone())
    }
}

/// A learner for a task of any kind; `brain` are numbers of maps and rule, `options` say how it babbles,
/// both as JSON.
///
/// # Errors
/// [`AgentError::Config`] naming the task or the number.
pub fn learner(
    task: &Arc<dyn AnyTask>,
    brain: Value,
    seed: u64,
    options: Value,
) -> Result<Box<dyn AnyLearner>, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        return made::<ReachNetwork>(&task, brain, seed, options);
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    if brain.get("variant").is_some_and(|name| name == "chain") {
        return made::<ChainNetwork>(&task, brain, seed, options);
    }
    made::<GraspNetwork>(&task, brain, seed, options)
}

/// The numbers of maps and rule of a variant, as JSON.
///
/// # Errors
/// [`AgentError::Config`] naming the task or the variant.
pub fn brain_of(task: &str, variant: &str) -> Result<Value, AgentError> {
    let json = |e: serde_json::Error| tensors::file(&e);
    match task {
        ReachNetwork::TASK => serde_json::to_value(ReachNetwork::variant(variant)?).map_err(json),
        ChainNetwork::TASK if variant == "chain" => {
            serde_json::to_value(ChainNetwork::variant(variant)?).map_err(json)
        }
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
    task: &N::Task,
    brain: Value,
    seed: u64,
    options: Value,
) -> Result<Box<dyn AnyLearner>, AgentError> {
    let brain = serde_path_to_error::deserialize(brain).map_err(|error| AgentError::Config {
        field: "brain",
        problem: error.to_string(),
    })?;
    let options = options_of::<N::Task>(options)?;
    Ok(Box::new(Learner::<N>::new(brain, task, seed, options)?))
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

/// The learner in a file's bytes, of whichever task.
///
/// # Errors
/// As [`Learner::load`].
pub fn load(bytes: &[u8]) -> Result<Box<dyn AnyLearner>, AgentError> {
    let keys = tensors::keys(bytes)?;
    if keys.iter().any(|key| key == ReachNetwork::KEY) {
        return Ok(Box::new(Learner::<ReachNetwork>::load(bytes)?));
    }
    if keys.iter().any(|key| key == GraspNetwork::KEY) {
        return Ok(Box::new(Learner::<GraspNetwork>::load(bytes)?));
    }
    if keys.iter().any(|key| key == ChainNetwork::KEY) {
        return Ok(Box::new(Learner::<ChainNetwork>::load(bytes)?));
    }
    Err(AgentError::File {
        problem: "a safetensors file, but without an agent of gym_babble in its metadata"
            .to_owned(),
    })
}

/// What babbles of any task left behind, column by column; several experiences of a babble follow each
/// other.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiences {
    /// What was seen, and done, and what the case was.
    pub columns: Vec<Column>,
    /// Which babble each experience is of.
    pub babbles: Vec<u64>,
    /// Which experiences can be learnt from.
    pub learnable: Vec<bool>,
    /// How the babble of each ended.
    pub outcomes: Vec<Outcome>,
}

/// The first `n` babbles of a seed in a task of any kind, with an experience at the end of each or every
/// `period_s` seconds.
///
/// # Errors
/// [`AgentError::Config`] for a task without babbles, or options or a period that it does not have; an
/// error of the task or the executor.
pub fn babble_any(
    task: &Arc<dyn AnyTask>,
    n: usize,
    seed: u64,
    options: Value,
    period_s: Option<f64>,
    executor: &mut Executor,
) -> Result<Experiences, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        let babbling = Babbling::new(seed, options_of::<ReachTask>(options)?).every(period_s)?;
        return columns(&babbling, &*task, n, executor);
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    let babbling = Babbling::new(seed, options_of::<GraspTask>(options)?).every(period_s)?;
    columns(&babbling, &*task, n, executor)
}

/// The babbles after `babbled` ones of a seed, of which `learnt` could be learnt from, until `n` more can
/// be: what these leave behind, and both counts after them. `options` say how they are simulated, as JSON.
///
/// # Errors
/// As [`babble_any`] and [`Babbling::experience`].
pub fn learnable_any(
    task: &Arc<dyn AnyTask>,
    n: usize,
    seed: u64,
    counts: [u64; 2],
    options: Value,
    period_s: Option<f64>,
    executor: &mut Executor,
) -> Result<(Experiences, [u64; 2]), AgentError> {
    let [babbled, learnt] = counts;
    if let Some(task) = downcast::<ReachTask>(task) {
        let babbling = Babbling::resume(seed, options_of::<ReachTask>(options)?, babbled, learnt);
        return learnable(babbling.every(period_s)?, &*task, n, executor);
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    let babbling = Babbling::resume(seed, options_of::<GraspTask>(options)?, babbled, learnt);
    learnable(babbling.every(period_s)?, &*task, n, executor)
}

fn learnable<T: Babble>(
    mut babbling: Babbling<T>,
    task: &T,
    n: usize,
    executor: &mut Executor,
) -> Result<(Experiences, [u64; 2]), AgentError> {
    let learnt = babbling.learnt();
    let found = babbling.by_babble(task, n, executor)?;
    let counts = [babbling.babbled(), babbling.learnt()];
    Ok((Experiences::of::<T>(learnt, &found), counts))
}

/// Babbles in grasping from number `first` of a seed on, to postures that somebody chooses for each, with
/// an experience at the end of each movement.
///
/// # Errors
/// [`AgentError::Config`] for another task; an error of the task or the executor.
pub fn babble_to(
    task: &Arc<dyn AnyTask>,
    seed: u64,
    first: u64,
    postures: &[[[f64; 2]; POSTURES]],
    executor: &mut Executor,
) -> Result<Experiences, AgentError> {
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    let made = executor.map(0..postures.len(), |i, _| {
        crate::grasp::babbling::babble_to(&task, seed, first + i as u64, &postures[i])
    });
    Ok(Experiences::of::<GraspTask>(
        first,
        &made.map_err(AgentError::Env)?,
    ))
}

/// Control steps that a babble takes in a task of any kind; `options` say how it is simulated, as JSON.
///
/// # Errors
/// [`AgentError::Config`] for a task without babbles, or options that it does not have.
pub fn babble_steps(task: &Arc<dyn AnyTask>, options: Value) -> Result<usize, AgentError> {
    if let Some(task) = downcast::<ReachTask>(task) {
        return Ok(task.babble_steps(options_of::<ReachTask>(options)?));
    }
    let task = downcast::<GraspTask>(task).ok_or_else(other_task)?;
    Ok(task.babble_steps(options_of::<GraspTask>(options)?))
}

fn columns<T: Babble + Task>(
    babbling: &Babbling<T>,
    task: &T,
    n: usize,
    executor: &mut Executor,
) -> Result<Experiences, AgentError> {
    let made = babble(babbling, task, n, executor)?;
    Ok(Experiences::of::<T>(0, &made))
}

impl Experiences {
    /// What babbles left behind, the first of which has the number `first`.
    fn of<T: Babble>(first: u64, made: &[Vec<T::Experience>]) -> Self {
        let babbles = (first..)
            .zip(made)
            .flat_map(|(k, one)| iter::repeat_n(k, one.len()));
        let babbles = babbles.collect();
        let all = made.concat();
        Self {
            babbles,
            columns: T::columns(&all),
            learnable: all.iter().map(T::is_learnable).collect(),
            outcomes: all.iter().map(T::outcome).collect(),
        }
    }
}
