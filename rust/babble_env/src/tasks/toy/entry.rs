//! The toy task in the registry.

use std::sync::Arc;

use super::task::PointTask;
use crate::case::CasePart;
use crate::erased::AnyTask;
use crate::option_spec::{OptionDefault, OptionSpec};
use crate::options::{CAMERA, HEIGHT, RECORD, WIDTH, max_episode_steps};
use crate::registry::{EnvironmentEntry, ProtocolEntry, TaskEntry};

/// The toy task.
pub(crate) const ENTRY: TaskEntry = TaskEntry {
    name: "toy",
    title: "moving a point",
    doc: "Move a point to a target in the plane.",
    environments: &[EnvironmentEntry {
        id: "BabbleToy-v0",
        presets: &[],
        fixed: &[],
        max_episode_steps: 50,
        reward_threshold: Some(0.9),
    }],
    options: &[
        OptionSpec::choice(
            "obs",
            &["senses", "flat"],
            "senses",
            "Observation: named senses, or the same in one flat array.",
        ),
        max_episode_steps(OptionDefault::Whole(50), "Time limit in steps."),
        RECORD,
        CAMERA,
        WIDTH,
        HEIGHT,
    ],
    case_parts: &[CasePart {
        name: "target",
        lengths: &[2],
        unit: "m",
        doc: "Position (x, y) of the target.",
    }],
    protocols: &[ProtocolEntry {
        name: "toy",
        doc: "Random targets.",
        cases: "random targets",
        presets: &[],
        random: true,
        outcomes: &["success", "timeout"],
    }],
    envs_per_thread: 1024,
    make: |config, values| {
        let max_episode_steps = values.whole("max_episode_steps").unwrap_or(50);
        let task = PointTask {
            config,
            max_episode_steps,
            record: values.flag("record"),
        };
        Ok(Arc::new(task) as Arc<dyn AnyTask>)
    },
};
