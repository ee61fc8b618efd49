//! Observations, actions, rewards and outcomes of reaching.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use super::episode::PROGRESS_UNIT_M;
use super::task::ReachTask;
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::progress::SUCCESS_FACTS;
use crate::spec::{Entry, Spec};

/// How an episode of reaching can stand or end.
pub(super) const OUTCOMES: [Outcome; 5] = [
    Outcome::Running,
    Outcome::Success,
    Outcome::Collision,
    Outcome::JointLimit,
    Outcome::Timeout,
];

/// The spec of `task`.
pub(super) fn spec(task: &ReachTask) -> Spec {
    Spec {
        senses: senses(task),
        goals: goals(task),
        action: action(task),
        reward_terms: reward_terms(task),
        reward_bounds: reward_bounds(task),
        facts: &SUCCESS_FACTS,
        measures: &[],
        outcomes: OUTCOMES.map(Outcome::name).to_vec(),
        max_episode_steps: task.options.max_episode_steps,
        control_hz: 1.0 / task.config.reach.control_period_s,
    }
}

fn senses(task: &ReachTask) -> Vec<Entry> {
    let unit_square = || (vec![0.0; 2], vec![1.0; 2]);
    let angles = || (vec![-PI, -FRAC_PI_2], vec![PI, FRAC_PI_2]);
    let stretch = task.stretch_bounds();
    let entry =
        |name, labels: [&'static str; 2], (low, high), unit: &'static str, description| Entry {
            name,
            labels: labels.to_vec(),
            low,
            high,
            unit: unit.into(),
            description,
        };
    vec![
        entry(
            "arm",
            ["shoulder", "elbow"],
            unit_square(),
            "share of range",
            "joint angles",
        ),
        entry(
            "eye",
            ["pan", "tilt"],
            unit_square(),
            "share of range",
            "gaze, fixed on the target: where the target is",
        ),
        entry(
            "hand",
            ["azimuth", "elevation"],
            angles(),
            "rad",
            "angles of the fingertip in the camera frame",
        ),
        entry(
            "obstacle",
            ["azimuth", "elevation"],
            angles(),
            "rad",
            "angles of the obstacle's axis in the camera frame; lowest when there is none",
        ),
        entry(
            "stretch",
            ["shoulder", "elbow"],
            (stretch.map(|x| -x).to_vec(), stretch.to_vec()),
            "rad",
            "equilibrium point minus joint angle: the muscles' state",
        ),
        Entry {
            name: "time",
            labels: vec!["elapsed"],
            low: vec![0.0],
            high: vec![1.0],
            unit: "share of episode".into(),
            description: "control steps since the reset over the time limit",
        },
    ]
}

fn goals(task: &ReachTask) -> Vec<Entry> {
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
            "position of the fingertip; at the bounds once the arm failed",
        ),
        goal("desired_goal", "position of the target"),
    ]
}

fn action(task: &ReachTask) -> Entry {
    let degrees = task.config.reach.delta_posture_deg;
    let torque = task.config.body.muscles.torque_max;
    let (labels, unit, description) = match task.options.control {
        Control::DeltaPosture => (
            vec!["shoulder", "elbow"],
            Cow::from(format!("{degrees} deg")),
            "change of the muscles' equilibrium points, clipped to the joint ranges",
        ),
        Control::Posture => (
            vec!["shoulder", "elbow"],
            Cow::from("half joint range"),
            "equilibrium points of the muscles, −1…1 over the joint ranges",
        ),
        Control::Torque => (
            vec!["shoulder", "elbow"],
            Cow::from(format!("{torque} N·m")),
            "joint torques on top of the muscles' damping: T = action · torque_max − K_D q̇",
        ),
        Control::Pattern => (
            vec!["b1", "b2"],
            Cow::from("½, from b = ½"),
            "parameters of the pattern generators (Eq. 5); one step is one whole movement",
        ),
    };
    Entry {
        name: "action",
        labels,
        low: vec![-1.0; 2],
        high: vec![1.0; 2],
        unit,
        description,
    }
}

/// Names of the reward terms, in their order.
fn reward_terms(task: &ReachTask) -> &'static [&'static str] {
    match (task.options.goal, task.options.reward) {
        (true, _) => &["distance"],
        (false, Reward::Progress) => &["progress", "success", "failure"],
        (false, Reward::Sparse) => &["success"],
    }
}

/// Bounds of the reward of one step. Fingertip and target are within the arm's length of the shoulder,
/// so no step brings them nearer or farther by more than twice that; success and failure exclude each
/// other.
fn reward_bounds(task: &ReachTask) -> [f64; 2] {
    match (task.options.goal, task.options.reward) {
        (true, _) => [-1.0, 0.0],
        (false, Reward::Progress) => {
            let most = 2.0 * task.arm.length() / PROGRESS_UNIT_M + 1.0;
            [-most, most]
        }
        (false, Reward::Sparse) => [0.0, 1.0],
    }
}
