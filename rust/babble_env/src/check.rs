//! Checks of states that somebody else wrote.

use crate::error::EnvError;
use crate::progress::Phase;

/// Numbers of a state are rounded: how far beyond a bound they may be.
pub(crate) const MARGIN: f64 = 1e-9;

/// `Ok` when `holds`, else a refusal that says what is wrong.
pub(crate) fn ensure(holds: bool, problem: impl FnOnce() -> String) -> Result<(), EnvError> {
    if holds {
        return Ok(());
    }
    Err(EnvError::Snapshot { problem: problem() })
}

/// `Ok` when each value is inside `[low, high]`, which NaN never is.
pub(crate) fn within<'a>(
    what: &str,
    values: impl IntoIterator<Item = &'a f64>,
    [low, high]: [f64; 2],
) -> Result<(), EnvError> {
    let range = low - MARGIN..=high + MARGIN;
    match values.into_iter().find(|value| !range.contains(value)) {
        None => Ok(()),
        Some(value) => ensure(false, || {
            format!("{what} = {value} is not in [{low}, {high}]")
        }),
    }
}

/// `Ok` when an episode in a phase can be so many steps old.
pub(crate) fn age(phase: Phase, steps: u32, most: u32) -> Result<(), EnvError> {
    let last = if phase == Phase::Running {
        most - 1
    } else {
        most
    };
    ensure(steps <= last, || {
        format!("{steps} steps, and the time limit is {most}")
    })
}

/// What refuses a state because of something that other errors name too.
pub(crate) fn refused(error: &impl ToString) -> EnvError {
    EnvError::Snapshot {
        problem: error.to_string(),
    }
}
