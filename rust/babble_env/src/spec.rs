//! The one description of observations and actions. Spaces in Python, tables in the docs and every
//! other face are made from it.

use std::borrow::Cow;

use serde::Serialize;

/// A named group of numbers in an observation or an action.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Name of the group.
    pub name: &'static str,
    /// What each number is.
    pub labels: Vec<&'static str>,
    /// Lower bounds.
    pub low: Vec<f64>,
    /// Upper bounds.
    pub high: Vec<f64>,
    /// Unit of the numbers; for an action, what ±1 stands for.
    pub unit: Cow<'static, str>,
    /// What the group tells.
    pub description: &'static str,
}

/// A named group of numbers that an episode shows in its info.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measure {
    /// Name of the group.
    pub name: &'static str,
    /// What each number is.
    pub labels: &'static [&'static str],
    /// Unit of the numbers.
    pub unit: &'static str,
    /// What the group tells, and the frame of a position.
    pub description: &'static str,
}

/// Everything a face needs to build an environment's spaces and docs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spec {
    /// The senses, in the order of the flat observation: that of their names, as Gymnasium flattens
    /// a Dict.
    pub senses: Vec<Entry>,
    /// The two goals of the goal form; none where a task has no such form.
    pub goals: Vec<Entry>,
    /// The action.
    pub action: Entry,
    /// Names of the reward terms, in their order; at most [`crate::task::MAX_TERMS`].
    pub reward_terms: &'static [&'static str],
    /// Least and greatest reward of one step.
    pub reward_bounds: [f64; 2],
    /// Names of what is true or false of an episode, in their order; at most
    /// [`crate::task::MAX_FACTS`].
    pub facts: &'static [&'static str],
    /// Numbers that the info of an episode shows, in their order; together at most
    /// [`crate::task::MAX_MEASURES`].
    pub measures: &'static [Measure],
    /// Names of the outcomes that an episode can have.
    pub outcomes: Vec<&'static str>,
    /// Time limit in control steps.
    pub max_episode_steps: u32,
    /// Control periods a second.
    pub control_hz: f64,
}

impl Spec {
    /// Numbers in all measures.
    #[must_use]
    pub fn measures_len(&self) -> usize {
        self.measures.iter().map(|one| one.labels.len()).sum()
    }

    /// Numbers in a goal; 0 without goals.
    #[must_use]
    pub fn goal_len(&self) -> usize {
        self.goals.first().map_or(0, |goal| goal.labels.len())
    }
}
