//! Grasping in the registry: ids, options, parts of a case, protocols.

use std::sync::Arc;

use super::options::{GraspOptions, Region};
use super::task::GraspTask;
use crate::case::CasePart;
use crate::config::Config;
use crate::erased::AnyTask;
use crate::error::EnvError;
use crate::option_spec::{OptionDefault, OptionKind, OptionSpec, OptionValues};
use crate::options::{
    CAMERA, Control, HEIGHT, OBS, RECORD, RETINA_SIZE, REWARD, WIDTH, max_episode_steps,
};
use crate::registry::{EnvironmentEntry, ProtocolEntry, TaskEntry};

/// Grasping.
pub(crate) const ENTRY: TaskEntry = TaskEntry {
    name: "grasp",
    title: "grasping",
    doc: "Reach for an object and grasp it with a simulated eye-arm-hand.",
    environments: &ENVIRONMENTS,
    options: &OPTIONS,
    case_parts: &CASE_PARTS,
    protocols: &PROTOCOLS,
    envs_per_thread: 4,
    make: |config, values| {
        let task = GraspTask::new(with_diameters(config, values), options(values)?)?;
        Ok(Arc::new(task) as Arc<dyn AnyTask>)
    },
};

/// Thresholds are success in nine cases of ten: a hand that goes straight to the object and closes has
/// mean returns of 5.8 and 1.
const ENVIRONMENTS: [EnvironmentEntry; 4] = [
    EnvironmentEntry {
        id: "BabbleGrasp-v0",
        presets: &[],
        fixed: &["region"],
        max_episode_steps: Region::PalmSide.max_episode_steps(),
        reward_threshold: Some(5.5),
    },
    EnvironmentEntry {
        id: "BabbleGraspSparse-v0",
        presets: &[("reward", "sparse")],
        fixed: &["region"],
        max_episode_steps: Region::PalmSide.max_episode_steps(),
        reward_threshold: Some(0.9),
    },
    EnvironmentEntry {
        id: "BabbleGraspGoal-v0",
        presets: &[("obs", "goal"), ("reward", "sparse")],
        fixed: &["region"],
        max_episode_steps: Region::PalmSide.max_episode_steps(),
        reward_threshold: None,
    },
    EnvironmentEntry {
        id: "BabbleGraspFull-v0",
        presets: &[("region", "full")],
        fixed: &["region"],
        max_episode_steps: Region::Full.max_episode_steps(),
        reward_threshold: None,
    },
];

const OPTIONS: [OptionSpec; 17] = [
    OBS,
    OptionSpec::choice(
        "control",
        &[
            Control::DeltaPosture.name(),
            Control::Posture.name(),
            Control::Torque.name(),
        ],
        Control::DeltaPosture.name(),
        "Action: changes of the muscles' equilibrium points, the points themselves, or joint torques.",
    ),
    REWARD,
    OptionSpec::choice(
        "region",
        &[Region::PalmSide.name(), Region::Full.name()],
        Region::PalmSide.name(),
        "Where objects lie and arms start: on the palm's side, or in all of the plane, which is \
         BabbleGraspFull-v0.",
    ),
    OptionSpec {
        name: "diameters",
        kind: OptionKind::Numbers {
            low: 0.005,
            high: 0.2,
            unit: "m",
        },
        default: OptionDefault::Derived,
        doc: "Diameters of the objects [m], one of which is sampled; the config's 2.4 and 6 cm if not given.",
    },
    OptionSpec::flag(
        "any_diameter_between",
        "Sample a diameter between the smallest and the largest, as a config can say too.",
    ),
    OptionSpec::flag(
        "enclosure_reflex",
        "The hand closes by reflex from the first touch of the palm on, whatever the action.",
    ),
    OptionSpec::flag(
        "reflex_releases",
        "With enclosure_reflex: an action that opens the hand stops the reflex, until the palm is touched \
         again.",
    ),
    OptionSpec::flag(
        "support_stays",
        "The object's support is never taken away, so that the hand can grasp and release over and over; \
         episodes run to their time limit.",
    ),
    OptionSpec::flag(
        "arm_touch",
        "Adds the sense touch_arm: upper arm, forearm and the back of the hand feel the object.",
    ),
    OptionSpec {
        name: "in_hand_starts",
        kind: OptionKind::Number {
            low: 0.0,
            high: 1.0,
        },
        default: OptionDefault::Number(0.0),
        doc: "Share of the sampled cases that begin with the object at the palm of the open hand, as in \
              babbling.",
    },
    max_episode_steps(
        OptionDefault::Derived,
        "Time limit in control steps; 240, or 500 in region \"full\", if not given.",
    ),
    RECORD,
    CAMERA,
    WIDTH,
    HEIGHT,
    RETINA_SIZE,
];

