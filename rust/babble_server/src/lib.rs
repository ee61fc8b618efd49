#![doc = include_str!("../README.md")]

use std::ffi::OsString;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::filter::LevelFilter;

use crate::options::{Cli, LogFormat};

pub mod admission;
mod app;
pub mod binary;
pub mod connection;
mod document;
pub mod fault;
pub mod gate;
pub mod limits;
pub mod metrics;
pub mod options;
mod page;
mod serve;
pub mod server;
pub mod session;
pub mod table;
pub mod wire;

/// Runs the program with its arguments, the first of which is its name.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    log(cli.options.log);
    match start(cli.options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn start(options: options::Options) -> std::io::Result<()> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .max_blocking_threads(options.limits.sessions.max(1))
        .enable_all()
        .build()?;
    let served = runtime.block_on(serve::serve(options));
    runtime.shutdown_timeout(Duration::ZERO);
    served
}

/// Logs to stderr, what `RUST_LOG` asks for.
fn log(format: LogFormat) {
    let filter = EnvFilter::builder()
        .with_default_directive(LevelFilter::INFO.into())
        .from_env_lossy();
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr);
    // A program that has a log of its own keeps it.
    let _ = match format {
        LogFormat::Text => log.with_ansi(false).try_init(),
        LogFormat::Json => log.json().try_init(),
    };
}
