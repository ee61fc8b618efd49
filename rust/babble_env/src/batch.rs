//! n episodes stepped together. A single environment is a batch of one.

use std::fmt;
use std::sync::Arc;

use crate::episode::{Episode, EpisodeInfo, NextEpisode, Step};
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::named_enum::named_enum;
use crate::progress::Phase;
use crate::snapshot;
use crate::stream::{Purpose, Stream};
use crate::task::Task;

named_enum!(
    /// When an ended episode begins anew.
    Autoreset, "autoreset_mode",
    /// At the next step, whose action is ignored.
    NextStep = "NextStep",
    /// Within the step that ended it; the final observation is kept aside.
    SameStep = "SameStep",
    /// Never; the user resets it.
    Disabled = "Disabled"
);

/// What an environment shows after a reset or a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Flat observation.
    pub senses: Vec<f32>,
    /// Where the task has brought what it moves, in the unit of the spec; empty without goals.
    pub achieved: Vec<f32>,
    /// Where it should be; empty without goals.
    pub desired: Vec<f32>,
    /// What it shows beside.
    pub info: EpisodeInfo,
    /// Reward and end.
    pub step: Step,
}

impl Record {
    fn of<T: Task>(task: &T, env: &Episode<T>, goal_len: usize) -> Self {
        let mut record = Self {
            senses: vec![0.0; task.senses_len()],
            achieved: vec![0.0; goal_len],
            desired: vec![0.0; goal_len],
            info: env.info(task),
            step: Step::default(),
        };
        record.update(task, env, Step::default());
        record
    }

    /// Shows `env` after `step`, in the same memory.
    fn update<T: Task>(&mut self, task: &T, env: &Episode<T>, step: Step) {
        env.observe(task, &mut self.senses);
        if !self.achieved.is_empty() {
            env.goals(task, &mut self.achieved, &mut self.desired);
        }
        self.info = env.info(task);
        self.step = step;
    }
}

/// One environment and what it last showed.
struct BatchMember<T: Task> {
    env: Episode<T>,
    record: Record,
    /// The episode that an automatic reset replaced within the last step.
    final_episode: Option<FinalEpisode<T::State>>,
}

/// An episode at its end.
#[derive(Debug, Clone)]
pub struct FinalEpisode<S> {
    /// What it showed last.
    pub record: Record,
    /// Its state.
    pub state: S,
}

/// n environments.
pub struct Batch<T: Task> {
    task: Arc<T>,
    members: Vec<BatchMember<T>>,
    autoreset: Autoreset,
    pool: Executor,
}

/// Without the episodes, which may be large.
impl<T: Task> fmt::Debug for Batch<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Batch")
            .field("task", &T::NAME)
            .field("len", &self.len())
            .field("autoreset", &self.autoreset)
            .finish_non_exhaustive()
    }
}

impl<T: Task> Batch<T> {
    /// `n` environments that have to be reset before they can step.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for no environments, or no threads.
    pub fn new(
        task: Arc<T>,
        n: usize,
        autoreset: Autoreset,
        threads: usize,
    ) -> Result<Self, EnvError> {
        Self::with_executor(task, n, autoreset, Executor::new(threads)?)
    }

    /// The same with a pool that may be interrupted: what it interrupts is told at each method.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for no environments; [`EnvError::Interrupted`].
    pub fn with_executor(
        task: Arc<T>,
        n: usize,
        autoreset: Autoreset,
        pool: Executor,
    ) -> Result<Self, EnvError> {
        if !(1..=1_000_000).contains(&n) {
            return Err(EnvError::OutOfBounds {
                option: "num_envs",
                value: n.to_string(),
                bound: "in [1, 1000000]".to_owned(),
            });
        }
        let goal_len = task.spec().goal_len();
        let mut members = Vec::with_capacity(n);
        pool.in_turn(0..n, |_, i| {
            let stream = Stream::new(Purpose::Environment, 0, i as u64);
            let env = Episode::new(&*task, stream);
            members.push(BatchMember::new(&*task, env, goal_len));
            Ok(())
        })?;
        Ok(Self {
            task,
            members,
            autoreset,
            pool,
        })
    }

