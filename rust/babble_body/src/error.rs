//! What can be wrong with a body or its world.

use babble_eye::EyeError;

/// What can be wrong with a body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// A number of the config is outside of its bounds.
    #[error("{field} = {value} is out of bounds: {bound}")]
    OutOfBounds {
        /// Path of the field, as in `arm.upper_arm_m`.
        field: String,
        /// The value given.
        value: f64,
        /// What it must be.
        bound: String,
    },
    /// A joint of that name does not exist.
    #[error("joints.{name}: no such joint; the 26 joints are {known}")]
    UnknownJoint {
        /// The name given.
        name: String,
        /// All names there are.
        known: String,
    },
    /// A joint that this model cannot move or must move.
    #[error("joints.{name}.locked_deg: {problem}")]
    Lock {
        /// Name of the joint.
        name: String,
        /// What is wrong with its lock.
        problem: String,
    },
    /// The parts do not fit together.
    #[error("impossible geometry: {problem}")]
    Geometry {
        /// What does not fit, with the numbers.
        problem: String,
    },
    /// A world that came from outside is not one that this robot can be in.
    #[error("world: {problem}")]
    World {
        /// What is wrong with it.
        problem: String,
    },
    /// The eye's config or its reflex failed.
    #[error(transparent)]
    Eye(#[from] EyeError),
}

impl BodyError {
    /// A world with this problem.
    pub(crate) fn world(problem: &str) -> Self {
        Self::World {
            problem: problem.to_owned(),
        }
    }
}

/// `Ok` when `value` is finite and inside `[low, high]`.
pub(crate) fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), BodyError> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    Err(BodyError::OutOfBounds {
        field: field.to_owned(),
        value,
        bound: format!("finite and in [{low}, {high}]"),
    })
}
