//! Ctrl-C, and whatever other signal Python has a handler for, during long work in Rust.

use std::cell::Cell;
use std::time::{Duration, Instant};

use babble_env::{EnvError, Executor};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

thread_local! {
    /// What a handler raised in this thread, while the work that it interrupts comes to its end.
    static RAISED: Cell<Option<PyErr>> = const { Cell::new(None) };
    /// Until when work of this thread may go on, if there is a limit.
    static DEADLINE: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// An executor whose long work ends when the handler of a signal raises.
pub(crate) fn executor(threads: usize) -> Result<Executor, EnvError> {
    Ok(Executor::new(threads)?.interrupted_by(handler_raises))
}

/// What `work` returns with such an executor, whose long work also ends some seconds from now, and whether it
/// was ended for that.
pub(crate) fn within<T>(
    seconds: f64,
    threads: usize,
    work: impl FnOnce(Executor) -> T,
) -> Result<(T, bool), EnvError> {
    let executor = Executor::new(threads)?.interrupted_by(handler_raises_or_late);
    let limit = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    DEADLINE.set(Instant::now().checked_add(limit));
    let done = work(executor);
    let late = is_late();
    DEADLINE.set(None);
    Ok((done, late))
}

fn is_late() -> bool {
    DEADLINE
        .get()
        .is_some_and(|deadline| Instant::now() >= deadline)
}

fn handler_raises_or_late() -> bool {
    handler_raises() || is_late()
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
