//! One episode of reaching.

use babble_body::{ArmState, Obstacle};
use babble_eye::{Gaze, Pinhole};

use super::case::ReachCase;
use super::check;
use super::movement::{Fidelity, MovementPath};
use super::request::CaseRequest;
use super::state::{EVER_SUCCESS, IS_SUCCESS, ReachState};
use super::task::ReachTask;
use crate::config::Config;
use crate::episode::Ending;
use crate::error::EnvError;
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::stream::Stream;
use crate::task::{self, Episode, EpisodeInfo, MAX_FACTS, MAX_TERMS, Phase, Step};

/// Distance that the progress reward calls 1 \[m\].
const PROGRESS_UNIT_M: f64 = 0.1;

/// One episode: its state and what follows from it.
#[derive(Debug, Clone)]
pub struct Reach {
    state: ReachState,
    sight: Sight,
    /// What the user asks of the cases from the next reset on, if it can be played.
    asked: Option<CaseRequest>,
}

/// A new episode that was drawn and not begun yet.
#[derive(Debug, Clone)]
pub struct NextEpisode {
    case: ReachCase,
    gaze: Gaze,
    request: CaseRequest,
    stream: Stream,
}

/// What the eye sees that stays the same within an episode.
#[derive(Debug, Clone)]
struct Sight {
    camera: Pinhole,
    /// Senses `eye` and `obstacle`.
    senses: [f32; 4],
}

impl Sight {
    fn new(task: &ReachTask, gaze: Gaze, obstacle: Option<&Obstacle>) -> Self {
        let camera = task.eye.camera(gaze);
        let eye = task.eye.normalised(gaze);
        let angles = ReachTask::obstacle_angles(&camera, obstacle);
        Self {
            camera,
            senses: [eye[0], eye[1], angles[0], angles[1]].map(|x| x as f32),
        }
    }
}

impl Episode for Reach {
    type Task = ReachTask;
    type Request = CaseRequest;
    type NextEpisode = NextEpisode;
    type State = ReachState;

    fn new(task: &ReachTask, stream: Stream) -> Self {
        let start = task.arm.denormalised([0.5, 0.5]);
        let hand = task.arm.fingertip(start);
        let case = ReachCase {
            start,
            hand: hand.into(),
            target: hand.into(),
            obstacle: None,
        };
        let gaze = task.eye.rest();
        let state = ReachState {
            arm: ArmState::at_rest(start),
            equilibrium: start,
            case,
            gaze,
            steps: 0,
            outcome: Outcome::Running,
            is_success: false,
            ever_success: false,
            distance: 0.0,
            phase: Phase::Fresh,
            request: CaseRequest::default(),
            stream,
            trail: Vec::new(),
        };
        Self {
            sight: Sight::new(task, gaze, None),
            state,
            asked: None,
        }
    }

    fn check(task: &ReachTask, state: &mut ReachState) -> Result<(), EnvError> {
        check::check(task, state)
    }

    fn from_state(task: &ReachTask, state: ReachState) -> Self {
        Self {
            sight: Sight::new(task, state.gaze, state.case.obstacle.as_ref()),
            state,
            asked: None,
        }
    }

    fn state(&self) -> &ReachState {
        &self.state
    }

    fn phase(&self) -> Phase {
        self.state.phase
    }

    fn seed(&mut self, stream: Stream) {
        self.state.stream = stream;
    }

    fn request(&mut self, request: CaseRequest) {
        self.asked = Some(request);
    }

    /// Also lets the eye find the target.
    fn draw(&mut self, task: &ReachTask) -> Result<NextEpisode, EnvError> {
        let request = self.asked.take().unwrap_or(self.state.request);
        let mut stream = self.state.stream.clone();
        let case = request.draw(task, &mut stream)?;
        Ok(NextEpisode {
            gaze: task.foveate(&case)?,
            case,
            request,
            stream,
        })
    }

    fn begin(&mut self, task: &ReachTask, drawn: NextEpisode) {
        let NextEpisode {
            case,
            gaze,
            request,
            stream,
        } = drawn;
        self.sight = Sight::new(task, gaze, case.obstacle.as_ref());
        let state = &mut self.state;
        state.request = request;
        state.stream = stream;
        state.distance = case.distance();
        state.arm = ArmState::at_rest(case.start);
        state.equilibrium = case.start;
        state.case = case;
        state.gaze = gaze;
        state.steps = 0;
        state.outcome = Outcome::Running;
        state.is_success = false;
        state.ever_success = false;
        state.phase = Phase::Running;
        state.trail.clear();
        if task.options.record {
            state.trail.push(case.start);
        }
    }

    fn abandon(&mut self) {
        self.state.phase = Phase::Fresh;
    }

    /// One control step, or one whole movement in `pattern` control.
    fn step(&mut self, task: &ReachTask, action: &[f32]) -> Result<Step, EnvError> {
        if self.state.phase != Phase::Running {
            return Err(EnvError::NeedsReset { env: 0 });
        }
        let action = [0, 1].map(|i| f64::from(action[i]).clamp(-1.0, 1.0));
        let before = self.state.distance;
        // In the goal form a collision holds the arm where it is until the time limit.
        if self.state.outcome != Outcome::Collision {
            self.state.outcome = match task.options.control {
                Control::Pattern => self.play(task, action)?,
                _ => self.move_arm(task, action),
            };
        } else if task.options.record {
            self.state.trail.push(self.state.arm.q);
        }
        Ok(self.judge(task, before))
    }

