//! What the networks of all tasks share: associations, learnt from experiences.

use std::fmt;
use std::sync::Arc;

use babble_brain::Association;
use babble_env::Executor;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::babbling::Babble;
use crate::error::AgentError;
use crate::policy::Policy;
use crate::rule::{Rule, RuleOfOnesOwn};

/// Activities of the two maps that an association connects, for m experiences in a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Activities {
    /// Activities g of the input map, m · `n_in`.
    pub g: Vec<f32>,
    /// Activities a of the output map, m · `n_out`.
    pub a: Vec<f32>,
}

/// Activity of an input map for senses.
#[derive(Debug, Clone, PartialEq)]
pub struct Percept {
    /// What the map stands for.
    pub name: &'static str,
    /// Activities of the neurons, the last axis fastest.
    pub activity: Vec<f32>,
}

/// Activity of an output map that senses call up.
#[derive(Debug, Clone, PartialEq)]
pub struct Recall {
    /// What the map stands for.
    pub name: &'static str,
    /// Activities of the neurons, the first axis fastest.
    pub activity: Vec<f32>,
    /// Neurons along each of the two axes.
    pub side: usize,
}

/// What the neurons along an axis of a map stand for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Axis {
    /// The quantity.
    pub name: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// What the first and the last neuron prefer.
    pub range: [f64; 2],
}

impl Axis {
    /// An axis.
    #[must_use]
    pub const fn new(name: &'static str, unit: &'static str, range: [f64; 2]) -> Self {
        Self { name, unit, range }
    }

    /// Two joint angles or turns of the eye, as shares of their ranges.
    pub(crate) const fn shares(names: [&'static str; 2]) -> [Self; 2] {
        let [first, second] = names;
        let share = "share of range";
        [
            Self::new(first, share, [0.0, 1.0]),
            Self::new(second, share, [0.0, 1.0]),
        ]
    }

    /// Opening angles of finger and thumb.
    pub(crate) const fn hand() -> [Self; 2] {
        [
            Self::new("opening of the finger", "deg", [0.0, 90.0]),
            Self::new("opening of the thumb", "deg", [0.0, 90.0]),
        ]
    }
}

/// How babbles of a network's task are simulated.
pub type OptionsOf<N> = <<N as Network>::Task as Babble>::Options;

/// Maps and the associations between them, which learn what a task's babbling experiences.
pub trait Network: Clone + Send + Sync + fmt::Debug + 'static {
    /// The task whose experiences it learns from.
    type Task: Babble;
    /// Numbers of maps and rule.
    type Config: Clone + PartialEq + fmt::Debug + Serialize + DeserializeOwned;

