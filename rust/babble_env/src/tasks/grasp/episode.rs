//! One episode of grasping.

use babble_body::robot::{MuscleCommand, MuscleCommands, Posture, Touch, towards};

use super::case::{GraspCase, GraspRequest};
use super::check;
use super::enclosure::{Contacts, Enclosure, Grip};
use super::sight::{self, FOVEA_NEURONS};
use super::state::{FACTS, GraspState, Moment, setup};
use super::task::GraspTask;
use crate::config::Config;
use crate::episode::Ending;
use crate::error::EnvError;
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::stream::Stream;
use crate::task::{self, Episode, EpisodeInfo, MAX_FACTS, MAX_TERMS, Phase, Step};

/// Distance that the progress reward calls 1 \[m\].
const PROGRESS_UNIT_M: f64 = 0.1;
/// An object this far below the arm's plane was dropped \[m\].
const DROPPED_M: f64 = 0.1;

/// One episode: its state and what follows from it.
#[derive(Debug, Clone)]
pub struct Grasp {
    state: GraspState,
    fovea: Box<[f32; FOVEA_NEURONS]>,
    /// What the user asks of the cases from the next reset on, if it can be played.
    asked: Option<GraspRequest>,
}

/// A new episode that was drawn and not begun yet.
#[derive(Debug)]
pub struct NextEpisode {
    case: GraspCase,
    request: GraspRequest,
    stream: Stream,
}

/// What the physics steps of one control period gave.
#[derive(Default)]
struct Period {
    forces: [f64; 3],
    contacts: Contacts,
    collision: bool,
}

impl Period {
    fn add(&mut self, touch: &Touch) {
        for (sum, force) in self
            .forces
            .iter_mut()
            .zip([touch.palm, touch.thumb, touch.fingers])
        {
            *sum += force;
        }
        let (fingers, opposite) = (touch.fingers > 0.0, touch.thumb > 0.0 || touch.palm > 0.0);
        self.contacts.fingers += u8::from(fingers);
        self.contacts.opposite += u8::from(opposite);
        self.contacts.enclosing += u8::from(fingers && opposite);
        self.collision |= touch.obstacle;
    }
}

impl Episode for Grasp {
    type Task = GraspTask;
    type Request = GraspRequest;
    type NextEpisode = NextEpisode;
    type State = GraspState;

    fn new(task: &GraspTask, stream: Stream) -> Self {
        let start = task.arm.denormalised([0.5, 0.5]);
        let case = GraspCase {
            start,
            object: [0.0, task.arm.length()],
            diameter: task.config.grasp.diameters_m[0],
            goal: None,
            obstacle: None,
        };
        let mut state = fresh(task, case, GraspRequest::default(), stream);
        state.phase = Phase::Fresh;
        Self::from_state(task, state)
    }

    fn check(task: &GraspTask, state: &mut GraspState) -> Result<(), EnvError> {
        check::check(task, state)
    }

    fn from_state(task: &GraspTask, state: GraspState) -> Self {
        let mut episode = Self {
            state,
            fovea: Box::new([0.0; FOVEA_NEURONS]),
            asked: None,
        };
        let scene = sight::scene(task, &episode.state.world, &episode.state.case);
        sight::look(task, &scene, episode.state.gaze, &mut episode.fovea);
        episode
    }

    fn state(&self) -> &GraspState {
        &self.state
    }

    fn phase(&self) -> Phase {
        self.state.phase
    }

    fn seed(&mut self, stream: Stream) {
        self.state.stream = stream;
    }

    fn request(&mut self, request: GraspRequest) {
        self.asked = Some(request);
    }

    fn draw(&mut self, task: &GraspTask) -> Result<NextEpisode, EnvError> {
        let request = self.asked.take().unwrap_or(self.state.request);
        let mut stream = self.state.stream.clone();
        Ok(NextEpisode {
            case: request.draw(task, &mut stream)?,
            request,
            stream,
        })
    }

    fn begin(&mut self, task: &GraspTask, drawn: NextEpisode) {
        let NextEpisode {
            case,
            request,
            stream,
        } = drawn;
        self.state = fresh(task, case, request, stream);
        let scene = sight::scene(task, &self.state.world, &case);
        self.state.gaze = sight::foveate(task, &scene);
        sight::look(task, &scene, self.state.gaze, &mut self.fovea);
        self.state.record(task);
    }

    fn abandon(&mut self) {
        self.state.phase = Phase::Fresh;
    }

