//! An episode of any task: reset, step and end, and what an environment is asked.

use crate::check::{age, ensure};
use crate::error::EnvError;
use crate::executor::Stop;
use crate::outcome::Outcome;
use crate::progress::{EVER_SUCCESS, IS_SUCCESS, Lifecycle, Phase, Progress};
use crate::stream::Stream;
use crate::task::{MAX_FACTS, MAX_MEASURES, MAX_TERMS, Task};

/// One episode: its state and what follows from it.
#[derive(Debug)]
pub struct Episode<T: Task> {
    state: T::State,
    derived: T::Derived,
}

/// A new episode that was drawn and not begun yet.
#[derive(Debug)]
pub struct NextEpisode<T: Task> {
    drawn: T::Drawn,
    request: T::Request,
    stream: Stream,
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

/// What an episode shows beside its senses and goals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpisodeInfo {
    /// How the episode stands.
    pub outcome: Outcome,
    /// What is true of it in the order of the spec, then false.
    pub facts: [bool; MAX_FACTS],
    /// Its measures in the order of the spec, then zeros.
    pub measures: [f64; MAX_MEASURES],
}

impl<T: Task> Episode<T> {
    /// An episode that has to be reset before it can step.
    #[must_use]
    pub fn new(task: &T, stream: Stream) -> Self {
        let lifecycle = Lifecycle {
            phase: Phase::Fresh,
            request: T::Request::default(),
            pending: None,
            stream,
        };
        Self::from_state(task, task.fresh(lifecycle))
    }

    /// An episode that continues from `state`.
    #[must_use]
    pub fn from_state(task: &T, state: T::State) -> Self {
        Self {
            derived: task.derive(&state),
            state,
        }
    }

    /// All that changes.
    #[must_use]
    pub const fn state(&self) -> &T::State {
        &self.state
    }

    /// Whether it can be stepped.
    #[must_use]
    pub fn phase(&self) -> Phase {
        T::shared(&self.state).1.phase
    }

    /// Starts the stream of cases anew.
    pub fn seed(&mut self, stream: Stream) {
        T::shared_mut(&mut self.state).1.stream = stream;
    }

    /// Sets what the following resets ask of their cases; forgotten if the next one cannot play it.
    pub fn request(&mut self, request: T::Request) {
        T::shared_mut(&mut self.state).1.pending = Some(request);
    }

    /// Draws the case of a new episode.
    ///
    /// # Errors
    /// [`EnvError`] when the case asked for cannot be played, and [`EnvError::Interrupted`] when `stop`
    /// says so; the episode stays as it was.
    pub fn draw(&mut self, task: &T, stop: &Stop<'_>) -> Result<NextEpisode<T>, EnvError> {
        let (_, lifecycle) = T::shared_mut(&mut self.state);
        let kept = || lifecycle.request.clone();
        let request = lifecycle.pending.take().unwrap_or_else(kept);
        let mut stream = lifecycle.stream.clone();
        Ok(NextEpisode {
            drawn: task.draw(&request, &mut stream, stop)?,
            request,
            stream,
        })
    }

    /// Begins an episode that was drawn.
    pub fn begin(&mut self, task: &T, next: NextEpisode<T>) {
        let (progress, lifecycle) = T::shared_mut(&mut self.state);
        *progress = Progress::START;
        *lifecycle = Lifecycle {
            phase: Phase::Running,
            request: next.request,
            pending: None,
            stream: next.stream,
        };
        task.begin(&mut self.state, next.drawn);
        self.derived = task.derive(&self.state);
    }

    /// Leaves the episode unfinished: it has to be reset before it can step.
    pub fn abandon(&mut self) {
        T::shared_mut(&mut self.state).1.phase = Phase::Fresh;
    }

    /// One step of a running episode. `action` has [`Task::action_len`] numbers, all finite; those
    /// outside of [−1, 1] are clipped.
    ///
    /// # Errors
    /// [`EnvError::NeedsReset`] outside of an episode.
    pub fn step(&mut self, task: &T, action: &[f32]) -> Result<Step, EnvError> {
        if self.phase() != Phase::Running {
            return Err(EnvError::NeedsReset { env: 0 });
        }
        let before = task.potential(&self.state);
        let done = task.advance(&mut self.state, &mut self.derived, action)?;
        let (progress, lifecycle) = T::shared_mut(&mut self.state);
        let [terminated, truncated] = task.ending().conclude(progress, done);
        if terminated || truncated {
            lifecycle.phase = Phase::Ended;
        }
        let terms = task.reward_terms(&self.state, before);
        Ok(Step {
            reward: terms.iter().sum(),
            terms,
            terminated,
            truncated,
        })
    }

    /// Writes the flat observation, all [`Task::senses_len`] numbers of it.
    pub fn observe(&self, task: &T, out: &mut [f32]) {
        task.observe(&self.state, &self.derived, out);
    }

    /// Writes the goal achieved and the goal desired, each as long as the spec's.
    pub fn goals(&self, task: &T, achieved: &mut [f32], desired: &mut [f32]) {
        task.goals(&self.state, achieved, desired);
    }

    /// What it shows beside senses and goals.
    #[must_use]
    pub fn info(&self, task: &T) -> EpisodeInfo {
        let (progress, _) = T::shared(&self.state);
        let mut facts = [false; MAX_FACTS];
        facts[IS_SUCCESS] = progress.is_success;
        facts[EVER_SUCCESS] = progress.ever_success;
        task.facts(&self.state, &mut facts[EVER_SUCCESS + 1..]);
        let mut measures = [0.0; MAX_MEASURES];
        task.measures(&self.state, &mut measures);
        EpisodeInfo {
            outcome: progress.outcome,
            facts,
            measures,
        }
    }
}

/// Checks a state that somebody else wrote, and makes again what was not written of it: then no
/// number that it holds makes a step, an observation or a picture panic or hang.
///
/// # Errors
/// [`EnvError::Snapshot`] naming what no state of this task can be.
pub fn check<T: Task>(task: &T, state: &mut T::State) -> Result<(), EnvError> {
    let (progress, lifecycle) = T::shared(state);
    age(lifecycle.phase, progress.steps, task.ending().max_steps)?;
    ensure(T::OUTCOMES.contains(&progress.outcome), || {
        format!("outcome {} is none of {}", progress.outcome, T::NAME)
    })?;
    ensure(lifecycle.stream.moves(), || {
        "stream stands still".to_owned()
    })?;
    task.check(state)
}

/// The action as numbers in [−1, 1].
pub(crate) fn clipped<const N: usize>(action: &[f32]) -> [f64; N] {
    std::array::from_fn(|i| f64::from(action[i]).clamp(-1.0, 1.0))
}
