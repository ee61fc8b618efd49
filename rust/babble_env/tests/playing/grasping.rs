//! The grasping task, and a script that grasps in any control.

use std::sync::Arc;

use babble_body::Obstacle;
use babble_env::tasks::grasp::{GraspRequest, GraspState, ObjectPlace};
use babble_env::{
    Autoreset, Batch, Config, Control, GraspOptions, GraspTask, Outcome, Reward, Task,
};
use nalgebra::Vector2;

use super::{record, seeded};

/// The controls that grasping has.
pub(crate) const CONTROLS: [Control; 3] =
    [Control::DeltaPosture, Control::Posture, Control::Torque];

/// The facts in their order.
pub(crate) const IS_SUCCESS: usize = 0;
pub(crate) const REACH: usize = 2;
pub(crate) const PALM_REACH: usize = 3;
pub(crate) const HELD: usize = 4;

/// Options with that control, else the default ones.
pub(crate) fn with_control(control: Control) -> GraspOptions {
    GraspOptions {
        control,
        ..GraspOptions::default()
    }
}

/// Options of the goal form.
pub(crate) fn goal_form(control: Control) -> GraspOptions {
    GraspOptions {
        goal: true,
        reward: Reward::Sparse,
        ..with_control(control)
    }
}

pub(crate) fn grasp(options: GraspOptions) -> Arc<GraspTask> {
    grasp_with("{}", options)
}

/// The task with fields of the config replaced.
pub(crate) fn grasp_with(json: &str, options: GraspOptions) -> Arc<GraspTask> {
    Arc::new(GraspTask::new(Config::from_json(json).unwrap(), options).unwrap())
}

/// One environment that a person resets, with that asked of its cases.
pub(crate) fn asked(task: Arc<GraspTask>, seed: u64, request: GraspRequest) -> Batch<GraspTask> {
    let mut env = seeded(task, 1, Autoreset::Disabled, 1, seed);
    env.seed(0, seed).unwrap();
    env.request(0, request).unwrap();
    env.reset(&[true]).unwrap();
    env
}

/// An object right before the palm, so that it is touched within a few steps.
pub(crate) fn before_the_palm(task: &GraspTask, diameter: f64) -> GraspRequest {
    let start = [0.2, 0.8];
    GraspRequest {
        start: Some(start),
        object: ObjectPlace::At(task.before_palm(start, diameter / 2.0, 0.006)),
        diameter: Some(diameter),
        ..GraspRequest::default()
    }
}

/// An action that asks for a posture \[rad\] as far as the control can.
pub(crate) fn asking_for(task: &GraspTask, state: &GraspState, posture: [f64; 4]) -> [f32; 4] {
    let share = task.robot.normalised(posture);
    let now = task.robot.posture(&state.world);
    let unit = task.config.grasp.delta_posture_deg.to_radians();
    let muscles = task.muscles();
    std::array::from_fn(|i| {
        let action = match task.options.control {
            Control::Posture => 2.0 * share[i] - 1.0,
            Control::Torque => muscles[i].kp * (posture[i] - now[i]) / muscles[i].torque_max,
            _ => (posture[i] - state.equilibrium[i]) / unit,
        };
        action.clamp(-1.0, 1.0) as f32
    })
}

/// The palm to where the object lay with the open hand; the hand closes as the reflex does once
/// the object is touched, if it `closes`.
pub(crate) fn script(task: &GraspTask, state: &GraspState, closes: bool) -> [f32; 4] {
    let case = &state.case;
    // Some way into the object, so that the muscles press the palm against it.
    let into = task.grasp_posture(case.object, case.radius() - 0.015);
    let there = into.or_else(|| task.grasp_posture(case.object, case.radius()));
    let mut posture = task.robot.open_hand(there.unwrap_or(case.start));
    if closes && state.reach {
        posture[2..].copy_from_slice(&task.reflex());
    }
    asking_for(task, state, posture)
}

/// Plays the script to the episode's end, looking at each state; how it ended.
pub(crate) fn play(
    env: &mut Batch<GraspTask>,
    closes: bool,
    mut look: impl FnMut(&Batch<GraspTask>),
) -> Outcome {
    loop {
        let action = script(env.task(), env.state(0).unwrap(), closes);
        env.step(&action).unwrap();
        look(env);
        if super::ended(&record(env)) {
            return env.state(0).unwrap().progress.outcome;
        }
    }
}

/// Lowest and highest of every number of the observation, and the sense that it is of.
pub(crate) fn bounds(task: &GraspTask) -> Vec<(&'static str, f32, f32)> {
    let senses = task.spec().senses;
    let each = senses.iter().flat_map(|entry| {
        let numbers = entry.low.iter().zip(&entry.high);
        numbers.map(|(&low, &high)| (entry.name, low as f32, high as f32))
    });
    each.collect()
}

/// A cylinder in the plane.
pub(crate) fn obstacle(centre: [f64; 2], radius: f64) -> Obstacle {
    Obstacle {
        centre: Vector2::from(centre),
        radius,
    }
}
