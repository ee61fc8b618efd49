//! What can go wrong in setting up the eye or in using it.

use thiserror::Error;

/// Errors of the eye.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum EyeError {
    /// A field of [`EyeConfig`](super::EyeConfig) is outside of its bound.
    #[error("eye: {field} = {value}, but it must be {bound}")]
    OutOfBound {
        /// Name of the field.
        field: &'static str,
        /// The value found there.
        value: f64,
        /// What it must be, with the unit.
        bound: &'static str,
    },
    /// No red pixel in the image of the start gaze nor of any search gaze.
    #[error("eye: no red pixel seen from the start gaze nor from any of {searched} search gazes")]
    TargetNotSeen {
        /// Number of search gazes tried after the start gaze.
        searched: usize,
    },
    /// A buffer for a picture has the wrong length.
    #[error("eye: buffer of {found} bytes for a picture of height x width x 3 = {expected} bytes")]
    BufferSize {
        /// Its length \[byte\].
        found: usize,
        /// What it must be \[byte\].
        expected: usize,
    },
}
