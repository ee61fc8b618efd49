//! What a client is told when a request cannot be done.

use babble_env::EnvError;
use schemars::JsonSchema;
use serde::Serialize;

/// Kind of an error, by the name of its class in Python.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub enum Kind {
    /// An option or a field of the config is unknown, of a wrong kind or out of bounds.
    ConfigError,
    /// An action is not finite, or of a wrong shape. Nothing was stepped.
    ActionError,
    /// A case that was asked for cannot be played, or none could be drawn.
    ScenarioError,
    /// Bytes are not a state of this environment, which is as it was.
    SnapshotError,
    /// A step outside of an episode. Nothing was stepped.
    ResetNeeded,
    /// The message is not one of the protocol.
    ProtocolError,
    /// There is no such session, or it cannot be had.
    SessionError,
    /// The request is beyond what this server allows.
    LimitError,
    /// The server has a fault.
    ServerError,
}

impl Kind {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ConfigError => "ConfigError",
            Self::ActionError => "ActionError",
            Self::ScenarioError => "ScenarioError",
            Self::SnapshotError => "SnapshotError",
            Self::ResetNeeded => "ResetNeeded",
            Self::ProtocolError => "ProtocolError",
            Self::SessionError => "SessionError",
            Self::LimitError => "LimitError",
            Self::ServerError => "ServerError",
        }
    }
}

/// An error as a client gets it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, thiserror::Error)]
#[error("{message}")]
pub struct Fault {
    /// What kind of error it is.
    pub kind: Kind,
    /// Field, value and bound.
    pub message: String,
}

impl Fault {
    /// An error of a kind.
    #[must_use]
    pub fn new(kind: Kind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
        }
    }

    /// A value beyond a limit of the server.
    #[must_use]
    pub fn limit(what: &str, value: impl std::fmt::Display, most: impl std::fmt::Display) -> Self {
        let message = format!("{what} = {value}: this server allows at most {most}");
        Self::new(Kind::LimitError, message)
    }
}

impl From<EnvError> for Fault {
    fn from(error: EnvError) -> Self {
        let kind = match error {
            EnvError::ActionNotFinite { .. } | EnvError::ActionShape { .. } => Kind::ActionError,
            EnvError::NeedsReset { .. } => Kind::ResetNeeded,
            EnvError::Case { .. }
            | EnvError::CaseValue { .. }
            | EnvError::NoLegalCase { .. }
            | EnvError::NoGraspCase { .. } => Kind::ScenarioError,
            EnvError::Snapshot { .. } => Kind::SnapshotError,
            EnvError::Interrupted => Kind::LimitError,
            EnvError::Threads { .. } => Kind::ServerError,
            _ => Kind::ConfigError,
        };
        let message = match &error {
            EnvError::Interrupted => {
                "the request took longer than this server allows; all environments need a reset"
                    .to_owned()
            }
            other => other.to_string(),
        };
        Self { kind, message }
    }
}
