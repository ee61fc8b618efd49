//! Messages on OpenEnv's WebSocket.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::fault::{Fault, Kind};
use crate::wire::CaseMap;

/// Kinds of messages that clients send.
const TYPES: [&str; 5] = ["reset", "step", "state", "close", "mcp"];
/// Letters of an episode's id.
const MOST_LETTERS: usize = 255;

/// A message of a client.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Request {
    /// Begin an episode.
    Reset(Reset),
    /// One step.
    Step(Vec<f32>),
    /// Tell the state.
    State,
    /// End the session.
    Close,
    /// A JSON-RPC request.
    Mcp(Value),
}

/// What a reset may say.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Reset {
    /// Seed of Gymnasium's `reset`.
    pub(super) seed: Option<u64>,
    /// Name of the episode.
    pub(super) episode_id: Option<String>,
    /// Id of another environment.
    pub(super) env: Option<String>,
    /// Options of the environment.
    pub(super) options: Option<Map<String, Value>>,
    /// Profile, or what differs from one.
    pub(super) config: Option<Value>,
    /// Parts of the case to play.
    pub(super) scenario: Option<CaseMap>,
}

/// Action of a step.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Action {
    action: Vec<f64>,
    /// Every action of OpenEnv may have some; nothing depends on it.
    #[serde(default, rename = "metadata")]
    _metadata: Map<String, Value>,
}

/// OpenEnv's names of errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Code {
    /// The message is no JSON.
    InvalidJson,
    /// There is no such kind of message.
    UnknownType,
    /// A field is missing, unknown, of a wrong kind or out of bounds.
    ValidationError,
    /// It cannot be done now.
    ExecutionError,
    /// There are as many sessions as this server allows.
    CapacityReached,
    /// The environment cannot be made.
    FactoryError,
    /// The session cannot go on.
    SessionError,
}

/// Why a message was refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Refusal {
    /// Field, value and bound.
    pub message: String,
    /// OpenEnv's name of the error.
    pub code: Code,
    /// What kind of error it is in counters.
    #[serde(skip)]
    pub kind: Kind,
    /// Sessions that there are, if there are too many.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_sessions: Option<usize>,
    /// Sessions that there may be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_sessions: Option<usize>,
}

impl Request {
    /// Its name in counters.
    pub(super) const fn operation(&self) -> &'static str {
        match self {
            Self::Reset(_) => "openenv_reset",
            Self::Step(_) => "openenv_step",
            Self::State => "openenv_state",
            Self::Close => "openenv_close",
            Self::Mcp(_) => "openenv_mcp",
        }
    }
}

impl Refusal {
    /// A refusal with a code.
    #[must_use]
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            code,
            kind: match code {
                Code::InvalidJson | Code::UnknownType | Code::ValidationError => {
                    Kind::ProtocolError
                }
                Code::ExecutionError => Kind::ResetNeeded,
                Code::CapacityReached => Kind::LimitError,
                Code::FactoryError => Kind::ConfigError,
                Code::SessionError => Kind::SessionError,
            },
            active_sessions: None,
            max_sessions: None,
        }
    }

    /// As it is counted.
    pub(super) fn fault(&self) -> Fault {
        Fault::new(self.kind, "")
    }

    /// As a message of the server.
    #[must_use]
    pub fn text(&self) -> String {
        text("error", self)
    }
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        let code = match fault.kind {
            Kind::ConfigError | Kind::ActionError | Kind::ProtocolError => Code::ValidationError,
            Kind::SessionError => Code::SessionError,
            _ => Code::ExecutionError,
        };
        let kind = fault.kind;
        Self {
            kind,
            ..Self::new(code, fault.message)
        }
    }
}

/// A message of the server.
pub(super) fn text(kind: &str, data: &impl Serialize) -> String {
    #[derive(Serialize)]
    struct Message<'a, T> {
        r#type: &'a str,
        data: &'a T,
    }
    let message = Message { r#type: kind, data };
    // Strings, numbers and maps with names as keys can always be written.
    serde_json::to_string(&message).unwrap_or_default()
}

impl Request {
    pub(super) fn read(message: &str) -> Result<Self, Refusal> {
        let invalid = |error| Refusal::new(Code::InvalidJson, format!("Invalid JSON: {error}"));
        let Value::Object(mut envelope) = serde_json::from_str(message).map_err(invalid)? else {
            return Err(refused("a message is an object with type and data"));
        };
        let kind = envelope.remove("type").unwrap_or_default();
        let data = envelope.remove("data");
        let known = TYPES.iter().find(|&&known| kind == known);
        let Some(&known) = known else {
            let message = format!("Unknown message type: {kind}; known: {}", TYPES.join(", "));
            return Err(Refusal::new(Code::UnknownType, message));
        };
        if let Some(other) = envelope.keys().next() {
            return Err(refused(format!("{known}: unknown field {other:?}")));
        }
        match (known, data) {
            ("reset", None) => Ok(Self::Reset(Reset::default())),
            ("reset", Some(data)) => Reset::read(data).map(Self::Reset),
            ("step", Some(data)) => read_action(data).map(Self::Step),
            ("mcp", Some(data)) => Ok(Self::Mcp(data)),
            ("state", None) => Ok(Self::State),
            ("close", None) => Ok(Self::Close),
            (_, None) => Err(refused(format!("{known}: data is missing"))),
            (_, Some(_)) => Err(refused(format!("{known}: has no data"))),
        }
    }
}

impl Reset {
    pub(super) fn read(data: Value) -> Result<Self, Refusal> {
        let reset: Self = read("reset", data)?;
        let letters = reset.episode_id.as_ref().map_or(0, |id| id.chars().count());
        if letters > MOST_LETTERS {
            let message =
                format!("reset: episode_id has {letters} letters, at most {MOST_LETTERS}");
            return Err(refused(message));
        }
        Ok(reset)
    }
}

/// The numbers of an action. One beyond float32 is out of range, as any beyond ±1.
pub(super) fn read_action(data: Value) -> Result<Vec<f32>, Refusal> {
    let Action { action, .. } = read("step", data)?;
    let most = f64::from(f32::MAX);
    Ok(action.iter().map(|x| x.clamp(-most, most) as f32).collect())
}

fn read<T: DeserializeOwned>(kind: &str, data: Value) -> Result<T, Refusal> {
    if !data.is_object() {
        return Err(refused(format!("{kind}: data must be an object")));
    }
    serde_json::from_value(data).map_err(|error| refused(format!("{kind}: {error}")))
}

fn refused(message: impl Into<String>) -> Refusal {
    Refusal::new(Code::ValidationError, message)
}
