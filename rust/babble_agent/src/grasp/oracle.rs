//! An agent of grasping that tries grasps in its head.

use std::sync::Arc;

use babble_env::tasks::grasp::{FACTS, GraspRequest, ObjectPlace};
use babble_env::{Autoreset, Batch, Control, EnvError, Executor, GraspOptions, GraspTask, Reward};

use super::policy::{ChooseGrasp, GraspPolicy, Scripted, Sight};
use crate::error::AgentError;
use crate::policy::{Grasp, predict};

/// How far the palm's surface is aimed beyond the middle of the object, in radii of the smallest one:
/// 0 is the script's aim, 1 lies against the palm.
const AIMS: [f64; 3] = [0.0, 1.0, -0.5];
/// How far the shoulder goes beyond its end before the arm comes back with the palm ahead \[deg\]: the
/// palm faces counter-clockwise.
const BEYOND_DEG: [f64; 3] = [30.0, 60.0, 90.0];

/// Simulates grasps of an object where the eye looks, of each of the config's diameters: the script's
/// first, then other aims and ways around the object. It plays the first that holds all diameters, or
/// else the one that holds most of them.
#[derive(Debug, Clone, Copy)]
pub struct Oracle;

impl ChooseGrasp for Oracle {
    fn choose(&self, task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        let first = Scripted.choose(task, sight)?;
        let gaze = task.eye.from_normalised(sight.eye.map(f64::from));
        let Some(object) = task.eye.target_in_plane(gaze, 0.0) else {
            return Ok(first);
        };
        let start = task
            .arm
            .denormalised([sight.posture[0], sight.posture[1]].map(f64::from));
        let diameters = &task.config.grasp.diameters_m;
        let imagined = imagine(task)?;
        let mut best = (0, first);
        for candidate in candidates(task, start, object) {
            let mut held = 0;
            for &diameter in diameters {
                held += usize::from(holds(&imagined, start, object, diameter, &candidate)?);
            }
            if held == diameters.len() {
                return Ok(candidate);
            }
            if held > best.0 {
                best = (held, candidate);
            }
        }
        Ok(best.1)
    }
}

/// The same task with goals left aside and postures for actions.
fn imagine(task: &GraspTask) -> Result<Arc<GraspTask>, EnvError> {
    let options = GraspOptions {
        control: Control::Posture,
        reward: Reward::Sparse,
        goal: false,
        record: false,
        ..task.options
    };
    Ok(Arc::new(GraspTask::new(task.config.clone(), options)?))
}

/// Straight ways first, then ways around the object: the elbow bends (or stretches) so that the hand
/// passes the object on its inner (or outer) side, the shoulder turns beyond it, and the arm comes back
/// with the palm ahead.
fn candidates(task: &GraspTask, start: [f64; 2], object: [f64; 2]) -> Vec<Grasp> {
    let diameters = task.config.grasp.diameters_m.iter().copied();
    let smallest = diameters.fold(f64::INFINITY, f64::min);
    let aimed = |aim: f64| task.grasp_posture(object, aim * smallest / 2.0);
    let straight = |arm| Grasp::straight(arm, task.reflex());
    let mut all: Vec<Grasp> = AIMS.into_iter().filter_map(aimed).map(straight).collect();
    let ranges = task.robot.ranges();
    let [low, high] = ranges[0];
    if let Some(arm) = aimed(0.0) {
        for elbow in [ranges[1][1], ranges[1][0]] {
            for beyond in BEYOND_DEG {
                let shoulder = (arm[0] - beyond.to_radians()).clamp(low, high);
                all.push(Grasp {
                    via: [[start[0], elbow], [shoulder, elbow], [shoulder, arm[1]]].into(),
                    ..straight(arm)
                });
            }
        }
    }
    all
}

/// Whether a grasp holds an object of a diameter \[m\].
fn holds(
    task: &Arc<GraspTask>,
    start: [f64; 2],
    object: [f64; 2],
    diameter: f64,
    candidate: &Grasp,
) -> Result<bool, AgentError> {
    let mut env = Batch::new(task.clone(), 1, Autoreset::Disabled, 1)?;
    let request = GraspRequest {
        start: Some(start),
        object: ObjectPlace::At(object),
        diameter: Some(diameter),
        ..GraspRequest::default()
    };
    env.request(0, request)?;
    match env.reset(&[true]) {
        // What the eye tells is rounded: an object may seem to begin in the arm.
        Err(EnvError::Case { .. } | EnvError::NoGraspCase { .. }) => return Ok(false),
        begun => begun?,
    }
    let policy = GraspPolicy::new(task.clone(), Imagined(candidate.clone()))?;
    let (mut plans, mut executor) = (Vec::new(), Executor::new(1)?);
    loop {
        let Some(record) = env.records().next() else {
            return Ok(false);
        };
        if record.step.terminated || record.step.truncated {
            let held = FACTS.iter().position(|&fact| fact == "held");
            return Ok(held.is_some_and(|i| record.info.facts[i]));
        }
        let actions = predict(
            &policy,
            &record.senses.clone(),
            &[false],
            &mut plans,
            &mut executor,
        )?;
        env.step(&actions)?;
    }
}

/// A grasp that was chosen before.
#[derive(Debug, Clone)]
struct Imagined(Grasp);

impl ChooseGrasp for Imagined {
    fn choose(&self, _task: &GraspTask, _sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        Ok(self.0.clone())
    }
}
