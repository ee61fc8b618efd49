//! The environment server, as the package brings it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the server's program until it is stopped; returns its exit code.
#[pyfunction]
pub(crate) fn serve(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let name = OsString::from("gym-babble serve");
    let code = py.detach(|| babble_server::run(std::iter::once(name).chain(arguments)));
    // The server was stopped by Ctrl-C, of which Python has heard too.
    drop(py.check_signals());
    code
}

/// The binary protocol, as JSON.
#[pyfunction]
pub(crate) fn server_protocol() -> String {
    babble_server::protocol::json()
}
