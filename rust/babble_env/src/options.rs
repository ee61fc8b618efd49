//! The choices that all tasks have.

use crate::error::EnvError;
use crate::named_enum::named_enum;
use crate::option_spec::{OptionDefault, OptionSpec};
use crate::picture::View;

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

/// Greatest time limit in control steps.
pub(crate) const MOST_STEPS: u32 = 1_000_000;

/// What an observation consists of.
pub(crate) const OBS: OptionSpec = OptionSpec::choice(
    "obs",
    &["senses", "flat", "goal", "retina"],
    "senses",
    "Observation: named senses, the same in one flat array, with goals, or with the eye's image.",
);

/// What is rewarded.
pub(crate) const REWARD: OptionSpec = OptionSpec::choice(
    "reward",
    &[Reward::Progress.name(), Reward::Sparse.name()],
    Reward::Progress.name(),
    "Reward: progress towards the target, or success alone; \"sparse\" with obs=\"goal\".",
);

/// Whether moments are recorded.
pub(crate) const RECORD: OptionSpec = OptionSpec::flag(
    "record",
    "Record each control step, for the trajectory and pictures of a whole episode.",
);

/// Where pictures are taken from.
pub(crate) const CAMERA: OptionSpec = OptionSpec::choice(
    "camera",
    &[
        View::ThirdPerson.name(),
        View::Eye.name(),
        View::Fovea.name(),
        View::Edges.name(),
    ],
    View::ThirdPerson.name(),
    "Camera of rendered pictures: beside the robot, through the eye, the middle of the eye's image, \
     or the edges in it.",
);

/// Width of pictures.
pub(crate) const WIDTH: OptionSpec = OptionSpec::whole(
    "width",
    [16, 4096],
    "pixels",
    OptionDefault::Whole(480),
    "Width of rendered pictures [pixel].",
);

/// Height of pictures.
pub(crate) const HEIGHT: OptionSpec = OptionSpec::whole(
    "height",
    [16, 4096],
    "pixels",
    OptionDefault::Whole(480),
    "Height of rendered pictures [pixel].",
);

/// Edge of the eye's image.
pub(crate) const RETINA_SIZE: OptionSpec = OptionSpec::whole(
    "retina_size",
    [36, 2048],
    "pixels",
    OptionDefault::Whole(84),
    "Edge of the eye's image in obs=\"retina\" [pixel]; 630 is the paper's.",
);

/// The time limit.
pub(crate) const fn max_episode_steps(default: OptionDefault, doc: &'static str) -> OptionSpec {
    OptionSpec::whole(
        "max_episode_steps",
        [1, MOST_STEPS],
        "control steps",
        default,
        doc,
    )
}
