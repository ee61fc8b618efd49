//! The binary protocol, version 1: the WebSocket subprotocol `gym-babble.v1`.
//!
//! Each binary message is one MessagePack array of three: a client sends `[id, operation, body]`, and
//! the server answers each request, in their order, with `[id, "ok", body]` or `[id, "error", fault]`.
//! Bodies are maps with the fields below; a field that may be nil may also be left out. Arrays of numbers
//! are MessagePack binaries: little-endian, row after row, without a header, as their shape follows from
//! the reply to `make`.
//!
//! A connection begins with `make` or `resume`, whose id is 0; after an error it may try again. The
//! requests that follow have ids that grow by one from 1 in a session, also after an error. A request
//! whose id was the last one to be executed is not executed again: it gets the same reply. So a client
//! that lost its connection resumes its session and sends the request again of which it saw no reply. Any
//! other id is an error, and so is a message whose id cannot be read, which is answered with nil in place
//! of the id; neither counts. After `close` the server ends the connection with code 1000.

use std::collections::BTreeMap;

use babble_env::{Autoreset, CaseValue, Document};
use bytemuck::{AnyBitPattern, NoUninit};
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

/// Name of the WebSocket subprotocol.
pub const SUBPROTOCOL: &str = "gym-babble.v1";

/// Numbers as raw little-endian bytes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Raw<T>(pub Vec<T>);

/// float32 numbers.
pub type F32s = Raw<f32>;
/// float64 numbers.
pub type F64s = Raw<f64>;
/// Bytes: truth values (0 or 1), codes, pixels or a state.
pub type Bytes = Raw<u8>;
/// uint32 numbers.
pub type U32s = Raw<u32>;

// Bytes are copied as they are: big-endian processors would need a swap.
const _: () = assert!(cfg!(target_endian = "little"));

impl<T: NoUninit> Serialize for Raw<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(bytemuck::cast_slice(&self.0))
    }
}

impl<'de, T: AnyBitPattern + NoUninit> Deserialize<'de> for Raw<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bits<T>(std::marker::PhantomData<T>);

        impl<T: AnyBitPattern + NoUninit> Visitor<'_> for Bits<T> {
            type Value = Raw<T>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "a binary of whole numbers of {} bytes", size_of::<T>())
            }

            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Raw<T>, E> {
                if !bytes.len().is_multiple_of(size_of::<T>()) {
                    return Err(E::invalid_length(bytes.len(), &self));
                }
                Ok(Raw(bytemuck::pod_collect_to_vec(bytes)))
            }
        }

        deserializer.deserialize_bytes(Bits(std::marker::PhantomData))
    }
}

macro_rules! raw_schema {
    ($($number:ty: $name:literal),*) => {$(
        impl JsonSchema for Raw<$number> {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                concat!("raw ", $name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({"type": concat!("raw ", $name)})
            }
        }
    )*};
}
raw_schema!(f32: "float32", f64: "float64", u8: "bytes", u32: "uint32");

/// Parts of a case by name: what `case` shows, and what `reset` asks.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CaseMap(pub BTreeMap<String, CaseValue>);

impl JsonSchema for CaseMap {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "case".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({"type": "map of a name to nil, bool, a number or a list of numbers"})
    }
}

/// Body of `make`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Make {
    /// Id of the environments, as in `BabbleReach-v0`.
    pub env: String,
    /// How many, called n below; 1 by default.
    #[serde(default = "one")]
    pub num_envs: usize,
    /// When an ended episode begins anew: `NextStep` (the default), `SameStep` or `Disabled`, as in
    /// Gymnasium.
    #[serde(default = "next_step")]
    pub autoreset: String,
    /// Name of a profile, or a map of what differs from one; the paper's if nil.
    #[serde(default, deserialize_with = "value")]
    pub config: Value,
    /// Options of the environment by name.
    #[serde(default, deserialize_with = "map")]
    pub options: Map<String, Value>,
    /// Threads that step them; as many as pay off if nil. Results do not depend on it.
    #[serde(default)]
    pub threads: Option<usize>,
}

fn value<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Value, D::Error> {
    Document::deserialize(deserializer).map(|Document(value)| value)
}

fn map<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map<String, Value>, D::Error> {
    match value(deserializer)? {
        Value::Object(map) => Ok(map),
        Value::Null => Ok(Map::new()),
        other => Err(D::Error::custom(format!("{other}: expected a map"))),
    }
}

const fn one() -> usize {
    1
}

fn next_step() -> String {
    Autoreset::NextStep.to_string()
}

/// Body of `resume`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Resume {
    /// The key from the reply to `make`.
    pub key: String,
}

/// Reply to `make` and `resume`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Made {
    /// Name of the session in the server's log and pages. It opens nothing.
    pub session: String,
    /// Key with which the session is resumed. Keep it secret.
    pub key: String,
    /// How long the session outlives its connection \[s\].
    pub resume_s: f64,
    /// Id of the request that was executed last.
    pub last: u64,
    /// The server's version.
    pub version: String,
    /// Id of the environments.
    pub env: String,
    /// Name of their task.
    pub task: String,
    /// How many there are.
    pub num_envs: usize,
    /// When an ended episode begins anew.
    pub autoreset: String,
    /// Threads that step them.
    pub threads: usize,
    /// The complete config.
    pub config: Value,
    /// All options by name.
    pub options: Value,
    /// Senses, goals, action, reward terms, facts, measures, outcomes, time limit.
    pub spec: Value,
    /// Numbers that agents need, in SI units, by name.
    pub quantities: Value,
    /// What the server allows: `message_bytes`, `picture_pixels`.
    pub limits: BTreeMap<&'static str, u64>,
}

