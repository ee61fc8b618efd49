//! Motor babbling: random movements, one sequence for each seed.

use std::fmt;
use std::marker::PhantomData;

use babble_env::picture::Film;
use babble_env::{EnvError, Executor, Outcome, Purpose, Stream, Task};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::AgentError;

/// Most babbles that are made together.
const CHUNK: usize = 64;

/// Numbers of all experiences that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name, as the environment's senses have it where it is one of them.
    pub name: &'static str,
    /// What it tells of.
    pub kind: ColumnKind,
    /// Numbers of each experience.
    pub width: usize,
    /// The numbers, one experience after the other.
    pub values: Vec<f32>,
}

/// What a column of experiences tells of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// What was seen.
    Percept,
    /// What was done: parameters of a movement, or a posture.
    Action,
    /// What the case was.
    Case,
}

impl Column {
    /// A column of N numbers of each experience.
    pub(crate) fn of<E, const N: usize>(
        name: &'static str,
        kind: ColumnKind,
        all: &[E],
        numbers: impl Fn(&E) -> [f32; N],
    ) -> Self {
        Self {
            name,
            kind,
            width: N,
            values: all.iter().flat_map(numbers).collect(),
        }
    }
}

/// A task that an agent can babble in.
pub trait Babble: Task {
    /// How babbles are simulated.
    type Options: Copy
        + Default
        + PartialEq
        + fmt::Debug
        + Send
        + Sync
        + Serialize
        + DeserializeOwned;
    /// What a babble leaves behind at the moment in which it is learnt from.
    type Experience: Clone + PartialEq + fmt::Debug + Send + Sync;

    /// How many babbles it takes about until one can be learnt from: so many are made together.
    const TRIES: usize;
    /// When of so many babbles not even one can be learnt from, nothing can.
    const RAREST: u64;
    /// Bounds of the time between two experiences of one babble \[s\]; None if each babble has one.
    const PERIODS_S: Option<[f64; 2]>;

    /// One babble: an experience at its end, or every `period_s` seconds while it moves. Those that
    /// cannot be learnt from are left out, unless `all` are asked for; so none is left of a babble
    /// that cannot be learnt from.
    ///
    /// # Errors
    /// An error of the task.
    fn babble(
        &self,
        options: Self::Options,
        period_s: Option<f64>,
        stream: &mut Stream,
        all: bool,
    ) -> Result<Vec<Self::Experience>, EnvError>;

    /// The same babble for people to look at, to its end. The marks of the film are the moments of the
    /// experiences, none of which is left out.
    ///
    /// # Errors
    /// As [`babble`](Self::babble).
    fn film(
        &self,
        options: Self::Options,
        period_s: Option<f64>,
        stream: &mut Stream,
    ) -> Result<(Vec<Self::Experience>, Film), EnvError>;

    /// Control steps that a babble takes.
    fn babble_steps(&self, options: Self::Options) -> usize;

    /// Whether an experience can be learnt from.
    fn is_learnable(experience: &Self::Experience) -> bool;

    /// What an experience would have been with the action of another one.
    fn with_action_of(experience: &Self::Experience, other: &Self::Experience) -> Self::Experience;

    /// How a babble ended.
    fn outcome(experience: &Self::Experience) -> Outcome;

    /// Experiences column by column.
    fn columns(experiences: &[Self::Experience]) -> Vec<Column>;
}

/// A sequence of babbles. Babble k depends on the seed and k alone.
#[derive(Debug)]
pub struct Babbling<T: Babble> {
    seed: u64,
    options: T::Options,
    period_s: Option<f64>,
    babbled: u64,
    learnt: u64,
    task: PhantomData<fn(&T)>,
}

// Derived, it would ask for a task that can be copied.
impl<T: Babble> Clone for Babbling<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Babble> Copy for Babbling<T> {}

impl<T: Babble> Babbling<T> {
    /// The sequence of `seed` from its beginning.
    #[must_use]
    pub const fn new(seed: u64, options: T::Options) -> Self {
        Self::resume(seed, options, 0, 0)
    }

    /// The sequence of `seed` after `babbled` babbles, of which `learnt` were learnt from.
    #[must_use]
    pub const fn resume(seed: u64, options: T::Options, babbled: u64, learnt: u64) -> Self {
        Self {
            seed,
            options,
            period_s: None,
            babbled,
            learnt,
            task: PhantomData,
        }
    }

