//! What is wrong, for people and for the field that they can mend.

use babble_agent::AgentError;
use babble_body::BodyError;
use babble_brain::BrainError;
use babble_env::EnvError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{problem}")]
pub struct Fault {
    /// Name of the exception in Python: `ConfigError`, `ScenarioError` ...
    pub kind: String,
    /// What the user can mend, if it is one thing.
    pub field: Option<String>,
    /// A sentence for people, with value and bound.
    pub problem: String,
}

impl Fault {
    /// A fault of a kind.
    pub fn new(kind: &str, field: Option<&str>, problem: impl Into<String>) -> Self {
        Self {
            kind: kind.to_owned(),
            field: field.map(str::to_owned),
            problem: problem.into(),
        }
    }

    /// A wrong value of a setup or a command.
    pub fn config(field: &str, problem: impl Into<String>) -> Self {
        Self::new("ConfigError", Some(field), problem)
    }

    /// A file that is no record.
    pub fn record(field: &str, problem: impl Into<String>) -> Self {
        Self::new("RecordError", Some(field), problem)
    }

    /// A value from JSON, or what is wrong with it and where.
    ///
    /// # Errors
    /// A fault that names the line and the column.
    pub fn reading<T: DeserializeOwned>(text: &str) -> Result<T, Self> {
        // By way of a value, as all else is read that comes as JSON: code for one source is enough.
        let value: Value = serde_json::from_str(text)?;
        serde_json::from_value(value).map_err(|error| Self::config("document", error.to_string()))
    }
}

impl From<EnvError> for Fault {
    fn from(error: EnvError) -> Self {
        let problem = error.to_string();
        let (kind, field) = match &error {
            EnvError::Config { field, .. } => ("ConfigError", Some(field.clone())),
            EnvError::Option { option, .. }
            | EnvError::OptionKind { option, .. }
            | EnvError::OutOfBounds { option, .. }
            | EnvError::Fixed { option, .. } => ("ConfigError", Some((*option).to_owned())),
            EnvError::Body(BodyError::OutOfBounds { field, .. }) => {
                ("ConfigError", Some(format!("body.{field}")))
            }
            EnvError::UnknownName { kind, .. } => ("ConfigError", Some((*kind).to_owned())),
            EnvError::CaseValue { part, .. } => ("ScenarioError", Some((*part).to_owned())),
            EnvError::Case { what, .. } => ("ScenarioError", Some((*what).to_owned())),
            EnvError::NoLegalCase { .. } | EnvError::NoGraspCase { .. } => ("ScenarioError", None),
            EnvError::ActionNotFinite { .. } | EnvError::ActionShape { .. } => {
                ("ActionError", None)
            }
            EnvError::Snapshot { .. } => ("SnapshotError", None),
            EnvError::Interrupted => ("Interrupted", None),
            _ => ("ConfigError", None),
        };
        Self {
            kind: kind.to_owned(),
            field,
            problem,
        }
    }
}

impl From<BrainError> for Fault {
    fn from(error: BrainError) -> Self {
        Self::new("ConfigError", None, error.to_string())
    }
}

impl From<AgentError> for Fault {
    fn from(error: AgentError) -> Self {
        let problem = error.to_string();
        match error {
            AgentError::Env(error) => error.into(),
            AgentError::Brain(error) => error.into(),
            AgentError::Config { field, .. } => Self::config(field, problem),
            AgentError::OtherConfig { field, .. } => Self::config(&field, problem),
            AgentError::File { .. } => Self::new("AgentFileError", None, problem),
            AgentError::NothingToLearn { .. } => Self::new("ScenarioError", None, problem),
            AgentError::Rule { .. } => Self::config("rule", problem),
            _ => Self::new("ConfigError", None, problem),
        }
    }
}

impl From<serde_json::Error> for Fault {
    fn from(error: serde_json::Error) -> Self {
        Self::new("ConfigError", None, error.to_string())
    }
}
