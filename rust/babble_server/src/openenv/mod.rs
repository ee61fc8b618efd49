//! OpenEnv's protocol: JSON over HTTP, and over the WebSocket `/ws` without a subprotocol.
//!
//! It is that of OpenEnv 0.10.0 (`openenv` on PyPI): its client plays here as it does on its own
//! server. An episode lives on a WebSocket. Over HTTP each request has an environment of its own, as
//! in OpenEnv's server.

mod http;
mod manifest;
mod mcp;
mod message;
mod observation;
mod openapi;
mod player;
mod schema;
mod socket;

use babble_env::{Autoreset, EnvError, registry};
use clap::{Args, ValueEnum};
use serde_json::{Map, Value};

pub(crate) use http::routes;
pub use manifest::manifest;
pub use message::{Code, Refusal};
pub use player::{Player, Reply};
pub(crate) use socket::play;

use crate::wire::Make;

/// What OpenEnv's clients get.
#[derive(Debug, Clone, PartialEq, Args)]
#[command(next_help_heading = "OpenEnv")]
pub struct Served {
    /// Id of the environment that OpenEnv's clients get if their reset names no other.
    #[arg(long, default_value = "BabbleReach-v0", value_parser = known_env)]
    pub env: String,
    /// Option of this environment, as in `control=posture`; may be repeated.
    #[arg(long = "option", value_name = "NAME=VALUE", value_parser = named_value)]
    pub options: Vec<(String, Value)>,
    /// Whether `/reset`, `/step` and `/state` are there; they are not in production.
    #[arg(long, value_enum, env = "OPENENV_MODE", ignore_case = true, default_value_t = Mode::Simulation)]
    pub openenv_mode: Mode,
}

/// OpenEnv's modes of a server.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// All routes.
    Simulation,
    /// Without `/reset`, `/step` and `/state`.
    Production,
}

impl Served {
    /// What a reset makes that names no environment.
    #[must_use]
    pub fn make(&self) -> Make {
        self.make_of(None, None, None)
    }

    /// What a reset makes. Of the environment of this server, unspecified options are those that it
    /// was started with.
    fn make_of(
        &self,
        env: Option<String>,
        options: Option<Map<String, Value>>,
        config: Option<Value>,
    ) -> Make {
        let env = env.unwrap_or_else(|| self.env.clone());
        let options = match options {
            Some(options) => options,
            None if env == self.env => self.options.iter().cloned().collect(),
            None => Map::new(),
        };
        Make {
            options,
            config: config.unwrap_or(Value::Null),
            env,
            num_envs: 1,
            autoreset: Autoreset::Disabled.to_string(),
            threads: Some(1),
        }
    }
}

fn known_env(id: &str) -> Result<String, EnvError> {
    registry::environment(id).map(|_| id.to_owned())
}

/// A value is JSON, or else a name.
fn named_value(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
    Ok((name.to_owned(), value))
}
