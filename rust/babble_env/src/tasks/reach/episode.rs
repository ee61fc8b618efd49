//! One episode of reaching.

use babble_body::{ArmState, Pull};
use babble_eye::{Gaze, Pinhole};

use super::case::ReachCase;
use super::movement::{Fidelity, MovementPath};
use super::request::CaseRequest;
use super::state::{ReachState, at};
use super::task::ReachTask;
use crate::episode::clipped;
use crate::error::EnvError;
use crate::executor::Stop;
use crate::noise::{self, Errors};
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::progress::{Lifecycle, Progress};
use crate::stream::Stream;
use crate::task::MAX_TERMS;

/// Distance that the progress reward calls 1 \[m\].
pub(super) const PROGRESS_UNIT_M: f64 = 0.1;

/// What is drawn for a new episode.
#[derive(Debug, Clone, Copy)]
pub struct Drawn {
    case: ReachCase,
    /// Where the eye has found the target.
    gaze: Gaze,
}

/// What the eye sees that stays the same within an episode.
#[derive(Debug, Clone)]
pub struct Sight {
    camera: Pinhole,
    /// The sense `eye`.
    eye: [f32; 2],
    /// The sense `obstacle`.
    obstacle: [f32; 2],
}

impl Sight {
    pub(super) fn new(task: &ReachTask, state: &ReachState) -> Self {
        let (gaze, obstacle) = (state.gaze, state.case.obstacle.as_ref());
        let camera = task.eye.camera(gaze);
        let angles = ReachTask::obstacle_angles(&camera, obstacle);
        Self {
            camera,
            eye: task.eye.normalised(gaze).map(|x| x as f32),
            obstacle: angles.map(|x| x as f32),
        }
    }
}

/// The state before the first reset: the middle posture, with the target at the fingertip.
pub(super) fn fresh(task: &ReachTask, lifecycle: Lifecycle<CaseRequest>) -> ReachState {
    let start = task.arm.denormalised([0.5, 0.5]);
    let hand = task.arm.fingertip(start);
    ReachState {
        arm: ArmState::at_rest(start),
        equilibrium: start,
        case: ReachCase {
            start,
            hand: hand.into(),
            target: hand.into(),
            obstacle: None,
        },
        gaze: task.eye.rest(),
        progress: Progress::START,
        distance: 0.0,
        lifecycle,
        trail: Vec::new(),
    }
}

/// Also lets the eye find the target.
pub(super) fn draw(
    task: &ReachTask,
    request: &CaseRequest,
    stream: &mut Stream,
    stop: &Stop<'_>,
) -> Result<Drawn, EnvError> {
    let case = request.draw(task, stream, stop)?;
    let gaze = task.foveate(&case)?;
    Ok(Drawn { case, gaze })
}

pub(super) fn begin(task: &ReachTask, state: &mut ReachState, drawn: Drawn) {
    let Drawn { case, gaze } = drawn;
    state.distance = case.distance();
    state.arm = ArmState::at_rest(case.start);
    state.equilibrium = case.start;
    state.case = case;
    state.gaze = gaze;
    state.trail.clear();
    if task.options.record {
        state.trail.push(case.start);
    }
}

/// One control step, or one whole movement in `pattern` control.
pub(super) fn advance(
    task: &ReachTask,
    state: &mut ReachState,
    action: &[f32],
) -> Result<bool, EnvError> {
    let action = clipped(action);
    let mut errors = task.config.noise.muscles(&mut state.lifecycle.stream);
    // In the goal form a failure holds the arm where it is until the time limit.
    if !state.progress.outcome.is_failure() {
        state.progress.outcome = match task.options.control {
            Control::Pattern => play(task, state, action, &mut errors)?,
            _ => move_arm(task, state, action, &mut errors),
        };
    } else if task.options.record {
        state.trail.push(state.arm.q);
    }
    state.distance = task.distance(&state.case, state.arm.q);
    Ok(task.is_reached(&state.case, &state.arm))
}

pub(super) fn observe(task: &ReachTask, state: &ReachState, sight: &Sight, out: &mut [f32]) {
    let tip = task.arm.fingertip(state.arm.q);
    let hand = ReachTask::angles(&sight.camera, tip);
    let arm = task.arm.normalised(state.arm.q);
    let limit = f64::from(task.options.max_episode_steps);
    for i in 0..2 {
        out[at::ARM + i] = arm[i] as f32;
        out[at::EYE + i] = sight.eye[i];
        out[at::HAND + i] = hand[i] as f32;
        out[at::OBSTACLE + i] = sight.obstacle[i];
        out[at::STRETCH + i] = (state.equilibrium[i] - state.arm.q[i]) as f32;
    }
    out[at::TIME] = (f64::from(state.progress.steps) / limit).min(1.0) as f32;
    let errors = task.config.noise.senses(&state.lifecycle.stream);
    if !errors.are_none() {
        add_errors(task, state, errors, out);
    }
}

