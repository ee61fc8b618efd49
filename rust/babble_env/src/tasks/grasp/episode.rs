//! One episode of grasping.

use babble_body::robot::{MuscleCommand, MuscleCommands, Posture, Touch, towards};

use super::case::{GraspCase, GraspRequest};
use super::enclosure::{Contacts, Enclosure, Grip};
use super::sight::{self, FOVEA_NEURONS};
use super::state::{GraspState, Moment, at, setup};
use super::task::GraspTask;
use crate::episode::clipped;
use crate::noise::{self, Errors};
use crate::options::{Control, Reward};
use crate::outcome::Outcome;
use crate::progress::{Lifecycle, Progress};
use crate::task::MAX_TERMS;

/// Distance that the progress reward calls 1 \[m\].
pub(super) const PROGRESS_UNIT_M: f64 = 0.1;
/// An object this far below the arm's plane was dropped \[m\].
pub(super) const DROPPED_M: f64 = 0.1;

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
        self.contacts.add(touch);
        self.collision |= touch.collision;
    }
}

/// The state before the first reset: the middle posture, with the object far off.
pub(super) fn fresh(task: &GraspTask, lifecycle: Lifecycle<GraspRequest>) -> GraspState {
    let case = GraspCase {
        start: task.arm.denormalised([0.5, 0.5]),
        object: [0.0, task.arm.length()],
        diameter: task.config.grasp.diameters_m[0],
        goal: None,
        obstacle: None,
    };
    at_start(task, case, lifecycle)
}

pub(super) fn begin(task: &GraspTask, state: &mut GraspState, case: GraspCase) {
    *state = at_start(task, case, state.lifecycle.clone());
    let scene = sight::scene(task, &state.world, &case);
    (state.gaze, state.in_sight) = sight::foveate(task, &scene);
    state.record(task);
}

/// The edges in the fovea.
pub(super) fn look(task: &GraspTask, state: &GraspState) -> Box<[f32; FOVEA_NEURONS]> {
    let mut fovea = Box::new([0.0; FOVEA_NEURONS]);
    let scene = sight::scene(task, &state.world, &state.case);
    sight::look(task, &scene, state.gaze, &mut fovea);
    fovea
}

/// One control step, and the eye after it.
pub(super) fn advance(
    task: &GraspTask,
    state: &mut GraspState,
    edges: &mut [f32; FOVEA_NEURONS],
    action: &[f32],
) -> bool {
    // In the goal form a failure leaves everything as it is until the time limit.
    if !state.progress.outcome.is_failure() {
        let errors = task.config.noise.muscles(&mut state.lifecycle.stream);
        state.advance(task, clipped(action), errors);
        let scene = sight::scene(task, &state.world, &state.case);
        let seen = task.eye.reflex_step(&scene, state.gaze);
        state.in_sight = seen.is_some();
        // Where no red is seen the eye stays as it is.
        state.gaze = seen.unwrap_or(state.gaze);
        sight::look(task, &scene, state.gaze, edges);
    }
    state.record(task);
    if task.options.goal {
        state.goal_reward(task) == 0.0
    } else {
        state.enclosure.grip == Grip::Held
    }
}

pub(super) fn observe(
    task: &GraspTask,
    state: &GraspState,
    edges: &[f32; FOVEA_NEURONS],
    out: &mut [f32],
) {
    let gaze = task.eye.normalised(state.gaze);
    out[at::EYE..at::FOVEA].copy_from_slice(&gaze.map(|x| x as f32));
    out[at::FOVEA..at::HAND].copy_from_slice(edges);
    let posture = task.robot.posture(&state.world);
    let shares = task.robot.normalised(posture);
    let stretch = task.stretch_bounds();
    let most = task.config.grasp.touch_max_n;
    let limit = f64::from(task.options.max_episode_steps);
    for (i, at) in [at::ARM, at::ARM + 1, at::HAND, at::HAND + 1]
        .into_iter()
        .enumerate()
    {
        out[at] = shares[i].clamp(0.0, 1.0) as f32;
        out[at::STRETCH + i] =
            (state.equilibrium[i] - posture[i]).clamp(-stretch[i], stretch[i]) as f32;
    }
    out[at::TIME] = (f64::from(state.progress.steps) / limit).min(1.0) as f32;
    let arm = task
        .options
        .arm_touch
        .then(|| task.robot.arm_touch(&state.world));
    let forces = state.touch.into_iter().chain(arm.into_iter().flatten());
    for (out, force) in out[at::TOUCH..].iter_mut().zip(forces) {
        *out = (force / most).min(1.0) as f32;
    }
    let errors = task.config.noise.senses(&state.lifecycle.stream);
    if !errors.are_none() {
        add_errors(task, errors, out);
    }
}