    fn observe(&self, task: &ReachTask, out: &mut [f32]) {
        let state = &self.state;
        let tip = task.arm.fingertip(state.arm.q);
        let hand = ReachTask::angles(&self.sight.camera, tip);
        let arm = task.arm.normalised(state.arm.q);
        out[..4].copy_from_slice(&self.sight.senses);
        for i in 0..2 {
            out[4 + i] = hand[i] as f32;
            out[6 + i] = arm[i] as f32;
            out[8 + i] = (state.equilibrium[i] - state.arm.q[i]) as f32;
        }
        out[10] =
            (f64::from(state.steps) / f64::from(task.options.max_episode_steps)).min(1.0) as f32;
    }

    fn info(&self, task: &ReachTask) -> EpisodeInfo {
        let state = &self.state;
        let tip: [f64; 2] = task.arm.fingertip(state.arm.q).into();
        let mut facts = [false; MAX_FACTS];
        facts[IS_SUCCESS] = state.is_success;
        facts[EVER_SUCCESS] = state.ever_success;
        EpisodeInfo {
            achieved: tip.map(|x| x as f32),
            desired: state.case.target.map(|x| x as f32),
            outcome: state.outcome,
            facts,
        }
    }
}

impl Reach {
    fn play(&mut self, task: &ReachTask, action: [f64; 2]) -> Result<Outcome, EnvError> {
        let [low, high] = task.config.reach.b_range;
        let b = action.map(|a| (0.5 + 0.5 * a).clamp(low, high));
        let state = &mut self.state;
        let path = MovementPath::new(task, &state.case, b)?;
        let trail = &mut state.trail;
        let movement = path.play(task, &state.case, Fidelity::Full, |arm| {
            if task.options.record {
                trail.push(arm.q);
            }
        });
        state.arm = movement.arm;
        state.equilibrium = path.postures().last().copied().unwrap_or(state.equilibrium);
        Ok(movement.outcome)
    }

    fn move_arm(&mut self, task: &ReachTask, action: [f64; 2]) -> Outcome {
        let state = &mut self.state;
        let mut watch = task.watch(state.case.obstacle, state.arm.q);
        let muscles = &task.config.body.muscles;
        let touched = if task.options.control == Control::Torque {
            let torque = action.map(|a| a * muscles.torque_max);
            let touched = task.advance(&mut state.arm, &mut watch, |arm, dt| {
                task.dynamics.step_torque(arm, torque, dt)
            });
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
            let q_des = state.equilibrium;
            task.advance(&mut state.arm, &mut watch, |arm, dt| {
                task.dynamics.step(arm, q_des, dt)
            })
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

    /// Success, reward and end of the step just made.
    fn judge(&mut self, task: &ReachTask, before: f64) -> Step {
        let state = &mut self.state;
        state.distance = task.distance(&state.case, state.arm.q);
        let fastest = task.config.reach.settled_speed_rad_s;
        let rested = state.arm.v.iter().all(|v| v.abs() < fastest);
        let at_target = if task.options.goal {
            goal_reached(task, state)
        } else {
            state.distance <= task.config.reach.success_radius_m
                && (rested || !task.options.settled)
        };
        let ending = Ending {
            goal: task.options.goal,
            single_step: task.options.control == Control::Pattern,
            max_steps: task.options.max_episode_steps,
        };
        let [terminated, truncated] = ending.conclude(state.progress(), at_target);
        let terms = reward_terms(task, before, state);
        Step {
            reward: terms.iter().sum(),
            terms,
            terminated,
            truncated,
        }
    }
}

/// Reward of the goal form, from positions alone \[m\]: 0 within the success radius, else −1.
///
/// Positions are compared as the f32 numbers that an agent stores.
#[must_use]
pub fn goal_reward(config: &Config, achieved: [f32; 2], desired: [f32; 2]) -> f64 {
    task::goal_reward(config.reach.success_radius_m, achieved, desired)
}

fn goal_reached(task: &ReachTask, state: &ReachState) -> bool {
    let achieved: [f64; 2] = task.arm.fingertip(state.arm.q).into();
    let single = |point: [f64; 2]| point.map(|x| x as f32);
    goal_reward(&task.config, single(achieved), single(state.case.target)) == 0.0
}

fn reward_terms(task: &ReachTask, before: f64, state: &ReachState) -> [f64; MAX_TERMS] {
    let success = f64::from(u8::from(state.outcome == Outcome::Success));
    let failure = f64::from(u8::from(matches!(
        state.outcome,
        Outcome::Collision | Outcome::JointLimit
    )));
    if task.options.goal {
        let term = if goal_reached(task, state) { 0.0 } else { -1.0 };
        return [term, 0.0, 0.0, 0.0];
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
