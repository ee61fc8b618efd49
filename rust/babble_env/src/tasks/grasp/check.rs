//! Whether a state that somebody else wrote is one of this task's episodes.

use super::case::DIAMETER_BOUNDS_M;
use super::enclosure::Grip;
use super::sight;
use super::state::{GraspState, setup};
use super::task::GraspTask;
use crate::check::{ensure, refused, within};
use crate::error::EnvError;
use crate::options::Control;
use crate::progress::Phase;

/// No force \[N\], distance \[m\] or angle \[rad\] gets there.
const MOST: f64 = 1e18;

/// As [`crate::Task::check`]: every number is finite and in bounds, but with the tree engine
/// a state that passes need not be one that some episode did reach.
pub(super) fn check(task: &GraspTask, state: &mut GraspState) -> Result<(), EnvError> {
    let numbers = &task.config.grasp;
    check_case(task, state)?;
    check_senses(task, state)?;
    state.enclosure.check(numbers, state.progress.steps)?;
    let supported = task.options.support_stays || state.enclosure.grip == Grip::Open;
    ensure(task.robot.has_support(&state.world) == supported, || {
        "the support goes when a grasp is tried, not before or after, unless it stays".to_owned()
    })?;
    let failed = task.options.support_stays && state.enclosure.grip == Grip::Failed;
    ensure(!failed, || {
        "a grasp on a support that stays does not fail".to_owned()
    })?;
    check_trail(task, state)?;
    state
        .lifecycle
        .request
        .check(task)
        .map_err(|error| refused(&error))?;
    let steps = u64::from(state.progress.steps) * u64::from(numbers.physics_steps);
    let begin = setup(task, &state.case);
    let checked = task.robot.check(&mut state.world, &begin, steps);
    checked.map_err(|error| refused(&error))?;
    let scene = sight::scene(task, &state.world, &state.case);
    state.in_sight = task.eye.reflex_step(&scene, state.gaze).is_some();
    Ok(())
}

fn check_case(task: &GraspTask, state: &GraspState) -> Result<(), EnvError> {
    let case = &state.case;
    for i in 0..2 {
        let range = [task.arm.lower[i], task.arm.upper_limit[i]];
        within("case.start", [&case.start[i]], range)?;
    }
    within("case.diameter", [&case.diameter], DIAMETER_BOUNDS_M)?;
    for (what, point) in [("case.object", Some(case.object)), ("case.goal", case.goal)] {
        let Some([x, y]) = point else { continue };
        // An object at the palm may be a little further out than the fingertips.
        let farthest = task.arm.length() + task.arm.half_width + case.diameter;
        within(what, [&libm::hypot(x, y)], [0.0, farthest])?;
    }
    // Before the first reset there is no goal in any form.
    let goal = case.goal.is_some() == task.options.goal || state.lifecycle.phase == Phase::Fresh;
    ensure(goal, || {
        "a goal is there with obs = \"goal\" alone".to_owned()
    })?;
    let obstacle = case.obstacle.as_ref();
    obstacle
        .map_or(Ok(()), crate::tasks::reach::case::check_obstacle)
        .map_err(|error| refused(&error))
}

fn check_senses(task: &GraspTask, state: &GraspState) -> Result<(), EnvError> {
    within("gaze.pan", [&state.gaze.pan], task.eye.ranges()[0])?;
    within("gaze.tilt", [&state.gaze.tilt], task.eye.ranges()[1])?;
    within("touch", &state.touch, [0.0, MOST])?;
    within("distance", [&state.distance], [0.0, MOST])?;
    let range = match task.options.control {
        // Torques are shown as the equilibrium points that would pull as hard, from any posture.
        Control::Torque => [[-MOST, MOST]; 4],
        _ => *task.robot.ranges(),
    };
    for i in 0..4 {
        within("equilibrium", [&state.equilibrium[i]], range[i])?;
    }
    Ok(())
}

fn check_trail(task: &GraspTask, state: &GraspState) -> Result<(), EnvError> {
    let moments = state.trail.len();
    ensure(moments <= state.progress.steps as usize + 1, || {
        format!(
            "{moments} moments were recorded in {} steps",
            state.progress.steps
        )
    })?;
    let joints = task.robot.joint_angles(&state.world).len();
    for moment in &state.trail {
        let found = moment.joints.len();
        ensure(found == joints, || {
            format!("a moment has {found} joints, not {joints}")
        })?;
        let places = moment.object.iter().chain(&moment.palm);
        within("trail", moment.joints.iter().chain(places), [-MOST, MOST])?;
        within("trail.pan", [&moment.gaze.pan], task.eye.ranges()[0])?;
        within("trail.tilt", [&moment.gaze.tilt], task.eye.ranges()[1])?;
    }
    Ok(())
}
