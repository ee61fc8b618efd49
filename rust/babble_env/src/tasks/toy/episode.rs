//! One episode of the toy task.

use serde::{Deserialize, Serialize};

use super::task::PointTask;
use crate::check::within;
use crate::episode::clipped;
use crate::error::EnvError;
use crate::progress::{Lifecycle, Progress};
use crate::stream::Stream;

/// Distance of a step with an action of 1 \[m\].
const STEP_M: f64 = 0.1;
/// Success within this distance of the target \[m\].
const NEAR_M: f64 = 0.1;

/// What a user asks of the cases to come.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct TargetRequest {
    /// Position of the target \[m\]; sampled if not given.
    pub target: Option<[f64; 2]>,
}

/// Everything that changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointState {
    /// Where the point is \[m\].
    pub position: [f64; 2],
    /// Where it should be \[m\].
    pub target: [f64; 2],
    /// Clock and result.
    pub progress: Progress,
    /// What decides the next episode.
    pub lifecycle: Lifecycle<TargetRequest>,
    /// Recorded positions \[m\].
    pub trail: Vec<[f64; 2]>,
}

pub(super) fn fresh(lifecycle: Lifecycle<TargetRequest>) -> PointState {
    PointState {
        position: [0.0; 2],
        target: [0.0; 2],
        progress: Progress::START,
        lifecycle,
        trail: Vec::new(),
    }
}

pub(super) fn check(state: &PointState) -> Result<(), EnvError> {
    let PointState {
        position,
        target,
        lifecycle,
        trail,
        ..
    } = state;
    let asked = lifecycle.request.target.iter().flatten();
    within("position", position, [-1.0, 1.0])?;
    within("target", target, [-1.0, 1.0])?;
    within("request", asked, [-1.0, 1.0])?;
    within("trail", trail.iter().flatten(), [-1.0, 1.0])
}

pub(super) fn draw(request: &TargetRequest, stream: &mut Stream) -> Result<[f64; 2], EnvError> {
    let outside = |x: &f64| !(-1.0..=1.0).contains(x);
    if let Some(target) = request.target.filter(|target| target.iter().any(outside)) {
        return Err(EnvError::Case {
            what: "target",
            problem: format!("{target:?} m is not in [-1, 1]"),
        });
    }
    let sampled = PointTask::sample(stream);
    Ok(request.target.unwrap_or(sampled))
}

pub(super) fn begin(task: &PointTask, state: &mut PointState, target: [f64; 2]) {
    state.position = [0.0; 2];
    state.target = target;
    state.trail.clear();
    if task.record {
        state.trail.push([0.0; 2]);
    }
}

pub(super) fn advance(task: &PointTask, state: &mut PointState, action: &[f32]) -> bool {
    for (x, velocity) in state.position.iter_mut().zip(clipped::<2>(action)) {
        *x = (*x + STEP_M * velocity).clamp(-1.0, 1.0);
    }
    if task.record {
        state.trail.push(state.position);
    }
    let [dx, dy] = [0, 1].map(|i| state.position[i] - state.target[i]);
    libm::hypot(dx, dy) <= NEAR_M
}

pub(super) fn observe(task: &PointTask, state: &PointState, out: &mut [f32]) {
    for i in 0..2 {
        out[i] = state.position[i] as f32;
        out[2 + i] = state.target[i] as f32;
    }
    out[4] = (f64::from(state.progress.steps) / f64::from(task.max_episode_steps)) as f32;
}