/// Parts of a case.
const CASE_PARTS: [CasePart; 6] = [
    CasePart {
        name: "start",
        lengths: &[2],
        unit: "rad",
        doc: "Shoulder and elbow at the start.",
    },
    CasePart {
        name: "object",
        lengths: &[2],
        unit: "m",
        doc: "Position (x, y) of the object's centre.",
    },
    CasePart {
        name: "diameter",
        lengths: &[0],
        unit: "m",
        doc: "Diameter of the object.",
    },
    CasePart {
        name: "goal",
        lengths: &[2],
        unit: "m",
        doc: "With obs=\"goal\": position (x, y) to carry the object to.",
    },
    CasePart {
        name: "obstacle",
        lengths: &[2, 3],
        unit: "m",
        doc: "Axis (x, y) and radius of the obstacle, the config's radius if not given; no obstacle if \
              not given.",
    },
    CasePart {
        name: "in_hand",
        lengths: &[],
        unit: "",
        doc: "True: the object is at the palm of the open hand, whatever `object` says; False: it is not; \
              in_hand_starts decides if not given.",
    },
];

/// Without an obstacle nothing collides.
const OUTCOMES: &[&str] = &["success", "lost", "timeout"];

const PROTOCOLS: [ProtocolEntry; 4] = [
    ProtocolEntry {
        name: "palm_side",
        doc: "Random cases with the object on the palm's side.",
        cases: "objects on the palm's side",
        presets: &[("region", "palm_side")],
        random: true,
        outcomes: OUTCOMES,
    },
    ProtocolEntry {
        name: "full",
        doc: "Random cases in all of the plane.",
        cases: "objects in all of the plane",
        presets: &[("region", "full")],
        random: true,
        outcomes: OUTCOMES,
    },
    ProtocolEntry {
        name: "table2",
        doc: "12 positions of the object times 12 starts for each diameter, where the arm does not begin \
              in the object.",
        cases: "cases of Table II",
        presets: &[("region", "full")],
        random: false,
        outcomes: OUTCOMES,
    },
    ProtocolEntry {
        name: "fig7",
        doc: "The 12 positions of \"table2\" times 11 starts for each diameter.",
        cases: "cases of Fig. 7",
        presets: &[("region", "full")],
        random: false,
        outcomes: OUTCOMES,
    },
];

fn with_diameters(mut config: Config, values: &OptionValues) -> Config {
    if let Some(diameters) = values.numbers("diameters") {
        config.grasp.diameters_m = diameters;
    }
    config.grasp.any_diameter_between |= values.flag("any_diameter_between");
    config
}

fn options(values: &OptionValues) -> Result<GraspOptions, EnvError> {
    let region = values.name("region").parse::<Region>()?;
    let most = values.whole("max_episode_steps");
    Ok(GraspOptions {
        control: values.name("control").parse()?,
        reward: values.name("reward").parse()?,
        goal: values.name("obs") == "goal",
        region,
        enclosure_reflex: values.flag("enclosure_reflex"),
        reflex_releases: values.flag("reflex_releases"),
        support_stays: values.flag("support_stays"),
        arm_touch: values.flag("arm_touch"),
        in_hand_starts: values.number("in_hand_starts"),
        max_episode_steps: most.unwrap_or(region.max_episode_steps()),
        record: values.flag("record"),
    })
}
