//! The choices that all tasks have.

use crate::choice::named_enum;
use crate::error::EnvError;

named_enum!(
    /// What an action means.
    Control, "control",
    /// A change of the muscles' equilibrium points.
    DeltaPosture = "delta_posture",
    /// The muscles' equilibrium points themselves.
    Posture = "posture",
    /// Joint torques on top of the muscles' damping.
    Torque = "torque",
    /// Parameters (b1, b2) of one whole movement, the paper's action.
    Pattern = "pattern"
);

named_enum!(
    /// What is rewarded.
    Reward, "reward",
    /// Progress towards the target, +1 for success, −1 for a failure.
    Progress = "progress",
    /// 1 for success, else 0.
    Sparse = "sparse"
);

/// Checks a time limit in control steps.
pub(crate) fn check_max_episode_steps(steps: u32) -> Result<(), EnvError> {
    if (1..=1_000_000).contains(&steps) {
        return Ok(());
    }
    Err(EnvError::OutOfBounds {
        option: "max_episode_steps",
        value: steps.to_string(),
        bound: "in [1, 1000000]".to_owned(),
    })
}
