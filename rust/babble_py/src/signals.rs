//! Ctrl-C, and whatever other signal Python has a handler for, during long work in Rust.

use std::cell::Cell;

use babble_env::{EnvError, Executor};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

thread_local! {
    /// What a handler raised in this thread, while the work that it interrupts comes to its end.
    static RAISED: Cell<Option<PyErr>> = const { Cell::new(None) };
}

/// An executor whose long work ends when the handler of a signal raises.
pub(crate) fn executor(threads: usize) -> Result<Executor, EnvError> {
    Ok(Executor::new(threads)?.interrupted_by(handler_raises))
}

/// The exception of work that was interrupted.
pub(crate) fn raised() -> PyErr {
    RAISED
        .take()
        .unwrap_or_else(|| PyKeyboardInterrupt::new_err(()))
}

/// Lets Python handle its signals, which it does in its main thread alone.
fn handler_raises() -> bool {
    Python::attach(|py| match py.check_signals() {
        Ok(()) => false,
        Err(error) => {
            RAISED.set(Some(error));
            true
        }
    })
}
