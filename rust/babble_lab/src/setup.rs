//! What a session begins with: environment, body, seed, agents.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::fault::Fault;

/// Greatest seed: JavaScript's greatest whole number.
const MOST_SEED: u64 = (1 << 53) - 1;
/// Most agents.
pub(crate) const MOST_AGENTS: usize = 2;

/// All that decides what happens, beside the commands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Id of the environment in the registry.
    pub env: String,
    /// Options of the environment that differ from its defaults.
    pub options: Map<String, Value>,
    /// Profile of the config.
    pub profile: String,
    /// Fields of the config that differ from the profile, nested as in config files.
    pub config: Map<String, Value>,
    /// Seed of babbling, cases and choices.
    pub seed: u64,
    /// The agents: one, or two side by side.
    pub agents: Vec<AgentSetup>,
}

/// An agent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum AgentSetup {
    /// Learns by babbling.
    Hebb {
        /// Its variant.
        variant: String,
        /// Numbers of maps and rule that differ from the variant's.
        brain: Map<String, Value>,
        /// Expression for Δw; none for the rule of the brain.
        rule: Option<String>,
    },
    /// Chooses at random.
    Random {},
    /// Follows a fixed strategy.
    Scripted {},
    /// Knows the simulation.
    Oracle {},
    /// In grasping, bends the elbow until the palm touches, and closes the hand.
    Approach {},
    /// A network that was trained elsewhere and given to the lab by name.
    Policy {
        /// Its name.
        name: String,
    },
}

impl AgentSetup {
    /// A learner of a variant as it is.
    #[must_use]
    pub fn hebb(variant: &str) -> Self {
        Self::Hebb {
            variant: variant.to_owned(),
            brain: Map::new(),
            rule: None,
        }
    }

    /// Whether it learns.
    #[must_use]
    pub const fn learns(&self) -> bool {
        matches!(self, Self::Hebb { .. })
    }
}

impl Setup {
    /// A setup from JSON.
    ///
    /// # Errors
    /// A [`Fault`] that names the field that is unknown, missing or of another type.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        Fault::reading(text)
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        let agents = self.agents.len();
        if !(1..=MOST_AGENTS).contains(&agents) {
            let problem = format!("{agents} agents: there are 1 to {MOST_AGENTS}");
            return Err(Fault::config("agents", problem));
        }
        if self.seed > MOST_SEED {
            let problem = format!("seed = {} is more than {MOST_SEED}", self.seed);
            return Err(Fault::config("seed", problem));
        }
        Ok(())
    }
}