    /// Name of the task in the registry.
    const TASK: &'static str;
    /// What a file of such a network is called in its header.
    const KEY: &'static str;
    /// What the names of each association's tensors begin with, in the order of the associations.
    const PREFIXES: &'static [&'static str];

    /// The numbers of a variant.
    ///
    /// # Errors
    /// [`AgentError::Config`] for an unknown name.
    fn variant(name: &str) -> Result<Self::Config, AgentError>;

    /// A network that has learnt nothing.
    ///
    /// # Errors
    /// [`AgentError`] naming the number that is out of bounds.
    fn new(config: Self::Config) -> Result<Self, AgentError>;

    /// Numbers of maps and rule.
    fn config(&self) -> &Self::Config;

    /// The rule it learns by.
    fn rule(&self) -> &Rule;

    /// Time between two applications of the rule while a babble moves \[s\]; None for one, at its end.
    fn learning_period_s(&self) -> Option<f64> {
        None
    }

    /// How it babbles, if so is asked for: a network may babble in one way alone.
    fn babbling(&self, asked: OptionsOf<Self>) -> OptionsOf<Self> {
        asked
    }

    /// The associations, in the order of their prefixes.
    fn associations(&self) -> Vec<&Association>;

    /// The associations, to be changed.
    fn associations_mut(&mut self) -> Vec<&mut Association>;

    /// Activities of the maps for experiences, one entry for each association.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are no activities.
    fn encode(
        &self,
        experiences: &[<Self::Task as Babble>::Experience],
    ) -> Result<Vec<Activities>, AgentError>;

    /// Neurons along the axes of the input map of each association, the last axis fastest.
    fn input_shapes(&self) -> Vec<Vec<usize>>;

    /// What the axes of the input map and of the output map stand for, one entry for each association that
    /// has maps to show; the last axis is fastest.
    fn axes(&self) -> Vec<[Vec<Axis>; 2]>;

    /// Activities of the input maps for a flat observation, one entry for each association.
    ///
    /// # Errors
    /// [`AgentError`] for senses of another length.
    fn perceive_maps(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError>;

    /// Activities of the output maps for a flat observation.
    ///
    /// # Errors
    /// [`AgentError`] for senses of another length, or percepts that are no activities.
    fn recall_maps(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError>;

    /// What the activities of the output maps are read out as, for a flat observation.
    ///
    /// # Errors
    /// As [`recall_maps`](Self::recall_maps).
    fn decide_from(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError>;

    /// An agent that acts by this network.
    ///
    /// # Errors
    /// [`AgentError::Config`] for a control in which it cannot act.
    fn policy(&self, task: Arc<Self::Task>) -> Result<Box<dyn Policy + '_>, AgentError>;

    /// Learns from experiences in their order. Runs in the rayon pool it is called in.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are no activities; [`AgentError::Config`] for a rule of
    /// the user's own, which [`learn_by`](Self::learn_by) takes.
    fn learn(
        &mut self,
        experiences: &[<Self::Task as Babble>::Experience],
    ) -> Result<(), AgentError> {
        let rule = *self.rule();
        let activities = self.encode(experiences)?;
        for (association, Activities { g, a }) in
            self.associations_mut().into_iter().zip(&activities)
        {
            rule.learn(association, g, a)?;
        }
        Ok(())
    }

    /// Learns likewise, by a rule of the user's own.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are no activities, or whatever the rule returns; the
    /// network is then as it was.
    fn learn_by(
        &mut self,
        rule: &mut RuleOfOnesOwn<'_>,
        experiences: &[<Self::Task as Babble>::Experience],
    ) -> Result<(), AgentError> {
        let mut learning = self.clone();
        let activities = learning.encode(experiences)?;
        for (association, Activities { g, a }) in
            learning.associations_mut().into_iter().zip(&activities)
        {
            rule(association, g, a)?;
        }
        *self = learning;
        Ok(())
    }

    /// Tries what it has learnt, and learns from the reward: a round of trials from number `first` of a
    /// seed on. Returns the control steps that these took.
    ///
    /// # Errors
    /// [`AgentError::Config`] for a network that learns from babbles alone; an error of the task or the
    /// executor.
    fn practise(
        &mut self,
        _task: &Self::Task,
        _seed: u64,
        _first: u64,
        _executor: &mut Executor,
    ) -> Result<u64, AgentError> {
        Err(AgentError::Config {
            field: "practise",
            problem: "this agent learns from babbles alone".to_owned(),
        })
    }

    /// Sets the weights (row-major) and the running averages of one association.
    ///
    /// # Errors
    /// [`AgentError`] for numbers that do not fit it, or weights beyond the rule's bound; nothing is
    /// set then.
    fn set(
        &mut self,
        association: usize,
        weights: &[f32],
        a_mean: &[f32],
        g_mean: &[f32],
    ) -> Result<(), AgentError> {
        let rule = *self.rule();
        rule.check_weights(weights)?;
        let mut all = self.associations_mut();
        let association = &mut *all[association];
        let mut changed = association.clone();
        changed.set_weights(weights)?;
        rule.set_means(&mut changed, a_mean, g_mean)?;
        *association = changed;
        Ok(())
    }
}
