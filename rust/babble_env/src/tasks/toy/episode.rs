//! One episode of the toy task.

use serde::{Deserialize, Serialize};

use super::task::PointTask;
use crate::check::{age, ensure, within};
use crate::error::EnvError;
use crate::outcome::Outcome;
use crate::stream::Stream;
use crate::task::{Episode, EpisodeInfo, MAX_FACTS, Phase, Step};

/// What is true or false of an episode.
pub(super) const FACTS: [&str; 2] = ["is_success", "ever_success"];
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
    /// Steps since the reset.
    pub steps: u32,
    /// How it stands.
    pub outcome: Outcome,
    /// Whether it can be stepped.
    pub phase: Phase,
    /// The target that the user asked for.
    pub request: TargetRequest,
    /// Random numbers for the cases to come.
    pub stream: Stream,
    /// Recorded positions \[m\].
    pub trail: Vec<[f64; 2]>,
}

/// One episode.
#[derive(Debug, Clone)]
pub struct Point {
    state: PointState,
    asked: Option<TargetRequest>,
}

impl Episode for Point {
    type Task = PointTask;
    type Request = TargetRequest;
    type NextEpisode = PointState;
    type State = PointState;

    fn new(task: &PointTask, stream: Stream) -> Self {
        let state = PointState {
            position: [0.0; 2],
            target: [0.0; 2],
            steps: 0,
            outcome: Outcome::Running,
            phase: Phase::Fresh,
            request: TargetRequest::default(),
            stream,
            trail: Vec::new(),
        };
        Self::from_state(task, state)
    }

    fn check(task: &PointTask, state: &mut PointState) -> Result<(), EnvError> {
        age(state.phase, state.steps, task.max_episode_steps)?;
        let known = [Outcome::Running, Outcome::Success, Outcome::Timeout];
        ensure(known.contains(&state.outcome), || {
            format!("outcome {} is none of this task", state.outcome)
        })?;
        within("position", &state.position, [-1.0, 1.0])?;
        within("target", &state.target, [-1.0, 1.0])?;
        within(
            "request",
            state.request.target.iter().flatten(),
            [-1.0, 1.0],
        )?;
        within("trail", state.trail.iter().flatten(), [-1.0, 1.0])?;
        ensure(state.stream.moves(), || "stream stands still".to_owned())
    }

    fn from_state(_: &PointTask, state: PointState) -> Self {
        Self { state, asked: None }
    }

    fn state(&self) -> &PointState {
        &self.state
    }

    fn phase(&self) -> Phase {
        self.state.phase
    }

    fn seed(&mut self, stream: Stream) {
        self.state.stream = stream;
    }

    fn request(&mut self, request: TargetRequest) {
        self.asked = Some(request);
    }

    fn draw(&mut self, task: &PointTask) -> Result<PointState, EnvError> {
        let request = self.asked.take().unwrap_or(self.state.request);
        let outside = |x: &f64| !(-1.0..=1.0).contains(x);
        if let Some(target) = request.target.filter(|target| target.iter().any(outside)) {
            return Err(EnvError::Case {
                what: "target",
                problem: format!("{target:?} m is not in [-1, 1]"),
            });
        }
        let mut stream = self.state.stream.clone();
        let sampled = PointTask::sample(&mut stream);
        let mut trail = Vec::new();
        if task.record {
            trail.push([0.0; 2]);
        }
        Ok(PointState {
            position: [0.0; 2],
            target: request.target.unwrap_or(sampled),
            steps: 0,
            outcome: Outcome::Running,
            phase: Phase::Running,
            request,
            stream,
            trail,
        })
    }

    fn begin(&mut self, _: &PointTask, drawn: PointState) {
        self.state = drawn;
    }

    fn abandon(&mut self) {
        self.state.phase = Phase::Fresh;
    }

    fn step(&mut self, task: &PointTask, action: &[f32]) -> Result<Step, EnvError> {
        let state = &mut self.state;
        if state.phase != Phase::Running {
            return Err(EnvError::NeedsReset { env: 0 });
        }
        state.steps += 1;
        for (x, &velocity) in state.position.iter_mut().zip(action) {
            *x = (*x + STEP_M * f64::from(velocity).clamp(-1.0, 1.0)).clamp(-1.0, 1.0);
        }
        if task.record {
            state.trail.push(state.position);
        }
        let [dx, dy] = [0, 1].map(|i| state.position[i] - state.target[i]);
        let terminated = libm::hypot(dx, dy) <= NEAR_M;
        let truncated = !terminated && state.steps >= task.max_episode_steps;
        if terminated {
            state.outcome = Outcome::Success;
        } else if truncated {
            state.outcome = Outcome::Timeout;
        }
        if terminated || truncated {
            state.phase = Phase::Ended;
        }
        let reward = f64::from(u8::from(terminated));
        Ok(Step {
            reward,
            terms: [reward, 0.0, 0.0, 0.0],
            terminated,
            truncated,
        })
    }

    fn observe(&self, task: &PointTask, out: &mut [f32]) {
        let state = &self.state;
        for i in 0..2 {
            out[i] = state.position[i] as f32;
            out[2 + i] = state.target[i] as f32;
        }
        out[4] = (f64::from(state.steps) / f64::from(task.max_episode_steps)) as f32;
    }

    fn info(&self, _: &PointTask) -> EpisodeInfo {
        let mut facts = [false; MAX_FACTS];
        facts[..2].fill(self.state.outcome == Outcome::Success);
        EpisodeInfo {
            achieved: self.state.position.map(|x| x as f32),
            desired: self.state.target.map(|x| x as f32),
            outcome: self.state.outcome,
            facts,
        }
    }
}
