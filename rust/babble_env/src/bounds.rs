//! Bounds of a config's numbers.

use crate::error::EnvError;

/// `Ok` when `value` is finite and inside `[low, high]`.
pub(crate) fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), EnvError> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    Err(EnvError::Config {
        field: field.to_owned(),
        problem: format!("{value} is out of bounds: finite and in [{low}, {high}]"),
    })
}