    /// The same with an experience every `period_s` seconds of a babble; None for one at its end.
    ///
    /// # Errors
    /// [`AgentError::Config`] for a period that is not in [`Babble::PERIODS_S`].
    pub fn every(self, period_s: Option<f64>) -> Result<Self, AgentError> {
        let problem = match (period_s, T::PERIODS_S) {
            (None, _) => None,
            (Some(s), Some([low, high])) if (low..=high).contains(&s) => None,
            (Some(s), Some([low, high])) => Some(format!("{s} is not in [{low}, {high}] s")),
            (Some(s), None) => Some(format!("{s}: a movement of this task is learnt from once")),
        };
        match problem {
            None => Ok(Self { period_s, ..self }),
            Some(problem) => Err(AgentError::Config {
                field: "learning_period_s",
                problem,
            }),
        }
    }

    /// Its seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// How its babbles are simulated.
    #[must_use]
    pub const fn options(&self) -> T::Options {
        self.options
    }

    /// Babbles made so far.
    #[must_use]
    pub const fn babbled(&self) -> u64 {
        self.babbled
    }

    /// How many of them could be learnt from: the legal movements, or the babbles in which the hand
    /// kept the object.
    #[must_use]
    pub const fn learnt(&self) -> u64 {
        self.learnt
    }

    /// Babbles until `n` more can be learnt from, and returns what these leave behind, in its order.
    ///
    /// # Errors
    /// [`AgentError::NothingToLearn`] when such babbles are too rare, or an error of the task or the
    /// executor; the sequence is then where it was.
    pub fn experience(
        &mut self,
        task: &T,
        n: usize,
        executor: &mut Executor,
    ) -> Result<Vec<T::Experience>, AgentError> {
        Ok(self.by_babble(task, n, executor)?.concat())
    }

    /// The same, apart for each babble.
    ///
    /// # Errors
    /// As [`experience`](Self::experience).
    pub fn by_babble(
        &mut self,
        task: &T,
        n: usize,
        executor: &mut Executor,
    ) -> Result<Vec<Vec<T::Experience>>, AgentError> {
        let mut ahead = *self;
        let found = ahead.search(task, n, executor)?;
        *self = ahead;
        Ok(found)
    }

    /// What the last babble that could be learnt from left behind, made again; nothing before it. The
    /// sequence always stops after such a babble.
    ///
    /// # Errors
    /// An error of the task.
    pub(crate) fn last(&self, task: &T) -> Result<Vec<T::Experience>, EnvError> {
        if self.babbled == 0 {
            return Ok(Vec::new());
        }
        let mut stream = Stream::new(Purpose::Learning, self.seed, self.babbled - 1);
        task.babble(self.options, self.period_s, &mut stream, false)
    }

    /// The babble that comes after `ahead` others from here on, for people to look at.
    ///
    /// # Errors
    /// An error of the task.
    pub fn film(&self, task: &T, ahead: u64) -> Result<(Vec<T::Experience>, Film), EnvError> {
        let index = self.babbled.saturating_add(ahead);
        let mut stream = Stream::new(Purpose::Learning, self.seed, index);
        task.film(self.options, self.period_s, &mut stream)
    }

    fn search(
        &mut self,
        task: &T,
        n: usize,
        executor: &mut Executor,
    ) -> Result<Vec<Vec<T::Experience>>, AgentError> {
        let (mut left, mut found) = (n, Vec::with_capacity(n));
        while left > 0 {
            let count = CHUNK.min(left.saturating_mul(T::TRIES));
            for experiences in self.some(task, count, false, executor)? {
                if left == 0 {
                    break;
                }
                self.babbled += 1;
                if !experiences.is_empty() {
                    self.learnt += 1;
                    left -= 1;
                    found.push(experiences);
                }
            }
            if self.babbled > T::RAREST * (self.learnt + 1) {
                return Err(AgentError::NothingToLearn {
                    learnt: self.learnt,
                    babbled: self.babbled,
                });
            }
        }
        Ok(found)
    }

    /// The next `n` babbles, none of which is counted.
    fn some(
        &self,
        task: &T,
        n: usize,
        all: bool,
        executor: &mut Executor,
    ) -> Result<Vec<Vec<T::Experience>>, EnvError> {
        executor.map(0..n, |i, _| {
            let mut stream = Stream::new(Purpose::Learning, self.seed, self.babbled + i as u64);
            task.babble(self.options, self.period_s, &mut stream, all)
        })
    }
}

/// What each of the next `n` babbles leaves behind, whether it can be learnt from or not. Babble k is
/// that of `babbling`, which does not move on.
///
/// # Errors
/// An error of the task or the executor.
pub fn babble<T: Babble>(
    babbling: &Babbling<T>,
    task: &T,
    n: usize,
    executor: &mut Executor,
) -> Result<Vec<Vec<T::Experience>>, AgentError> {
    Ok(babbling.some(task, n, true, executor)?)
}
