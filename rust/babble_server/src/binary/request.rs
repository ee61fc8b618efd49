//! Requests from bytes.

use rmp::decode;
use rmp_serde::Deserializer;
use serde::de::DeserializeOwned;

use crate::fault::{Fault, Kind};
use crate::wire::{
    GoalReward, Load, Make, Nothing, Of, Render, Reset, Resume, Save, Scenarios, Step,
};

/// Maps and arrays within one another.
const DEPTH: usize = 32;

macro_rules! requests {
    ($($(#[$doc:meta])* $name:literal: $variant:ident($body:ty)),* $(,)?) => {
        /// A request of a client.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "the operations of wire")]
        pub enum Request {
            $($variant($body)),*
        }

        /// Names of the operations.
        pub const OPERATIONS: &[&str] = &[$($name),*];

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
                    _ => Err(protocol(format!(
                        "operation {operation:?} is unknown; known: {}",
                        OPERATIONS.join(", "),
                    ))),
                }
            }
        }
    };
}

requests! {
    "make": Make(Make),
    "resume": Resume(Resume),
    "reset": Reset(Reset),
    "step": Step(Step),
    "save": Save(Save),
    "load": Load(Load),
    "hash": Hash(Of),
    "case": Case(Of),
    "trail": Trail(Of),
    "moments": Moments(Of),
    "render": Render(Render),
    "goal_reward": GoalReward(GoalReward),
    "scenarios": Scenarios(Scenarios),
    "close": Close(Nothing),
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
