#![doc = include_str!("../README.md")]

use std::ffi::OsString;
use std::io::{self, Write};
use std::time::Duration;

use clap::Parser;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::filter::LevelFilter;

use crate::options::{Cli, Command, LogFormat, Options};
use crate::serve::Listening;

pub mod admission;
mod app;
pub mod binary;
pub mod connection;
pub mod fault;
mod gate;
mod health;
pub mod limits;
pub mod metrics;
pub mod openenv;
pub mod options;
mod page;
pub mod protocol;
pub mod serve;
pub mod server;
pub mod session;
pub mod table;
pub mod token;
pub mod wire;

/// Runs the program with its arguments, the first of which is its name; returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            let _ = error.print();
            return error.exit_code() as u8;
        }
    };
    let done = match cli.command {
        Some(Command::Protocol) => print(&protocol::json()),
        Some(Command::OpenenvYaml) => openenv::manifest(&cli.options.served)
            .map_err(io::Error::other)
            .and_then(|manifest| print(&manifest)),
        Some(Command::Health) => health::ask(&cli.options),
        None => start(cli.options),
    };
    match done {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            1
        }
    }
}

fn print(document: &str) -> io::Result<()> {
    writeln!(io::stdout(), "{}", document.trim_end())
}

fn start(options: Options) -> io::Result<()> {
    log(options.log);
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .max_blocking_threads(options.limits.sessions.max(1))
        .enable_all()
        .build()?;
    let served = runtime.block_on(async {
        let stop = serve::asked_to_stop()?;
        let listening = Listening::bind(options).await?;
        println!("listening on {}", listening.address()?);
        listening.serve(stop).await;
        Ok(())
    });
    // A request that still runs had its time.
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
