//! What a batch needs to know of a task and of its episodes.

use std::fmt;

use babble_body::description::LinkDescription;
use image::RgbImage;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::Executor;
use crate::near;
use crate::outcome::Outcome;
use crate::picture::View;
use crate::spec::Spec;
use crate::stream::{Purpose, Stream};

/// Most terms of a reward.
pub const MAX_TERMS: usize = 4;
/// Most facts of an episode.
pub const MAX_FACTS: usize = 8;

/// Everything about a task that stays the same within and between episodes.
pub trait Task: fmt::Debug + Send + Sync + Sized + 'static {
    /// One episode of it.
    type Episode: Episode<Task = Self>;

    /// What its environments are called in errors.
    const NAME: &'static str;
    /// First bytes of its snapshots.
    const MAGIC: [u8; 4];

    /// What a case consists of, and a user may ask of one.
    const CASE_PARTS: &'static [CasePart] = &[];

    /// Environments that a thread steps at least: their steps must outlast handing them over.
    fn min_per_thread(&self) -> usize;

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

    /// Observations, actions, and the names of all that an episode shows.
    fn spec(&self) -> Spec;

    /// All that decides how an episode goes on: a snapshot continues only where it is the same.
    fn fingerprint(&self) -> impl Serialize;

    /// Reward of the goal form, from positions alone; NaN where the task has no such form.
    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        let _ = (achieved, desired);
        f64::NAN
    }

    /// What named values ask of the cases to come. Unspecified values are sampled.
    fn request(&self, asked: &CaseValues) -> Request<Self> {
        let _ = asked;
        Request::<Self>::default()
    }

    /// The case of an episode as named values.
    fn case(&self, state: &State<Self>) -> CaseValues {
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
    fn trail(&self, state: &State<Self>) -> Vec<[f64; 2]> {
        let _ = state;
        Vec::new()
    }

    /// How many moments of an episode were recorded.
    fn moments(&self, state: &State<Self>) -> usize;

    /// A picture of an episode; `frame` picks one of its recorded moments, none is now.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for an edge or frame that is out of bounds.
    fn picture(
        &self,
        state: &State<Self>,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError>;
}

/// The state of a task's episodes.
pub type State<T> = <<T as Task>::Episode as Episode>::State;
/// What a user may ask of a task's cases.
pub type Request<T> = <<T as Task>::Episode as Episode>::Request;

/// One episode: its state and what follows from it.
pub trait Episode: Send + Sync {
    /// The task it is of.
    type Task: Task<Episode = Self>;
    /// What a user asks of the cases to come.
    type Request: Clone + Default;
    /// A new episode that was drawn and not begun yet.
    type NextEpisode: Send;
    /// Everything that changes: what a snapshot holds.
    type State: Clone + Send + Sync + Serialize + DeserializeOwned;

    /// An episode that has to be reset before it can step.
    fn new(task: &Self::Task, stream: Stream) -> Self;

    /// Checks a state that somebody else wrote, and makes again what was not written of it: then no
    /// number that it holds makes a step, an observation or a picture panic or hang.
    ///
    /// # Errors
    /// [`EnvError::Snapshot`] naming what no state of this task can be.
    fn check(task: &Self::Task, state: &mut Self::State) -> Result<(), EnvError>;

    /// An episode that continues from `state`.
    fn from_state(task: &Self::Task, state: Self::State) -> Self;

    /// All that changes.
    fn state(&self) -> &Self::State;

    /// Whether it can be stepped.
    fn phase(&self) -> Phase;

    /// Starts the stream of cases anew.
    fn seed(&mut self, stream: Stream);

    /// Sets what the following resets ask of their cases; forgotten if the next one cannot play it.
    fn request(&mut self, request: Self::Request);

    /// Draws the case of a new episode.
    ///
    /// # Errors
    /// [`EnvError`] when the case asked for cannot be played; the episode stays as it was.
    fn draw(&mut self, task: &Self::Task) -> Result<Self::NextEpisode, EnvError>;

    /// Begins an episode that was drawn.
    fn begin(&mut self, task: &Self::Task, drawn: Self::NextEpisode);

    /// Leaves the episode unfinished: it has to be reset before it can step.
    fn abandon(&mut self);

    /// One step of a running episode. `action` has [`Task::action_len`] numbers, all finite; those
    /// outside of [−1, 1] are clipped.
    ///
    /// # Errors
    /// [`EnvError::NeedsReset`] outside of an episode.
    fn step(&mut self, task: &Self::Task, action: &[f32]) -> Result<Step, EnvError>;

    /// Writes the flat observation, all [`Task::senses_len`] numbers of it.
    fn observe(&self, task: &Self::Task, out: &mut [f32]);

    /// What it shows beside the senses.
    fn info(&self, task: &Self::Task) -> EpisodeInfo;
}

/// Whether an episode can be stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Never reset, or abandoned.
    Fresh,
    /// Between reset and end.
    Running,
    /// Terminated or truncated.
    Ended,
}

/// What one step gave.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Sum of the terms.
    pub reward: f64,
    /// Reward terms in the order of the spec, then zeros.
    pub terms: [f64; MAX_TERMS],
    /// Ended by the task.
    pub terminated: bool,
    /// Ended by the time limit.
    pub truncated: bool,
}

/// What an episode shows beside its senses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpisodeInfo {
    /// Where the task has brought what it moves \[m\].
    pub achieved: [f32; 2],
    /// Where it should be \[m\].
    pub desired: [f32; 2],
    /// How the episode stands.
    pub outcome: Outcome,
    /// What is true of it in the order of the spec, then false.
    pub facts: [bool; MAX_FACTS],
}

/// Reward of a goal form, from positions alone \[m\]: 0 within `radius` \[m\], else −1.
pub(crate) fn goal_reward(radius: f64, achieved: [f32; 2], desired: [f32; 2]) -> f64 {
    let [dx, dy] = [0, 1].map(|i| f64::from(achieved[i]) - f64::from(desired[i]));
    if (dx * dx + dy * dy).sqrt() <= radius {
        0.0
    } else {
        -1.0
    }
}