    /// The task they share.
    #[must_use]
    pub fn task(&self) -> &Arc<T> {
        &self.task
    }

    /// How many environments there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Never true.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Threads that step them.
    #[must_use]
    pub const fn threads(&self) -> usize {
        self.pool.threads()
    }

    /// What each environment showed last.
    #[must_use]
    pub fn records(&self) -> impl ExactSizeIterator<Item = &Record> {
        self.members.iter().map(|member| &member.record)
    }

    /// The ended episode of each environment that began anew by itself within the last step.
    #[must_use]
    pub fn final_episodes(&self) -> impl ExactSizeIterator<Item = Option<&FinalEpisode<T::State>>> {
        self.members
            .iter()
            .map(|member| member.final_episode.as_ref())
    }

    /// The state of environment `i`.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn state(&self, i: usize) -> Result<&T::State, EnvError> {
        self.members
            .get(i)
            .map(|member| member.env.state())
            .ok_or_else(|| no_such_env(i, self.members.len()))
    }

    /// Starts the stream of environment `i` anew from `seed`.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn seed(&mut self, i: usize, seed: u64) -> Result<(), EnvError> {
        self.member(i)?
            .env
            .seed(Stream::new(Purpose::Environment, seed, 0));
        Ok(())
    }

    /// Sets what the following resets of environment `i` ask of their cases.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn request(&mut self, i: usize, request: T::Request) -> Result<(), EnvError> {
        self.member(i)?.env.request(request);
        Ok(())
    }

    /// Begins a new episode in every environment for which `mask` is true.
    ///
    /// # Errors
    /// The first error in the order of the environments, after which all of them are as they were.
    /// [`EnvError::Interrupted`], after which those that `mask` chose need a reset.
    pub fn reset(&mut self, mask: &[bool]) -> Result<(), EnvError> {
        let task = &*self.task;
        let mut chosen: Vec<_> = self
            .members
            .iter_mut()
            .zip(mask)
            .filter_map(|(member, &chosen)| chosen.then_some((member, None)))
            .collect();
        // All are drawn, also after an error, as each forgets what it was asked.
        let drawn = self
            .pool
            .for_each(&mut chosen, 1, |_, (member, drawn), stop| {
                *drawn = Some(member.env.draw(task, stop)?);
                Ok(())
            });
        let begun = drawn.and_then(|()| {
            self.pool.for_each(&mut chosen, 1, |_, (member, drawn), _| {
                if let Some(drawn) = drawn.take() {
                    member.final_episode = None;
                    member.begin(task, drawn);
                }
                Ok(())
            })
        });
        if begun == Err(EnvError::Interrupted) {
            for (member, _) in chosen {
                member.env.abandon();
            }
        }
        begun
    }

    /// One step of every environment; `actions` holds those of the first, then of the second …
    ///
    /// # Errors
    /// [`EnvError::ActionShape`], [`EnvError::ActionNotFinite`] or [`EnvError::NeedsReset`], after
    /// which nothing was stepped. After any other, as [`EnvError::Interrupted`] or that of an
    /// automatic reset, some environments were stepped and what they showed is lost: all need a
    /// reset.
    pub fn step(&mut self, actions: &[f32]) -> Result<(), EnvError> {
        self.check(actions)?;
        let (task, autoreset) = (&*self.task, self.autoreset);
        let width = task.action_len();
        let least = task.min_per_thread();
        let stepped = self
            .pool
            .for_each(&mut self.members, least, |i, member, stop| {
                member.step(task, &actions[i * width..][..width], autoreset, stop)
            });
        if stepped.is_err() {
            for member in &mut self.members {
                member.env.abandon();
            }
        }
        stepped
    }

    fn check(&self, actions: &[f32]) -> Result<(), EnvError> {
        let width = self.task.action_len();
        let expected = width * self.members.len();
        if actions.len() != expected {
            return Err(EnvError::ActionShape {
                got: actions.len(),
                expected,
            });
        }
        if let Some(at) = actions.iter().position(|a| !a.is_finite()) {
            return Err(EnvError::ActionNotFinite {
                env: at / width,
                index: at % width,
                value: actions[at],
            });
        }
        let ready = |member: &BatchMember<T>| match member.env.phase() {
            Phase::Running => true,
            Phase::Ended => self.autoreset == Autoreset::NextStep,
            Phase::Fresh => false,
        };
        match self.members.iter().position(|member| !ready(member)) {
            Some(env) => Err(EnvError::NeedsReset { env }),
            None => Ok(()),
        }
    }

    /// Environment `i` as bytes, to be continued by [`Self::load`] bit for bit.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn save(&self, i: usize) -> Result<Vec<u8>, EnvError> {
        snapshot::save(&*self.task, self.state(i)?)
    }

    /// The ended episode of environment `i` as bytes, if it began anew by itself within the last step.
    ///
    /// # Errors
    /// As [`Self::save`].
    pub fn save_final(&self, i: usize) -> Result<Option<Vec<u8>>, EnvError> {
        let ended = self.final_episodes().nth(i).flatten();
        let save = |ended: &FinalEpisode<T::State>| snapshot::save(&*self.task, &ended.state);
        ended.map(save).transpose()
    }

    /// Continues environment `i` from bytes.
    ///
    /// # Errors
    /// [`EnvError::Snapshot`], after which the environment is as it was.
    pub fn load(&mut self, i: usize, bytes: &[u8]) -> Result<(), EnvError> {
        let task = &*self.task;
        let state = snapshot::load(task, bytes)?;
        let env = Episode::from_state(task, state);
        let member = BatchMember::new(task, env, task.spec().goal_len());
        *self.member(i)? = member;
        Ok(())
    }

    fn member(&mut self, i: usize) -> Result<&mut BatchMember<T>, EnvError> {
        let n = self.members.len();
        self.members.get_mut(i).ok_or_else(|| no_such_env(i, n))
    }
}

