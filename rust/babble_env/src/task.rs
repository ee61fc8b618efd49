//! What a task is: all that its episodes do not share with those of other tasks.

use std::fmt;

use babble_body::description::LinkDescription;
use image::RgbImage;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::near;
use crate::outcome::Outcome;
use crate::picture::{View, Visible};
use crate::progress::{Ending, Lifecycle, Progress};
use crate::spec::Spec;
use crate::stream::{Purpose, Stream};

/// Most terms of a reward.
pub const MAX_TERMS: usize = 4;
/// Most facts of an episode.
pub const MAX_FACTS: usize = 8;
/// Most numbers in the measures of an episode.
pub const MAX_MEASURES: usize = 3;

/// A task: its params, which never change, and all that [`crate::Episode`] asks of it.
pub trait Task: fmt::Debug + Send + Sync + Sized + 'static {
    /// What a user asks of the cases to come.
    type Request: fmt::Debug + Clone + Default + Send + Sync;
    /// What is drawn for a new episode.
    type Drawn: fmt::Debug + Send;
    /// Everything that changes: what a snapshot holds, [`Progress`] and [`Lifecycle`] within it.
    type State: fmt::Debug + Clone + Send + Sync + Serialize + DeserializeOwned;
    /// What follows from a state and is kept beside it, as making it takes long.
    type Derived: fmt::Debug + Send + Sync;
    /// What the reward of a step is the change of.
    type Potential;

    /// What its environments are called in errors.
    const NAME: &'static str;
    /// First bytes of its snapshots.
    const MAGIC: [u8; 4];

    /// The outcomes that its episodes can have.
    const OUTCOMES: &'static [Outcome];

    /// What a case consists of, and a user may ask of one.
    const CASE_PARTS: &'static [CasePart] = &[];

    /// Environments that a thread steps at least: their steps must outlast handing them over.
    fn min_per_thread(&self) -> usize;

    /// Physics steps that one step takes at most, or one try to draw a case.
    fn most_physics_steps(&self) -> u64 {
        1
    }

    /// Physics steps that a state repeats when it is loaded, at most.
    fn most_replayed_steps(&self) -> u64 {
        0
    }

    /// Numbers in an action.
    fn action_len(&self) -> usize;

    /// Numbers in a flat observation.
    fn senses_len(&self) -> usize;

    /// The config it was made from.
    fn config(&self) -> &Config;

    /// Numbers that follow from the config and that agents and exports need, by name, in SI units.
    fn quantities(&self) -> Value {
        Value::Object(serde_json::Map::new())
    }

    /// Links of arm and hand; none where the task has no robot.
    fn robot(&self) -> Vec<LinkDescription> {
        Vec::new()
    }

    /// Physics steps in which the solver of contacts did not converge, in all episodes of this task
    /// together; none where no solver tells.
    fn unconverged_steps(&self) -> Option<u64> {
        None
    }

    /// Observations, actions, and the names of all that an episode shows.
    fn spec(&self) -> Spec;

    /// All that decides how an episode goes on: a snapshot continues only where it is the same.
    fn fingerprint(&self) -> impl Serialize;

    /// The two parts of a state that all tasks share.
    fn shared(state: &Self::State) -> (&Progress, &Lifecycle<Self::Request>);

    /// The same, to be changed.
    fn shared_mut(state: &mut Self::State) -> (&mut Progress, &mut Lifecycle<Self::Request>);

    /// The state before the first reset.
    fn fresh(&self, lifecycle: Lifecycle<Self::Request>) -> Self::State;

    /// Checks the task's own part of a state that somebody else wrote, and makes again what was not
    /// written of it.
    ///
    /// # Errors
    /// [`EnvError::Snapshot`] naming what no state of this task can be.
    fn check(&self, state: &mut Self::State) -> Result<(), EnvError>;

    /// What follows from a state.
    fn derive(&self, state: &Self::State) -> Self::Derived;

    /// Draws a case.
    ///
    /// # Errors
    /// [`EnvError`] when the case asked for cannot be played, and [`EnvError::Interrupted`] when `stop`
    /// says so, which a long search asks.
    fn draw(
        &self,
        request: &Self::Request,
        stream: &mut Stream,
        stop: &Stop<'_>,
    ) -> Result<Self::Drawn, EnvError>;

    /// Begins an episode in a state whose shared parts are set.
    fn begin(&self, state: &mut Self::State, drawn: Self::Drawn);

    /// How its episodes end.
    fn ending(&self) -> Ending;

    /// What the reward of a step is the change of.
    fn potential(&self, state: &Self::State) -> Self::Potential;

    /// One step of a running episode: sets the outcome if it failed, and says whether the task is done
    /// now. `action` is as in [`crate::Episode::step`].
    ///
    /// # Errors
    /// [`EnvError`] for a state in which it cannot be stepped.
    fn advance(
        &self,
        state: &mut Self::State,
        derived: &mut Self::Derived,
        action: &[f32],
    ) -> Result<bool, EnvError>;

    /// Reward terms of the step just made, in the order of the spec, then zeros.
    fn reward_terms(&self, state: &Self::State, before: Self::Potential) -> [f64; MAX_TERMS];

    /// Writes the flat observation, all [`Self::senses_len`] numbers of it.
    fn observe(&self, state: &Self::State, derived: &Self::Derived, out: &mut [f32]);

    /// Writes where the task has brought what it moves, and where it should be, each as long as the
    /// spec's goals. Never asked of a task without goals.
    fn goals(&self, state: &Self::State, achieved: &mut [f32], desired: &mut [f32]) {
        let _ = (state, achieved, desired);
    }

    /// Writes the facts that follow [`crate::progress::SUCCESS_FACTS`] in the spec.
    fn facts(&self, state: &Self::State, out: &mut [bool]) {
        let _ = (state, out);
    }

    /// Writes the measures, in the order of the spec.
    fn measures(&self, state: &Self::State, out: &mut [f64; MAX_MEASURES]) {
        let _ = (state, out);
    }

    /// Reward of the goal form, from positions alone; NaN where the task has no such form.
    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        let _ = (achieved, desired);
        f64::NAN
    }

    /// What named values ask of the cases to come. Unspecified values are sampled.
    fn request(&self, asked: &CaseValues) -> Self::Request {
        let _ = asked;
        Self::Request::default()
    }

    /// The case of an episode as named values.
    fn case(&self, state: &Self::State) -> CaseValues {
        let _ = state;
        CaseValues::default()
    }

    /// The cases of a protocol, in their order; none at places of a fixed list that have no case. Of
    /// random cases there are `n`, and case i depends on `purpose`, `seed` and i alone.
    ///
    /// # Errors
    /// [`EnvError::UnknownName`] for an unknown protocol, [`EnvError::NoLegalCase`] or
    /// [`EnvError::NoGraspCase`] when the config leaves no room, or an error of the executor.
    fn cases(
        &self,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError> {
        let _ = (n, seed, purpose, executor);
        Err(near::unknown("protocol", protocol, []))
    }

    /// The recorded positions of the hand, one a control step \[m\].
    fn trail(&self, state: &Self::State) -> Vec<[f64; 2]> {
        let _ = state;
        Vec::new()
    }

    /// How many moments of an episode were recorded.
    fn moments(&self, state: &Self::State) -> usize;

    /// What there is to see of an episode; none where a task has nothing solid.
    fn visible(&self, state: &Self::State) -> Option<Visible> {
        let _ = state;
        None
    }

    /// A picture of an episode; `frame` picks one of its recorded moments, none is now.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for an edge or frame that is out of bounds.
    fn picture(
        &self,
        state: &Self::State,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError>;
}

/// What a goal form can achieve: positions within a square, and when they count as a goal's.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalSpace {
    /// Greatest coordinate of a position \[m\].
    pub(crate) bound: f64,
    /// A goal is achieved within this distance \[m\].
    pub(crate) radius: f64,
}

impl GoalSpace {
    /// What an episode that failed has achieved: the corner of the square, where no arm gets.
    pub(crate) const fn failure(self) -> [f32; 2] {
        [self.bound as f32; 2]
    }

    /// Reward from positions alone \[m\]: 0 within the radius, else −1. A failure achieves no goal,
    /// also not the corner, which hindsight makes a goal.
    ///
    /// Positions are compared as the f32 numbers that an agent stores.
    pub(crate) fn reward(self, achieved: &[f32], desired: &[f32]) -> f64 {
        let pairs = achieved.iter().zip(desired);
        let offsets = pairs.map(|(&a, &d)| f64::from(a) - f64::from(d));
        let distance = offsets.map(|d| d * d).sum::<f64>().sqrt();
        let achieves = achieved != self.failure() && distance <= self.radius;
        if achieves { 0.0 } else { -1.0 }
    }
}