/// The senses' errors.
fn add_errors(task: &GraspTask, mut errors: Errors, out: &mut [f32]) {
    let deviations = &task.config.noise;
    let (ranges, stretch) = (task.robot.ranges(), task.stretch_bounds());
    let felt: [f64; 4] = errors.angles(deviations.joint_deg);
    for (i, at) in [at::ARM, at::ARM + 1, at::HAND, at::HAND + 1]
        .into_iter()
        .enumerate()
    {
        let [low, high] = ranges[i];
        noise::add(&mut out[at], felt[i] / (high - low), [0.0, 1.0]);
        noise::add(
            &mut out[at::STRETCH + i],
            -felt[i],
            [-stretch[i], stretch[i]],
        );
    }
    for (i, [low, high]) in task.eye.ranges().into_iter().enumerate() {
        let [error] = errors.angles(deviations.eye_deg);
        noise::add(&mut out[at::EYE + i], error / (high - low), [0.0, 1.0]);
    }
    for edge in &mut out[at::FOVEA..at::HAND] {
        noise::add(edge, errors.next(deviations.fovea), [0.0, 1.0]);
    }
    for force in &mut out[at::TOUCH..] {
        let error = errors.next(deviations.touch_n) / task.config.grasp.touch_max_n;
        noise::add(force, error, [0.0, 1.0]);
    }
}

/// The state at the beginning of an episode; the eye has not turned yet.
fn at_start(task: &GraspTask, case: GraspCase, lifecycle: Lifecycle<GraspRequest>) -> GraspState {
    let begin = setup(task, &case);
    let world = task.robot.world(&begin);
    GraspState {
        distance: task.pocket_offset(&world, case.radius()).norm(),
        world,
        equilibrium: begin.posture,
        case,
        gaze: task.eye.rest(),
        in_sight: false,
        touch: [0.0; 3],
        enclosure: Enclosure::default(),
        reflex: false,
        progress: Progress::START,
        reach: false,
        palm_reach: false,
        lifecycle,
        trail: Vec::new(),
    }
}

/// What the progress reward is the change of.
#[derive(Debug, Clone, Copy)]
pub struct Potential {
    distance: f64,
    enclosure: f64,
}

impl GraspState {
    /// One control period of physics.
    fn advance(&mut self, task: &GraspTask, action: [f64; 4], mut errors: Errors) {
        let asked = self.drive(task, action);
        let released = task.options.reflex_releases && self.opens_hand(task, action);
        self.reflex &= !released;
        let errors = errors.angles(task.config.noise.motor_deg);
        let mut period = Period::default();
        for _ in 0..task.config.grasp.physics_steps {
            let drive = task.with_errors(self.with_reflex(task, asked), errors);
            task.robot.step(&mut self.world, &drive);
            let touch = task.robot.touch(&self.world);
            period.add(&touch);
            self.reach |= touch.any();
            self.palm_reach |= touch.palm > 0.0;
            self.reflex |= task.options.enclosure_reflex && touch.palm > 0.0 && !released;
            if period.collision {
                break;
            }
        }
        let steps = f64::from(task.config.grasp.physics_steps);
        self.touch = period.forces.map(|sum| sum / steps);
        self.distance = task.pocket_offset(&self.world, self.case.radius()).norm();
        self.progress.outcome = if period.collision {
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

    /// Whether an action, whose equilibrium points are set, opens the hand: in `posture` control both
    /// thumb and finger are asked to flex less than they do, in the others both are moved or pulled open.
    fn opens_hand(&self, task: &GraspTask, action: [f64; 4]) -> bool {
        match task.options.control {
            Control::Posture => {
                let posture = task.robot.posture(&self.world);
                self.equilibrium[2] < posture[2] && self.equilibrium[3] < posture[3]
            }
            _ => action[2] < 0.0 && action[3] < 0.0,
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
        let tried = self.enclosure.step(numbers, contacts, in_hand);
        if task.options.support_stays {
            self.enclosure.try_again(numbers);
        } else if tried {
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

    pub(super) fn potential(&self, task: &GraspTask) -> Potential {
        Potential {
            distance: self.distance,
            enclosure: self.enclosure.share(&task.config.grasp),
        }
    }

    pub(super) fn reward_terms(&self, task: &GraspTask, before: Potential) -> [f64; MAX_TERMS] {
        let mut terms = [0.0; MAX_TERMS];
        if task.options.goal {
            terms[0] = self.goal_reward(task);
            return terms;
        }
        let success = f64::from(u8::from(self.progress.outcome == Outcome::Success));
        match task.options.reward {
            Reward::Sparse => terms[0] = success,
            Reward::Progress => {
                let now = self.potential(task);
                terms = [
                    (before.distance - now.distance) / PROGRESS_UNIT_M,
                    now.enclosure - before.enclosure,
                    success,
                    0.0 - f64::from(u8::from(self.progress.outcome.is_failure())),
                ];
            }
        }
        terms
    }

    /// Where the object is; once it failed to be carried, beyond all goals, so that an object dropped
    /// at its goal earns nothing.
    pub(super) fn achieved(&self, task: &GraspTask) -> [f32; 2] {
        let space = task.goal_space();
        if task.options.goal && self.progress.outcome.is_failure() {
            return space.failure();
        }
        let reach = space.bound as f32;
        let centre = task.robot.object(&self.world);
        [centre.x, centre.y].map(|x| (x as f32).clamp(-reach, reach))
    }

    fn goal_reward(&self, task: &GraspTask) -> f64 {
        task.goal_space()
            .reward(&self.achieved(task), &self.desired())
    }

    pub(super) fn desired(&self) -> [f32; 2] {
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