impl<T: Task> BatchMember<T> {
    fn new(task: &T, env: Episode<T>, goal_len: usize) -> Self {
        Self {
            record: Record::of(task, &env, goal_len),
            env,
            final_episode: None,
        }
    }

    fn begin(&mut self, task: &T, drawn: NextEpisode<T>) {
        self.env.begin(task, drawn);
        self.record.update(task, &self.env, Step::default());
    }

    fn reset(&mut self, task: &T, stop: &Stop<'_>) -> Result<(), EnvError> {
        let drawn = self.env.draw(task, stop)?;
        self.begin(task, drawn);
        Ok(())
    }

    fn step(
        &mut self,
        task: &T,
        action: &[f32],
        autoreset: Autoreset,
        stop: &Stop<'_>,
    ) -> Result<(), EnvError> {
        self.final_episode = None;
        if self.env.phase() == Phase::Ended {
            self.keep_final();
            return self.reset(task, stop);
        }
        let step = self.env.step(task, action)?;
        self.record.update(task, &self.env, step);
        if autoreset == Autoreset::SameStep && (step.terminated || step.truncated) {
            self.keep_final();
            self.reset(task, stop)?;
            self.record.step = step;
        }
        Ok(())
    }

    fn keep_final(&mut self) {
        self.final_episode = Some(FinalEpisode {
            record: self.record.clone(),
            state: self.env.state().clone(),
        });
    }
}

fn no_such_env(i: usize, n: usize) -> EnvError {
    EnvError::OutOfBounds {
        option: "env",
        value: i.to_string(),
        bound: format!("below {n}"),
    }
}
