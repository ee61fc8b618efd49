//! What the brain refuses, and why.

use std::borrow::Cow;

use thiserror::Error;

/// A number or a length that the brain cannot work with.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BrainError {
    /// A parameter lies outside of its range.
    #[error("{field} = {value} is out of range: {bound}")]
    OutOfRange {
        /// Name of the parameter.
        field: Cow<'static, str>,
        /// The value given.
        value: f64,
        /// The range in words, for instance "0 < eta <= 1".
        bound: &'static str,
    },
    /// A slice has the wrong number of elements.
    #[error("{field} has {actual} elements, expected {expected}")]
    Length {
        /// Name of the slice.
        field: &'static str,
        /// Number of elements the maps ask for.
        expected: usize,
        /// Number of elements given.
        actual: usize,
    },
    /// An activity, or an average of activities, is no number in \[0, 1\].
    #[error("{field}[{index}] = {value} is no activity: 0 <= activity <= 1")]
    Activity {
        /// Name of the slice.
        field: &'static str,
        /// Where in the slice the first such value stands.
        index: usize,
        /// The value given.
        value: f32,
    },
    /// A connection weight is infinite or no number.
    #[error("{field}[{index}] = {value} is not finite")]
    NotFinite {
        /// Name of the slice.
        field: &'static str,
        /// Where in the row-major matrix the first such weight stands.
        index: usize,
        /// The value given.
        value: f32,
    },
}

/// `Ok` if `valid`, otherwise [`BrainError::OutOfRange`].
pub(crate) fn check_range(
    valid: bool,
    field: impl Into<Cow<'static, str>>,
    value: f64,
    bound: &'static str,
) -> Result<(), BrainError> {
    if valid {
        Ok(())
    } else {
        Err(BrainError::OutOfRange {
            field: field.into(),
            value,
            bound,
        })
    }
}

/// `Ok` if `actual == expected`, otherwise [`BrainError::Length`].
pub(crate) fn check_length(
    field: &'static str,
    expected: usize,
    actual: usize,
) -> Result<(), BrainError> {
    if actual == expected {
        Ok(())
    } else {
        Err(BrainError::Length {
            field,
            expected,
            actual,
        })
    }
}

/// `Ok` if every value is in \[0, 1\].
///
/// # Errors
/// [`BrainError::Activity`] for the first other one.
pub fn check_activity(field: &'static str, values: &[f32]) -> Result<(), BrainError> {
    match values.iter().position(|v| !(0.0..=1.0).contains(v)) {
        None => Ok(()),
        Some(index) => Err(BrainError::Activity {
            field,
            index,
            value: values[index],
        }),
    }
}

/// `Ok` if every value is finite, otherwise [`BrainError::NotFinite`] for the first other one.
pub(crate) fn check_finite(field: &'static str, values: &[f32]) -> Result<(), BrainError> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(index) => Err(BrainError::NotFinite {
            field,
            index,
            value: values[index],
        }),
    }
}
