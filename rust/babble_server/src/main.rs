//! The environment server.

use std::process::ExitCode;

fn main() -> ExitCode {
    babble_server::run(std::env::args_os()).into()
}
