//! The command line.

use std::net::IpAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::limits::{Limits, seconds};
use crate::openenv::Served;
use crate::token;

/// The environments of gym-babble over a network.
#[derive(Debug, Clone, Parser)]
#[command(name = "gym-babble-server", version)]
pub struct Cli {
    /// What to do in place of serving.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// How to serve.
    #[command(flatten)]
    pub options: Options,
}

/// What the program does beside serving.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Print the binary protocol as JSON schemas.
    Protocol,
    /// Print the openenv.yaml of the environment that OpenEnv's clients get.
    OpenenvYaml,
    /// Ask a running server at this host and port whether it can be used; exit code 0 if so.
    Health,
}

/// How to serve.
#[derive(Debug, Clone, Args)]
pub struct Options {
    /// Address to listen on. Any but a loopback address needs an access token.
    #[arg(long, default_value = "127.0.0.1")]
    pub host: IpAddr,
    /// Port to listen on; 0 for any free one.
    #[arg(long, default_value_t = 8741)]
    pub port: u16,
    /// File with the access token, in place of the environment variable `GYM_BABBLE_TOKEN`.
    #[arg(long)]
    pub token_file: Option<PathBuf>,
    /// Origin of pages that may connect, as in `https://example.org`; may be repeated.
    #[arg(long, value_parser = token::origin)]
    pub allow_origin: Vec<String>,
    /// How long running requests may take to end when the server is stopped.
    #[arg(long = "drain-seconds", default_value = "30", value_parser = seconds)]
    pub drain_time: Duration,
    /// Form of the log on stderr.
    #[arg(long, value_enum, default_value_t = LogFormat::Text)]
    pub log: LogFormat,
    /// What clients may ask for.
    #[command(flatten)]
    pub limits: Limits,
    /// What OpenEnv's clients get.
    #[command(flatten)]
    pub served: Served,
}

/// Form of the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// A line of text for each event.
    Text,
    /// A JSON object for each event.
    Json,
}