/// The senses' errors.
fn add_errors(task: &ReachTask, state: &ReachState, mut errors: Errors, out: &mut [f32]) {
    let deviations = &task.config.noise;
    let stretch = task.stretch_bounds();
    for (i, error) in errors.angles::<2>(deviations.joint_deg).iter().enumerate() {
        let width = task.arm.upper_limit[i] - task.arm.lower[i];
        noise::add(&mut out[at::ARM + i], error / width, [0.0, 1.0]);
        noise::add(&mut out[at::STRETCH + i], -error, [-stretch[i], stretch[i]]);
    }
    task.add_eye_errors(&mut errors, &mut out[at::EYE..at::EYE + 2]);
    task.add_sight_errors(&mut errors, &mut out[at::HAND..at::HAND + 2]);
    if state.case.obstacle.is_some() {
        task.add_sight_errors(&mut errors, &mut out[at::OBSTACLE..at::OBSTACLE + 2]);
    }
}

/// Positions of fingertip and target \[m\]. Once the arm failed, the first is none that it can take,
/// so that an arm that collided at its target earns nothing.
pub(super) fn goals(task: &ReachTask, state: &ReachState) -> [[f32; 2]; 2] {
    let [tip, target] = task.goals(&state.case, state.arm.q);
    if state.progress.outcome.is_failure() {
        return [task.goal_space().failure(), target];
    }
    [tip, target]
}

fn play(
    task: &ReachTask,
    state: &mut ReachState,
    action: [f64; 2],
    errors: &mut Errors,
) -> Result<Outcome, EnvError> {
    let [low, high] = task.config.reach.b_range;
    let b = action.map(|a| (0.5 + 0.5 * a).clamp(low, high));
    let path = MovementPath::new(task, &state.case, b)?;
    let trail = &mut state.trail;
    let movement = path.play_with(task, &state.case, Fidelity::Full, errors, |arm| {
        if task.options.record {
            trail.push(arm.q);
        }
    });
    state.arm = movement.arm;
    state.equilibrium = path.postures().last().copied().unwrap_or(state.equilibrium);
    // Success and timeout are for the end of the step to tell.
    let failed = movement.outcome.is_failure();
    Ok(if failed {
        movement.outcome
    } else {
        Outcome::Running
    })
}

fn move_arm(
    task: &ReachTask,
    state: &mut ReachState,
    action: [f64; 2],
    errors: &mut Errors,
) -> Outcome {
    let mut watch = task.watch(state.case.obstacle, state.arm.q);
    let muscles = &task.config.body.muscles;
    let touched = if task.options.control == Control::Torque {
        let torque = action.map(|a| a * muscles.torque_max);
        let pull = task.with_torque_errors(torque, errors);
        let touched = task.advance(&mut state.arm, &mut watch, Pull::Torques(pull));
        // The posture whose spring would pull as hard: the muscles' state in this control.
        state.equilibrium = [0, 1].map(|i| state.arm.q[i] + torque[i] / muscles.kp);
        touched
    } else {
        state.equilibrium = if task.options.control == Control::Posture {
            task.arm.denormalised(action.map(|a| 0.5 + 0.5 * a))
        } else {
            let unit = task.config.reach.delta_posture_deg.to_radians();
            task.arm
                .clamp([0, 1].map(|i| state.equilibrium[i] + unit * action[i]))
        };
        let q_des = task.with_errors(state.equilibrium, errors);
        task.advance(&mut state.arm, &mut watch, Pull::Towards(q_des))
    };
    if task.options.record {
        state.trail.push(state.arm.q);
    }
    if touched {
        Outcome::Collision
    } else {
        Outcome::Running
    }
}

pub(super) fn reward_terms(task: &ReachTask, state: &ReachState, before: f64) -> [f64; MAX_TERMS] {
    let success = f64::from(u8::from(state.progress.outcome == Outcome::Success));
    let failure = f64::from(u8::from(state.progress.outcome.is_failure()));
    if task.options.goal {
        let [achieved, desired] = goals(task, state);
        return [task.goal_space().reward(&achieved, &desired), 0.0, 0.0, 0.0];
    }
    match task.options.reward {
        Reward::Progress => [
            (before - state.distance) / PROGRESS_UNIT_M,
            success,
            0.0 - failure,
            0.0,
        ],
        Reward::Sparse => [success, 0.0, 0.0, 0.0],
    }
}
