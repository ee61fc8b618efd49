//! Observations, actions, rewards and outcomes of grasping.

use std::borrow::Cow;

use babble_eye::FOVEA_BLOCKS;

use super::case::DIAMETER_BOUNDS_M;
use super::episode::{DROPPED_M, PROGRESS_UNIT_M};
use super::sight::FOVEA_NEURONS;
use super::state::{FACTS, MEASURES};
use super::task::GraspTask;
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::spec::{Entry, Spec};

/// How an episode of grasping can stand or end.
pub(super) const OUTCOMES: [Outcome; 5] = [
    Outcome::Running,
    Outcome::Success,
    Outcome::Collision,
    Outcome::Timeout,
    Outcome::Lost,
];
const JOINTS: [&str; 4] = ["shoulder", "elbow", "thumb", "finger"];

/// The spec of `task`.
pub(super) fn spec(task: &GraspTask) -> Spec {
    Spec {
        senses: senses(task),
        goals: goals(task),
        action: action(task),
        reward_terms: match (task.options.goal, task.options.reward) {
            (true, _) => &["distance"],
            (false, Reward::Progress) => &["progress", "enclosure", "success", "failure"],
            (false, Reward::Sparse) => &["success"],
        },
        reward_bounds: reward_bounds(task),
        facts: &FACTS,
        measures: MEASURES,
        outcomes: OUTCOMES.map(Outcome::name).to_vec(),
        max_episode_steps: task.options.max_episode_steps,
        control_hz: 1.0 / task.config.grasp.control_period_s,
    }
}

fn senses(task: &GraspTask) -> Vec<Entry> {
    let share = |name, labels: Vec<&'static str>, unit: String, description| Entry {
        name,
        low: vec![0.0; labels.len()],
        high: vec![1.0; labels.len()],
        labels,
        unit: unit.into(),
        description,
    };
    let range = || "share of range".to_owned();
    let stretch = task.stretch_bounds();
    let force = || format!("share of {} N", task.config.grasp.touch_max_n);
    let mut senses = vec![
        share("arm", vec!["shoulder", "elbow"], range(), "joint angles"),
        share(
            "eye",
            vec!["pan", "tilt"],
            range(),
            "gaze, which follows the object: where it is",
        ),
        share(
            "fovea",
            vec!["edge"; FOVEA_NEURONS],
            format!("{FOVEA_BLOCKS} × {FOVEA_BLOCKS}, row by row"),
            "edges in the middle of the eye's image: what the object is",
        ),
        share(
            "hand",
            vec!["thumb", "finger"],
            range(),
            "flexion of thumb and virtual finger, 0 when open",
        ),
        Entry {
            name: "stretch",
            labels: JOINTS.to_vec(),
            low: stretch.map(|x| -x).to_vec(),
            high: stretch.to_vec(),
            unit: "rad".into(),
            description: "equilibrium point minus joint angle: the muscles' state",
        },
        share(
            "time",
            vec!["elapsed"],
            "share of episode".to_owned(),
            "control steps since the reset over the time limit",
        ),
        share(
            "touch",
            vec!["palm", "thumb", "fingers"],
            force(),
            "normal force on the object, mean over the last control step",
        ),
    ];
    if task.options.arm_touch {
        senses.push(share(
            "touch_arm",
            vec!["upper arm", "forearm", "back of the hand"],
            force(),
            "normal force on the object at the end of the control step; that of the back of the hand is \
             part of the palm's in touch",
        ));
    }
    senses
}

fn goals(task: &GraspTask) -> Vec<Entry> {
    let reach = task.goal_space().bound;
    let goal = |name, description| Entry {
        name,
        labels: vec!["x", "y"],
        low: vec![-reach; 2],
        high: vec![reach; 2],
        unit: "m".into(),
        description,
    };
    vec![
        goal(
            "achieved_goal",
            "position of the object's centre; at the bounds once it failed to be carried",
        ),
        goal("desired_goal", "where it is to be carried"),
    ]
}

fn action(task: &GraspTask) -> Entry {
    let [arm, _, hand, _] = task.muscles();
    let degrees = task.config.grasp.delta_posture_deg;
    let (unit, description) = match task.options.control {
        Control::Posture => (
            Cow::from("half joint range"),
            "equilibrium points of the muscles, −1…1 over the joint ranges",
        ),
        Control::Torque => (
            Cow::from(format!(
                "{} N·m (arm), {} N·m (hand)",
                arm.torque_max, hand.torque_max
            )),
            "joint torques on top of the muscles' damping: T = action · torque_max − K_D q̇",
        ),
        Control::DeltaPosture | Control::Pattern => (
            Cow::from(format!("{degrees} deg")),
            "change of the muscles' equilibrium points, clipped to the joint ranges",
        ),
    };
    Entry {
        name: "action",
        labels: JOINTS.to_vec(),
        low: vec![-1.0; 4],
        high: vec![1.0; 4],
        unit,
        description,
    }
}

/// Bounds of the reward of one step. Where an episode goes on, object and palm are as near to each
/// other as the arm's reach allows. That no step moves them by as much is no theorem: it would take 20
/// m/s, and the fastest object in ten million steps of random play had 2.8 m/s. The share of enclosure is
/// from 0 to 1; success and failure exclude each other.
fn reward_bounds(task: &GraspTask) -> [f64; 2] {
    match (task.options.goal, task.options.reward) {
        (true, _) => [-1.0, 0.0],
        (false, Reward::Progress) => {
            let [length, width] = [task.arm.length(), task.arm.half_width];
            let [_, diameter] = DIAMETER_BOUNDS_M;
            let object = length + width + diameter;
            let pocket = length + task.robot.pocket(0.5 * diameter).norm();
            let most = libm::hypot(object + pocket, DROPPED_M) / PROGRESS_UNIT_M + 2.0;
            [-most, most]
        }
        (false, Reward::Sparse) => [0.0, 1.0],
    }
}