/// Body of `reset`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reset {
    /// Which environments to reset (n); all if nil.
    #[serde(default)]
    pub mask: Option<Bytes>,
    /// A seed or nil for each environment (n), those of `gymnasium.Env.reset`: the same cases in
    /// every language. Only the masked ones are seeded; in the first reset all are.
    #[serde(default)]
    pub seeds: Option<Vec<Option<u64>>>,
    /// Parts that the cases of each environment (n) must have from now on; an empty map for none, nil
    /// for those of before.
    #[serde(default)]
    pub cases: Option<Vec<Option<CaseMap>>>,
}

/// Body of `step`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Actions (n, k).
    pub actions: F32s,
}

/// What m environments show, m = n if not said otherwise.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct Shown {
    /// Flat observations (m, s).
    pub senses: F32s,
    /// Goals (m, g); empty without goals.
    pub achieved: F32s,
    /// Goals (m, g); empty without goals.
    pub desired: F32s,
    /// The eye's images (m, size, size, 3); empty if the observation has none.
    pub retina: Bytes,
    /// Rewards (m).
    pub reward: F64s,
    /// Whether the episode ended by itself (m).
    pub terminated: Bytes,
    /// Whether it was cut off at the time limit (m).
    pub truncated: Bytes,
    /// The outcome's place in the spec's `outcomes` (m).
    pub outcome: Bytes,
    /// Truth values in the order of the spec's `facts` (m, f).
    pub facts: Bytes,
    /// Numbers in the order of the spec's `reward_terms` (m, t).
    pub terms: F64s,
    /// Numbers in the order of the spec's `measures` (m, x).
    pub measures: F64s,
}

/// Reply to `reset` and `step`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct Stepped {
    /// What all environments show (m = n). Where an episode began anew, reward, terms and ends are those
    /// of the step, and all else is of the new episode.
    pub now: Shown,
    /// Environments whose episodes ended and that began anew within the step (m).
    pub ended: U32s,
    /// What their ended episodes showed last (m); nil if there are none.
    pub last: Option<Shown>,
}

/// Body of `save`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Save {
    /// Which environments; all if nil.
    #[serde(default)]
    pub envs: Option<Vec<usize>>,
    /// Whether to save the episode that ended within the last step in place of the new one.
    #[serde(default)]
    pub ended: bool,
}

/// Reply to `save`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Saved {
    /// A state each; nil for an episode that did not end.
    pub states: Vec<Option<Bytes>>,
}

/// Body of `load`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// A state or nil for each environment (n); nil leaves it as it is.
    pub states: Vec<Option<Bytes>>,
}

/// Body of `hash`, `case`, `trail` and `moments`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Of {
    /// Which environment.
    pub env: usize,
}

/// Reply to `hash`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Hash {
    /// A number that two states share only if they are the same to the bit.
    pub hash: u64,
}

/// Reply to `case`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Case {
    /// Parts of the running episode's case by name.
    pub case: CaseMap,
}

/// Reply to `trail`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Trail {
    /// The recorded path of the hand (k, 2) \[m\].
    pub trail: F64s,
}

/// Reply to `moments`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Moments {
    /// How many moments were recorded since the reset.
    pub moments: usize,
}

/// Body of `render`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Render {
    /// Which environment.
    pub env: usize,
    /// `third_person`, `eye`, `fovea` or `edges`.
    pub camera: String,
    /// Width \[pixel\].
    pub width: u32,
    /// Height \[pixel\].
    pub height: u32,
    /// A recorded moment; now if nil.
    #[serde(default)]
    pub moment: Option<usize>,
    /// A state to draw in place of that of the environment.
    #[serde(default)]
    pub state: Option<Bytes>,
    /// Whether to send a PNG file in place of raw pixels.
    #[serde(default)]
    pub png: bool,
}

/// Reply to `render`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Picture {
    /// Pixels (height, width, 3), or a PNG file.
    #[serde(with = "serde_bytes")]
    #[schemars(schema_with = "bytes_schema")]
    pub image: Vec<u8>,
}

fn bytes_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
    Bytes::json_schema(generator)
}

/// Body of `goal_reward`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalReward {
    /// Achieved goals (m, g).
    pub achieved: F32s,
    /// Desired goals (m, g).
    pub desired: F32s,
}

/// Reply to `goal_reward`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GoalRewards {
    /// Rewards (m).
    pub reward: F64s,
}

/// Body of `scenarios`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenarios {
    /// Name of the protocol, as in `table1`.
    pub protocol: String,
    /// How many cases, where they are drawn.
    pub n: usize,
    /// Seed of the draw.
    #[serde(default)]
    pub seed: u64,
    /// `test` if nil; `validation` or `learning` for cases that are not reported on.
    #[serde(default)]
    pub split: Option<String>,
}

/// Reply to `scenarios`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Cases {
    /// Cases to `reset` to; nil at places of a fixed list that have none.
    pub cases: Vec<Option<CaseMap>>,
}

/// An empty map.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Nothing {}
