//! What a user does.

use std::collections::BTreeMap;
use std::str::FromStr;

use babble_env::CaseValue;
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::setup::Setup;

/// Values of parts of a case by name, as in the registry.
pub type Case = BTreeMap<String, CaseValue>;

/// Most babbles that one command learns from.
const MOST_BABBLES: u64 = 100_000;
/// Most control steps of one command.
const MOST_STEPS: u64 = 1_000_000;
/// Most test cases of one command.
const MOST_CASES: u64 = 10_000;
/// Most letters of an answer.
const MOST_LETTERS: usize = 1_000;

/// A command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Babble until each agent that learns has learnt from n more babbles.
    Babble {
        /// How many, 1 to 100,000.
        n: u64,
    },
    /// Begin an episode of the same case for each agent.
    Recall {
        /// The case; none for the next one of the seed.
        case: Option<Case>,
    },
    /// Control steps of the running episode; fewer if it ends.
    Step {
        /// How many, 1 to 1,000,000.
        n: u64,
    },
    /// Play test cases to their ends, the same ones each time.
    Test {
        /// How many, 1 to 10,000.
        n: u64,
    },
    /// Silence neurons of an agent's map for good.
    Lesion {
        /// Which agent.
        agent: usize,
        /// Which map of the association.
        map: MapName,
        /// Which association.
        association: usize,
        /// Which neurons of the map.
        neurons: Vec<usize>,
    },
    /// Go on with another setup: agents whose part of it stays keep what they have learnt.
    Change {
        /// The setup.
        setup: Setup,
    },
    /// What a student says to a question of a lesson.
    Answer {
        /// Id of the question.
        question: String,
        /// The answer.
        value: Answer,
    },
}

/// One of the two maps of an association.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MapName {
    /// The map that perceives.
    Input,
    /// The map that is recalled.
    Output,
}

impl FromStr for MapName {
    type Err = Fault;

    fn from_str(name: &str) -> Result<Self, Fault> {
        match name {
            "input" => Ok(Self::Input),
            "output" => Ok(Self::Output),
            _ => Err(Fault::config(
                "map",
                format!("{name:?} is not one of input, output"),
            )),
        }
    }
}

/// An answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Answer {
    /// A number.
    Number(f64),
    /// A choice.
    Text(String),
}

impl Command {
    /// A command from JSON.
    ///
    /// # Errors
    /// A [`Fault`] that names the field that is unknown, missing or of another type.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        Fault::reading(text)
    }

    /// Checks numbers that do not depend on what happened before.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        let (n, most) = match self {
            Self::Babble { n } => (*n, MOST_BABBLES),
            Self::Step { n } => (*n, MOST_STEPS),
            Self::Test { n } => (*n, MOST_CASES),
            Self::Answer { question, value } => return check_answer(question, value),
            Self::Change { setup } => return setup.check(),
            Self::Recall { .. } | Self::Lesion { .. } => return Ok(()),
        };
        if (1..=most).contains(&n) {
            return Ok(());
        }
        Err(Fault::config("n", format!("n = {n} is not in [1, {most}]")))
    }

    /// Lengthens this command by another one that goes on with the same; false if it is another thing.
    pub(crate) fn merge(&mut self, next: &Self) -> bool {
        let (n, more, most) = match (self, next) {
            (Self::Babble { n }, Self::Babble { n: more }) => (n, more, MOST_BABBLES),
            (Self::Step { n }, Self::Step { n: more }) => (n, more, MOST_STEPS),
            _ => return false,
        };
        let merges = *n + more <= most;
        if merges {
            *n += more;
        }
        merges
    }
}

fn check_answer(question: &str, value: &Answer) -> Result<(), Fault> {
    let long = |text: &str| text.chars().count() > MOST_LETTERS;
    match value {
        Answer::Text(text) if long(text) => Err(Fault::config(
            "value",
            format!("an answer has at most {MOST_LETTERS} letters"),
        )),
        Answer::Number(number) if !number.is_finite() => {
            Err(Fault::config("value", format!("{number} is not finite")))
        }
        _ if long(question) => Err(Fault::config(
            "question",
            format!("a name has at most {MOST_LETTERS} letters"),
        )),
        _ => Ok(()),
    }
}
