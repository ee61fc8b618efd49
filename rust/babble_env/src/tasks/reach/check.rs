//! Whether a state that somebody else wrote is one of this task's episodes.

use super::case::ReachCase;
use super::state::ReachState;
use super::task::ReachTask;
use crate::check::{MARGIN, ensure, refused, within};
use crate::error::EnvError;
use crate::options::Control;

/// As [`crate::Task::check`]: every number is finite and within what an episode can reach,
/// but a state that passes need not be one that some episode did reach.
pub(super) fn check(task: &ReachTask, state: &ReachState) -> Result<(), EnvError> {
    check_arm(task, state)?;
    check_case(task, &state.case)?;
    within("gaze.pan", [&state.gaze.pan], task.eye.ranges()[0])?;
    within("gaze.tilt", [&state.gaze.tilt], task.eye.ranges()[1])?;
    let farthest = 2.0 * task.arm.length();
    within("distance", [&state.distance], [0.0, farthest])?;
    let request = &state.lifecycle.request;
    request.check(task).map_err(|error| refused(&error))?;
    check_trail(task, state)
}

fn check_arm(task: &ReachTask, state: &ReachState) -> Result<(), EnvError> {
    let muscles = &task.config.body.muscles;
    // Torques are shown as the equilibrium points that would pull as hard.
    let beyond = match task.options.control {
        Control::Torque => muscles.torque_max / muscles.kp,
        _ => 0.0,
    };
    for i in 0..2 {
        let [low, high] = [task.arm.lower[i], task.arm.upper_limit[i]];
        // A joint that would leave its range within a step is stopped.
        let fastest = (high - low) / task.config.reach.physics_step_s() * (1.0 + MARGIN);
        within("arm.q", [&state.arm.q[i]], [low, high])?;
        within("arm.v", [&state.arm.v[i]], [-fastest, fastest])?;
        let range = [low - beyond, high + beyond];
        within("equilibrium", [&state.equilibrium[i]], range)?;
    }
    Ok(())
}

fn check_case(task: &ReachTask, case: &ReachCase) -> Result<(), EnvError> {
    for i in 0..2 {
        let range = [task.arm.lower[i], task.arm.upper_limit[i]];
        within("case.start", [&case.start[i]], range)?;
    }
    for (what, [x, y]) in [("case.hand", case.hand), ("case.target", case.target)] {
        within(what, [&libm::hypot(x, y)], [0.0, task.arm.length()])?;
    }
    let obstacle = case.obstacle.as_ref();
    obstacle
        .map_or(Ok(()), super::case::check_obstacle)
        .map_err(|error| refused(&error))
}

fn check_trail(task: &ReachTask, state: &ReachState) -> Result<(), EnvError> {
    let steps = match task.options.control {
        Control::Pattern => task.config.reach.movement_steps() + task.settle_steps(),
        _ => state.progress.steps as usize,
    };
    let moments = state.trail.len();
    ensure(moments <= steps + 1, || {
        format!("{moments} moments were recorded in {steps} control periods")
    })?;
    for i in 0..2 {
        let range = [task.arm.lower[i], task.arm.upper_limit[i]];
        within("trail", state.trail.iter().map(|q| &q[i]), range)?;
    }
    Ok(())
}
