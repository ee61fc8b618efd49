//! Numbers of the chain: how it babbles, its maps and rule, and how it acts.

use babble_brain::OutstarRule;
use serde::{Deserialize, Serialize};

use crate::error::AgentError;
use crate::rule::Rule;

/// The variant's name, by which its numbers are told from those of the paper's agent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChainName {
    /// The only one.
    #[default]
    Chain,
}

/// How the palm is taken off the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Withdrawal {
    /// The elbow extends.
    Elbow,
    /// Both joints turn, in a random direction.
    Free,
}

/// How a babble runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sequence {
    /// Whether the hand opens before the arm withdraws; true. Otherwise it takes the object along.
    pub opening: bool,
    /// How the palm is taken off the object; by the elbow.
    pub withdrawal: Withdrawal,
    /// Most that the shoulder is off when the arm comes back \[deg\]; 12. Objects then meet the palm in
    /// various places, and babbles that end in a hold teach the good ones.
    pub jitter_deg: f64,
}

impl Default for Sequence {
    fn default() -> Self {
        Self {
            opening: true,
            withdrawal: Withdrawal::Elbow,
            jitter_deg: 12.0,
        }
    }
}

/// Numbers of the chain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChainBrain {
    /// The variant: `chain`.
    pub variant: ChainName,
    /// The learning rule; the outstar.
    pub rule: Rule,
    /// Neurons along each side of the eye's map; 31.
    pub eye_neurons: usize,
    /// Units for the object's size, with each of which the eye's map is paired; 3. 1 for the eye alone.
    pub sizes: usize,
    /// Neurons along each side of the maps of arm and hand; 21. Those of the arm extend two neurons
    /// beyond each joint limit.
    pub neurons: usize,
    /// Width σ of the tuning curves in spacings of neurons (Eq. 3); 0.7.
    pub sigma: f64,
    /// How a babble runs.
    pub babble: Sequence,
    /// How much further than recalled the hand closes \[deg\], up to the reflex's flexion; 20.
    pub squeeze_deg: f64,
    /// Whether a touch of the palm stops the arm and closes the hand; true. Otherwise the hand closes at
    /// the end of the advance.
    pub reflex: bool,
    /// Whether the arm advances until the palm touches; true. Otherwise the hand closes where contact is
    /// recalled.
    pub advance: bool,
    /// Whether the arm's postures are recalled; true. Otherwise they are random ones of its ranges.
    pub targets: bool,
}

impl Default for ChainBrain {
    fn default() -> Self {
        Self {
            variant: ChainName::Chain,
            rule: Rule::Outstar(OutstarRule::default()),
            eye_neurons: 31,
            sizes: 3,
            neurons: 21,
            sigma: 0.7,
            babble: Sequence::default(),
            squeeze_deg: 20.0,
            reflex: true,
            advance: true,
            targets: true,
        }
    }
}

impl ChainBrain {
    /// Checks every number.
    ///
    /// # Errors
    /// [`AgentError::Config`] names the number, its value and its bounds.
    pub fn validate(&self) -> Result<(), AgentError> {
        let whole = |x: usize| x as f64;
        for (field, value, low, high) in [
            ("eye_neurons", whole(self.eye_neurons), 2.0, 101.0),
            ("sizes", whole(self.sizes), 1.0, 21.0),
            ("neurons", whole(self.neurons), 6.0, 101.0),
            ("squeeze_deg", self.squeeze_deg, 0.0, 90.0),
            ("babble.jitter_deg", self.babble.jitter_deg, 0.0, 90.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(AgentError::Config {
                    field,
                    problem: format!("{value} is not in [{low}, {high}]"),
                });
            }
        }
        Ok(self.rule.validate()?)
    }
}