    fn step(&mut self, task: &GraspTask, action: &[f32]) -> Result<Step, EnvError> {
        if self.state.phase != Phase::Running {
            return Err(EnvError::NeedsReset { env: 0 });
        }
        let action = std::array::from_fn(|i| f64::from(action[i]).clamp(-1.0, 1.0));
        let before = self.state.potential(task);
        // In the goal form a failure leaves everything as it is until the time limit.
        if !self.state.failed() {
            self.state.advance(task, action);
            let scene = sight::scene(task, &self.state.world, &self.state.case);
            self.state.gaze = sight::follow(task, &scene, self.state.gaze);
            sight::look(task, &scene, self.state.gaze, &mut self.fovea);
        }
        self.state.record(task);
        Ok(self.state.judge(task, before))
    }

    fn observe(&self, task: &GraspTask, out: &mut [f32]) {
        let state = &self.state;
        let (eye, out) = out.split_at_mut(2);
        let gaze = task.eye.normalised(state.gaze);
        eye.copy_from_slice(&gaze.map(|x| x as f32));
        let (fovea, out) = out.split_at_mut(FOVEA_NEURONS);
        fovea.copy_from_slice(&*self.fovea);
        let posture = task.robot.posture(&state.world);
        let shares = task.robot.normalised(posture);
        let stretch = task.stretch_bounds();
        let most = task.config.grasp.touch_max_n;
        let limit = f64::from(task.options.max_episode_steps);
        for i in 0..4 {
            out[i] = shares[i].clamp(0.0, 1.0) as f32;
            out[4 + i] = (state.equilibrium[i] - posture[i]).clamp(-stretch[i], stretch[i]) as f32;
        }
        for (out, force) in out[8..11].iter_mut().zip(state.touch) {
            *out = (force / most).min(1.0) as f32;
        }
        out[11] = (f64::from(state.steps) / limit).min(1.0) as f32;
    }

    fn info(&self, task: &GraspTask) -> EpisodeInfo {
        let state = &self.state;
        let mut facts = [false; MAX_FACTS];
        facts[..FACTS.len()].copy_from_slice(&[
            state.is_success,
            state.ever_success,
            state.reach,
            state.palm_reach,
            state.enclosure.grip == Grip::Held,
        ]);
        EpisodeInfo {
            achieved: state.achieved(task),
            desired: state.desired(),
            outcome: state.outcome,
            facts,
        }
    }
}

/// The state at the beginning of an episode; the eye has not turned yet.
fn fresh(task: &GraspTask, case: GraspCase, request: GraspRequest, stream: Stream) -> GraspState {
    let begin = setup(task, &case);
    let mut state = GraspState {
        world: task.robot.world(&begin),
        equilibrium: begin.posture,
        case,
        gaze: task.eye.rest(),
        touch: [0.0; 3],
        enclosure: Enclosure::default(),
        reflex: false,
        steps: 0,
        outcome: Outcome::Running,
        is_success: false,
        ever_success: false,
        reach: false,
        palm_reach: false,
        distance: 0.0,
        phase: Phase::Running,
        request,
        stream,
        trail: Vec::new(),
    };
    state.distance = task.pocket_offset(&state.world, case.radius()).norm();
    state
}

/// What the progress reward is the change of.
#[derive(Clone, Copy)]
struct Potential {
    distance: f64,
    enclosure: f64,
}

impl GraspState {
    /// One control period of physics.
    fn advance(&mut self, task: &GraspTask, action: [f64; 4]) {
        let asked = self.drive(task, action);
        let mut period = Period::default();
        for _ in 0..task.config.grasp.physics_steps {
            let drive = self.with_reflex(task, asked);
            task.robot.step(&mut self.world, &drive);
            let touch = task.robot.touch(&self.world);
            period.add(&touch);
            self.reach |= touch.any();
            self.palm_reach |= touch.palm > 0.0;
            self.reflex |= task.options.enclosure_reflex && touch.palm > 0.0;
            if period.collision {
                break;
            }
        }
        let steps = f64::from(task.config.grasp.physics_steps);
        self.touch = period.forces.map(|sum| sum / steps);
        self.distance = task.pocket_offset(&self.world, self.case.radius()).norm();
        self.outcome = if period.collision {
            Outcome::Collision
        } else {
            self.follow_grip(task, period.contacts)
        };
    }

    /// What an action asks of the muscles, and the equilibrium points that it leaves.
    fn drive(&mut self, task: &GraspTask, action: [f64; 4]) -> MuscleCommands {
        match task.options.control {
            Control::Torque => {
                let muscles = task.muscles();
                let torques: Posture = std::array::from_fn(|i| action[i] * muscles[i].torque_max);
                let posture = task.robot.posture(&self.world);
                // The posture whose springs would pull as hard.
                self.equilibrium = std::array::from_fn(|i| posture[i] + torques[i] / muscles[i].kp);
                torques.map(MuscleCommand::Torque)
            }
            Control::Posture => {
                let share = action.map(|a| 0.5 + 0.5 * a);
                self.equilibrium = task.robot.denormalised(share);
                towards(self.equilibrium)
            }
            Control::DeltaPosture | Control::Pattern => {
                let unit = task.config.grasp.delta_posture_deg.to_radians();
                let moved = std::array::from_fn(|i| self.equilibrium[i] + unit * action[i]);
                self.equilibrium = task.robot.clamp(moved);
                towards(self.equilibrium)
            }
        }
    }

