//! The one description of observations and actions. Spaces in Python, tables in the docs and every
//! other face are made from it.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use serde::Serialize;

use crate::options::{Control, Reward};
use crate::task::ReachTask;

/// A named group of numbers in an observation or an action.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Name of the group.
    pub name: &'static str,
    /// What each number is.
    pub labels: Vec<&'static str>,
    /// Lower bounds.
    pub low: Vec<f64>,
    /// Upper bounds.
    pub high: Vec<f64>,
    /// Unit of the numbers; for an action, what ±1 stands for.
    pub unit: Cow<'static, str>,
    /// What the group tells.
    pub description: &'static str,
}

/// Everything a face needs to build an environment's spaces and docs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spec {
    /// The senses, in the order of the flat observation.
    pub senses: Vec<Entry>,
    /// The two goals of the goal form.
    pub goals: Vec<Entry>,
    /// The action.
    pub action: Entry,
    /// Names of the reward terms, in their order.
    pub reward_terms: &'static [&'static str],
    /// Names of the outcomes, in the order of their codes.
    pub outcomes: Vec<&'static str>,
    /// Time limit in control steps.
    pub max_episode_steps: u32,
    /// Control periods a second.
    pub control_hz: f64,
}

/// The spec of `task`.
#[must_use]
pub fn spec(task: &ReachTask) -> Spec {
    Spec {
        senses: senses(task),
        goals: goals(task),
        action: action(task),
        reward_terms: reward_terms(task),
        outcomes: crate::options::Outcome::ALL
            .iter()
            .map(|outcome| outcome.name())
            .collect(),
        max_episode_steps: task.options.max_episode_steps,
        control_hz: 1.0 / task.config.reach.control_period_s,
    }
}

/// The senses, in the order of the flat observation.
#[must_use]
pub fn senses(task: &ReachTask) -> Vec<Entry> {
    let unit_square = || (vec![0.0; 2], vec![1.0; 2]);
    let angles = || (vec![-PI, -FRAC_PI_2], vec![PI, FRAC_PI_2]);
    let arm = &task.arm;
    let muscles = &task.config.body.muscles;
    let stretch = [0, 1].map(|i| match task.options.control {
        Control::Torque => muscles.torque_max / muscles.kp,
        _ => arm.upper_limit[i] - arm.lower[i],
    });
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
            "eye",
            ["pan", "tilt"],
            unit_square(),
            "share of range",
            "gaze, fixed on the target: where the target is",
        ),
        entry(
            "obstacle",
            ["azimuth", "elevation"],
            angles(),
            "rad",
            "angles of the obstacle's axis in the camera frame; lowest when there is none",
        ),
        entry(
            "hand",
            ["azimuth", "elevation"],
            angles(),
            "rad",
            "angles of the fingertip in the camera frame",
        ),
        entry(
            "arm",
            ["shoulder", "elbow"],
            unit_square(),
            "share of range",
            "joint angles",
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
    let reach = task.arm.length();
    let goal = |name, description| Entry {
        name,
        labels: vec!["x", "y"],
        low: vec![-reach; 2],
        high: vec![reach; 2],
        unit: "m".into(),
        description,
    };
    vec![
        goal("achieved_goal", "position of the fingertip"),
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
#[must_use]
pub fn reward_terms(task: &ReachTask) -> &'static [&'static str] {
    match (task.options.goal, task.options.reward) {
        (true, _) => &["distance"],
        (false, Reward::Progress) => &["progress", "success", "failure"],
        (false, Reward::Sparse) => &["success"],
    }
}
