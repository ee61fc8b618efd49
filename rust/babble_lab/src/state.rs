//! How things stand after a command.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::command::Case;
use crate::setup::Setup;

/// Counts by outcome.
pub type Outcomes = BTreeMap<String, u64>;

/// How things stand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// The setup now.
    pub setup: Setup,
    /// Each agent.
    pub agents: Vec<AgentState>,
    /// The episode on the stage; none before the first one.
    pub episode: Option<EpisodeState>,
    /// The tests so far.
    pub curve: Vec<CurvePoint>,
    /// Length of the record.
    pub commands: usize,
    /// How many times undo can take something back.
    pub undoable: usize,
    /// A number that two sessions share only if all that commands changed is the same to the bit; 16
    /// hexadecimal digits.
    pub hash: String,
}

/// How an agent stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AgentState {
    /// Whether it learns.
    pub learns: bool,
    /// Babbles made.
    pub babbled: u64,
    /// How many of them were learnt from.
    pub learnt: u64,
    /// In reaching, how many were `legal` and `illegal`; in grasping, in how many the object was `kept`
    /// and `lost`.
    pub babble_outcomes: Outcomes,
    /// Neurons without weights.
    pub silenced: usize,
    /// How its episodes on the stage ended.
    pub recalls: Outcomes,
}

/// The episode on the stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EpisodeState {
    /// Its case.
    pub case: Case,
    /// Control steps of the agent that has made most.
    pub step: u64,
    /// The same in simulated time \[s\].
    pub seconds: f64,
    /// How far from the wrist the ball meets the palm when the elbow alone bends \[m\]; none in reaching, or
    /// if it does not meet it.
    pub palm: Option<f64>,
    /// Whether each agent's episode goes on.
    pub running: Vec<bool>,
    /// How each agent's episode stands.
    pub outcome: Vec<String>,
    /// The return of each agent so far.
    pub reward: Vec<f64>,
}

/// A test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CurvePoint {
    /// Babbles that each agent had learnt from.
    pub learnt: Vec<u64>,
    /// Test cases.
    pub cases: u64,
    /// In how many of them each agent succeeded.
    pub successes: Vec<u64>,
    /// How the cases of each agent ended.
    pub outcomes: Vec<Outcomes>,
}