    /// The enclosure reflex in place of what the action asks of the hand.
    fn with_reflex(&mut self, task: &GraspTask, asked: MuscleCommands) -> MuscleCommands {
        if !self.reflex {
            return asked;
        }
        let [thumb, finger] = task.reflex();
        self.equilibrium[2..].copy_from_slice(&[thumb, finger]);
        let [shoulder, elbow, ..] = asked;
        [
            shoulder,
            elbow,
            MuscleCommand::EquilibriumPoint(thumb),
            MuscleCommand::EquilibriumPoint(finger),
        ]
    }

    /// Takes the support away once the object is enclosed, and sees whether the hand keeps it.
    fn follow_grip(&mut self, task: &GraspTask, contacts: Contacts) -> Outcome {
        let numbers = &task.config.grasp;
        let in_hand = task.in_hand(&self.world, self.case.radius());
        if self.enclosure.step(numbers, contacts, in_hand) {
            task.robot.remove_support(&mut self.world);
        }
        let centre = task.robot.object(&self.world);
        let away = centre.xy().norm() > task.arm.length() + self.case.radius();
        if self.enclosure.grip == Grip::Failed || away || centre.z < -DROPPED_M {
            Outcome::Lost
        } else {
            Outcome::Running
        }
    }

    fn potential(&self, task: &GraspTask) -> Potential {
        Potential {
            distance: self.distance,
            enclosure: self.enclosure.share(&task.config.grasp),
        }
    }

    fn failed(&self) -> bool {
        matches!(self.outcome, Outcome::Collision | Outcome::Lost)
    }

    /// Success, reward and end of the step just made.
    fn judge(&mut self, task: &GraspTask, before: Potential) -> Step {
        let done = if task.options.goal {
            goal_reward(&task.config, self.achieved(task), self.desired()) == 0.0
        } else {
            self.enclosure.grip == Grip::Held
        };
        let ending = Ending {
            goal: task.options.goal,
            single_step: false,
            max_steps: task.options.max_episode_steps,
        };
        let [terminated, truncated] = ending.conclude(self.progress(), done);
        let terms = self.reward_terms(task, before);
        Step {
            reward: terms.iter().sum(),
            terms,
            terminated,
            truncated,
        }
    }

    fn reward_terms(&self, task: &GraspTask, before: Potential) -> [f64; MAX_TERMS] {
        let mut terms = [0.0; MAX_TERMS];
        if task.options.goal {
            terms[0] = goal_reward(&task.config, self.achieved(task), self.desired());
            return terms;
        }
        let success = f64::from(u8::from(self.outcome == Outcome::Success));
        match task.options.reward {
            Reward::Sparse => terms[0] = success,
            Reward::Progress => {
                let now = self.potential(task);
                terms = [
                    (before.distance - now.distance) / PROGRESS_UNIT_M,
                    now.enclosure - before.enclosure,
                    success,
                    0.0 - f64::from(u8::from(self.failed())),
                ];
            }
        }
        terms
    }

    /// Where the object is; once it failed to be carried, beyond all goals, so that an object dropped
    /// at its goal earns nothing.
    fn achieved(&self, task: &GraspTask) -> [f32; 2] {
        let reach = task.goal_bound() as f32;
        if task.options.goal && self.failed() {
            return [reach; 2];
        }
        let centre = task.robot.object(&self.world);
        [centre.x, centre.y].map(|x| (x as f32).clamp(-reach, reach))
    }

    fn desired(&self) -> [f32; 2] {
        self.case.goal.unwrap_or(self.case.object).map(|x| x as f32)
    }

    fn record(&mut self, task: &GraspTask) {
        if !task.options.record {
            return;
        }
        let palm = task.robot.palm(&self.world).origin;
        let object = task.robot.object(&self.world);
        self.trail.push(Moment {
            joints: task.robot.joint_angles(&self.world).to_vec(),
            object: object.into(),
            palm: [palm.x, palm.y],
            gaze: self.gaze,
        });
    }
}

/// Reward of the goal form, from positions alone \[m\]: 0 within the success radius, else −1.
///
/// Positions are compared as the f32 numbers that an agent stores.
#[must_use]
pub fn goal_reward(config: &Config, achieved: [f32; 2], desired: [f32; 2]) -> f64 {
    task::goal_reward(config.grasp.success_radius_m, achieved, desired)
}
