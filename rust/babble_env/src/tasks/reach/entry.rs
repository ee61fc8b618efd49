//! Reaching in the registry: ids, options, parts of a case, protocols.

use std::sync::Arc;

use super::options::{MAX_EPISODE_STEPS, ReachOptions};
use super::task::ReachTask;
use crate::case::CasePart;
use crate::erased::AnyTask;
use crate::error::EnvError;
use crate::option_spec::{OptionDefault, OptionSpec, OptionValues};
use crate::options::{
    CAMERA, Control, HEIGHT, OBS, RECORD, RETINA_SIZE, REWARD, WIDTH, max_episode_steps,
};
use crate::registry::{EnvironmentEntry, ProtocolEntry, TaskEntry};

/// Reaching.
pub(crate) const ENTRY: TaskEntry = TaskEntry {
    name: "reach",
    title: "reaching",
    doc: "Reach a target around an obstacle with a simulated eye-arm-hand.",
    environments: &ENVIRONMENTS,
    options: &OPTIONS,
    case_parts: &CASE_PARTS,
    protocols: &PROTOCOLS,
    envs_per_thread: 64,
    make: |config, values| {
        let task = ReachTask::new(config, options(values)?)?;
        Ok(Arc::new(task) as Arc<dyn AnyTask>)
    },
};

/// Thresholds are success in nine cases of ten: an oracle that plays whole movements has mean returns
/// of 2.66, 1, −168 and 1.
const ENVIRONMENTS: [EnvironmentEntry; 4] = [
    EnvironmentEntry {
        id: "BabbleReach-v0",
        presets: &[],
        fixed: &[],
        max_episode_steps: MAX_EPISODE_STEPS,
        reward_threshold: Some(2.3),
    },
    EnvironmentEntry {
        id: "BabbleReachSparse-v0",
        presets: &[("reward", "sparse")],
        fixed: &[],
        max_episode_steps: MAX_EPISODE_STEPS,
        reward_threshold: Some(0.9),
    },
    EnvironmentEntry {
        id: "BabbleReachGoal-v0",
        presets: &[("obs", "goal"), ("reward", "sparse")],
        fixed: &[],
        max_episode_steps: MAX_EPISODE_STEPS,
        reward_threshold: Some(-120.0),
    },
    // An episode is one step.
    EnvironmentEntry {
        id: "BabbleReachPattern-v0",
        presets: &[("control", "pattern"), ("reward", "sparse")],
        fixed: &["control"],
        max_episode_steps: 1,
        reward_threshold: Some(0.9),
    },
];

const OPTIONS: [OptionSpec; 10] = [
    OBS,
    OptionSpec::choice(
        "control",
        &[
            Control::DeltaPosture.name(),
            Control::Posture.name(),
            Control::Torque.name(),
            Control::Pattern.name(),
        ],
        Control::DeltaPosture.name(),
        "Action: changes of the muscles' equilibrium points, the points themselves, joint torques, or \
         the parameters of one whole movement.",
    ),
    REWARD,
    OptionSpec::flag(
        "settled",
        "Success also requires that the arm has come to rest.",
    ),
    max_episode_steps(
        OptionDefault::Whole(MAX_EPISODE_STEPS),
        "Time limit in control steps; without effect in `pattern` control, where an episode is one step.",
    ),
    RECORD,
    CAMERA,
    WIDTH,
    HEIGHT,
    RETINA_SIZE,
];

/// Parts of a case.
const CASE_PARTS: [CasePart; 3] = [
    CasePart {
        name: "start",
        lengths: &[2],
        unit: "m",
        doc: "Position (x, y) of the fingertip at the start.",
    },
    CasePart {
        name: "target",
        lengths: &[2],
        unit: "m",
        doc: "Position (x, y) of the target.",
    },
    CasePart {
        name: "obstacle",
        lengths: &[2, 3],
        unit: "m",
        doc: "Axis (x, y) and radius of the obstacle, the config's radius if not given; None for no \
              obstacle; halfway between start and target if not given.",
    },
];

const OUTCOMES: &[&str] = &["success", "collision", "joint_limit", "timeout"];

const PROTOCOLS: [ProtocolEntry; 2] = [
    ProtocolEntry {
        name: "table1",
        doc: "Legal movements, sampled by the full simulation as the paper sampled its tests.",
        cases: "cases of Table I",
        presets: &[],
        random: true,
        outcomes: OUTCOMES,
    },
    ProtocolEntry {
        name: "fig4",
        doc: "36 starts around each of 4 targets.",
        cases: "cases of Fig. 4",
        presets: &[],
        random: false,
        outcomes: OUTCOMES,
    },
];

fn options(values: &OptionValues) -> Result<ReachOptions, EnvError> {
    let control = values.name("control").parse::<Control>()?;
    Ok(ReachOptions {
        control,
        reward: values.name("reward").parse()?,
        goal: values.name("obs") == "goal",
        settled: values.flag("settled"),
        // A movement is an episode, whatever limit was registered for other controls.
        max_episode_steps: match control {
            Control::Pattern => 1,
            _ => values
                .whole("max_episode_steps")
                .unwrap_or(MAX_EPISODE_STEPS),
        },
        record: values.flag("record"),
    })
}
