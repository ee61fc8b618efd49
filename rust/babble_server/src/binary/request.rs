//! Requests from bytes.

use rmp::decode;
use rmp_serde::Deserializer;
use schemars::{Schema, SchemaGenerator};
use serde::de::DeserializeOwned;

use crate::fault::{Fault, Kind};
use crate::wire::{
    Case, Cases, GoalReward, GoalRewards, Hash, Load, Made, Make, Moments, Nothing, Of, Picture,
    Render, Reset, Resume, Save, Saved, Scenarios, Step, Stepped, Trail,
};

/// Maps and arrays within one another.
const DEPTH: usize = 32;

macro_rules! operations {
    ($($name:literal: $variant:ident($body:ty) -> $reply:ty, $does:literal;)*) => {
        /// A request of a client.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "OPERATIONS describes them")]
        pub enum Request {
            $($variant($body)),*
        }

        /// All operations.
        pub const OPERATIONS: &[Operation] = &[$(Operation {
            name: $name,
            does: $does,
            request: SchemaGenerator::subschema_for::<$body>,
            reply: SchemaGenerator::subschema_for::<$reply>,
        }),*];

        impl Request {
            /// Name of the operation.
            #[must_use]
            pub const fn operation(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $name),*
                }
            }

            fn read(operation: &str, body: &[u8]) -> Result<Self, Fault> {
                match operation {
                    $($name => Ok(Self::$variant(read($name, body)?)),)*
                    _ => {
                        let known: Vec<_> = OPERATIONS.iter().map(|known| known.name).collect();
                        let known = known.join(", ");
                        Err(protocol(format!("operation {operation:?} is unknown; known: {known}")))
                    }
                }
            }
        }
    };
}

/// What a client can ask.
#[derive(Debug, Clone, Copy)]
pub struct Operation {
    /// Its name.
    pub name: &'static str,
    /// What it does.
    pub does: &'static str,
    /// Schema of the request's body.
    pub request: fn(&mut SchemaGenerator) -> Schema,
    /// Schema of the reply's body.
    pub reply: fn(&mut SchemaGenerator) -> Schema,
}

operations! {
    "make": Make(Make) -> Made, "begins a session with a batch of environments";
    "resume": Resume(Resume) -> Made,
        "takes up a session whose connection broke, or is still held by a client that is gone";
    "reset": Reset(Reset) -> Stepped, "begins new episodes";
    "step": Step(Step) -> Stepped, "steps all environments once";
    "save": Save(Save) -> Saved, "gives states, from which `load` continues bit for bit";
    "load": Load(Load) -> Nothing,
        "continues environments from states: all of them or, after an error, none";
    "hash": Hash(Of) -> Hash, "gives a hash of the state of an environment";
    "case": Case(Of) -> Case, "gives the case of the running episode of an environment";
    "trail": Trail(Of) -> Trail, "gives the recorded path of the hand of an environment";
    "moments": Moments(Of) -> Moments, "counts the recorded moments of an environment";
    "render": Render(Render) -> Picture, "draws an environment";
    "goal_reward": GoalReward(GoalReward) -> GoalRewards,
        "computes rewards of the goal form, for hindsight replay";
    "scenarios": Scenarios(Scenarios) -> Cases, "gives the test cases of a protocol";
    "close": Close(Nothing) -> Nothing, "ends the session";
}

/// A message of a client.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Id of the request; none if it cannot be read.
    pub id: Option<u64>,
    /// What is asked.
    pub request: Result<Request, Fault>,
}

impl Envelope {
    /// Reads a binary message.
    #[must_use]
    pub fn read(mut bytes: &[u8]) -> Self {
        let header = || protocol("a message is an array of three: id, operation, body");
        let id = match decode::read_array_len(&mut bytes) {
            Ok(3) => decode::read_int::<u64, _>(&mut bytes).ok(),
            _ => None,
        };
        let Some(id) = id else {
            return Self {
                id,
                request: Err(header()),
            };
        };
        let request = match decode::read_str_from_slice(bytes) {
            Ok((operation, body)) => Request::read(operation, body),
            Err(_) => Err(header()),
        };
        Self {
            id: Some(id),
            request,
        }
    }
}

fn read<T: DeserializeOwned>(operation: &str, body: &[u8]) -> Result<T, Fault> {
    let refused = |problem: String| protocol(format!("{operation}: {problem}"));
    if !body.first().is_some_and(|&first| is_map(first)) {
        return Err(refused("the body must be a map".to_owned()));
    }
    let mut deserializer = Deserializer::new(body);
    deserializer.set_max_depth(DEPTH);
    let read = T::deserialize(&mut deserializer).map_err(|error| refused(error.to_string()))?;
    match deserializer.get_ref().len() {
        0 => Ok(read),
        more => Err(refused(format!("{more} bytes follow the message"))),
    }
}

/// Whether a value that begins with this byte is a map.
const fn is_map(first: u8) -> bool {
    matches!(first, 0x80..=0x8f | 0xde | 0xdf)
}

fn protocol(message: impl Into<String>) -> Fault {
    Fault::new(Kind::ProtocolError, message)
}
