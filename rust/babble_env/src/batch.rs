//! n episodes stepped together. A single environment is a batch of one.

use std::sync::Arc;

use rayon::prelude::*;

use crate::case::CaseRequest;
use crate::choice::named_enum;
use crate::error::EnvError;
use crate::options::Outcome;
use crate::pool::Pool;
use crate::reach::{Phase, Reach, ReachState, SENSES, Step};
use crate::snapshot;
use crate::stream::{Purpose, Stream};
use crate::task::ReachTask;

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Flat observation.
    pub senses: [f32; SENSES],
    /// Fingertip \[m\].
    pub achieved: [f32; 2],
    /// Target \[m\].
    pub desired: [f32; 2],
    /// Reward and end.
    pub step: Step,
    /// How the episode stands.
    pub outcome: Outcome,
    /// Whether the fingertip is at the target now.
    pub is_success: bool,
    /// Whether it ever was.
    pub ever_success: bool,
}

impl Record {
    fn of(task: &ReachTask, env: &Reach, step: Step) -> Self {
        let state = env.state();
        let mut record = Self {
            senses: [0.0; SENSES],
            achieved: env.fingertip(task).map(|x| x as f32),
            desired: state.case.target.map(|x| x as f32),
            step,
            outcome: state.outcome,
            is_success: state.is_success,
            ever_success: state.ever_success,
        };
        env.observe(task, &mut record.senses);
        record
    }
}

/// One environment and what it last showed.
#[derive(Debug, Clone)]
struct Slot {
    env: Reach,
    record: Record,
    /// The episode that a same-step reset replaced.
    last: Option<Last>,
}

/// An episode at its end.
#[derive(Debug, Clone)]
pub struct Last {
    /// What it showed last.
    pub record: Record,
    /// Its state.
    pub state: ReachState,
}

/// n environments.
#[derive(Debug, Clone)]
pub struct Batch {
    task: Arc<ReachTask>,
    slots: Vec<Slot>,
    autoreset: Autoreset,
    pool: Pool,
}

impl Batch {
    /// `n` environments that have to be reset before they can step.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for no environments, or no threads.
    pub fn new(
        task: Arc<ReachTask>,
        n: usize,
        autoreset: Autoreset,
        threads: usize,
    ) -> Result<Self, EnvError> {
        if !(1..=1_000_000).contains(&n) {
            return Err(EnvError::OutOfBounds {
                option: "num_envs",
                value: n.to_string(),
                bound: "in [1, 1000000]".to_owned(),
            });
        }
        let slot = |i: usize| {
            let env = Reach::new(&task, Stream::new(Purpose::Environment, 0, i as u64));
            Slot {
                record: Record::of(&task, &env, Step::default()),
                env,
                last: None,
            }
        };
        let slots = (0..n).map(slot).collect();
        Ok(Self {
            slots,
            autoreset,
            pool: Pool::new(threads)?,
            task,
        })
    }

    /// The task they share.
    #[must_use]
    pub fn task(&self) -> &Arc<ReachTask> {
        &self.task
    }

    /// How many environments there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Never true.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Threads that step them.
    #[must_use]
    pub const fn threads(&self) -> usize {
        self.pool.threads()
    }

    /// What each environment showed last.
    #[must_use]
    pub fn records(&self) -> impl ExactSizeIterator<Item = &Record> {
        self.slots.iter().map(|slot| &slot.record)
    }

    /// The episode that ended within the last step, of each environment that a same-step reset began
    /// anew.
    #[must_use]
    pub fn last(&self) -> impl ExactSizeIterator<Item = Option<&Last>> {
        self.slots.iter().map(|slot| slot.last.as_ref())
    }

    /// The episode of environment `i`.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn env(&self, i: usize) -> Result<&Reach, EnvError> {
        self.slots
            .get(i)
            .map(|slot| &slot.env)
            .ok_or_else(|| no_such_env(i, self.slots.len()))
    }

    /// Starts the stream of environment `i` anew from `seed`.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn seed(&mut self, i: usize, seed: u64) -> Result<(), EnvError> {
        self.slot(i)?
            .env
            .seed(Stream::new(Purpose::Environment, seed, 0));
        Ok(())
    }

    /// Sets what the following resets of environment `i` ask of their cases.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn request(&mut self, i: usize, request: CaseRequest) -> Result<(), EnvError> {
        self.slot(i)?.env.request(request);
        Ok(())
    }

    /// Begins a new episode in every environment for which `mask` is true.
    ///
    /// # Errors
    /// The first error in the order of the environments, after which all of them are as they were.
    pub fn reset(&mut self, mask: &[bool]) -> Result<(), EnvError> {
        let task = &self.task;
        let draw =
            |(slot, &chosen): (&mut Slot, &bool)| chosen.then(|| slot.env.draw(task)).transpose();
        let slots = &mut self.slots;
        // All are drawn, also after an error, as each forgets what it was asked.
        let drawn: Vec<_> = if self.pool.threads() == 1 {
            slots.iter_mut().zip(mask).map(draw).collect()
        } else {
            self.pool.run(|| {
                slots
                    .par_iter_mut()
                    .zip(mask.par_iter())
                    .map(draw)
                    .collect()
            })?
        };
        let drawn = drawn.into_iter().collect::<Result<Vec<_>, EnvError>>()?;
        for (slot, drawn) in self.slots.iter_mut().zip(drawn) {
            slot.last = None;
            if let Some(drawn) = drawn {
                slot.env.begin(task, drawn);
                slot.record = Record::of(task, &slot.env, Step::default());
            }
        }
        Ok(())
    }

    /// One step of every environment; `actions` holds two numbers for each.
    ///
    /// # Errors
    /// [`EnvError::ActionShape`], [`EnvError::ActionNotFinite`] or [`EnvError::NeedsReset`], after
    /// which nothing was stepped; or the error of an automatic reset.
    pub fn step(&mut self, actions: &[f32]) -> Result<(), EnvError> {
        self.check(actions)?;
        let (task, autoreset) = (&self.task, self.autoreset);
        let step = |(slot, action): (&mut Slot, &[f32])| slot.step(task, action, autoreset);
        let slots = &mut self.slots;
        if self.pool.threads() == 1 {
            return slots
                .iter_mut()
                .zip(actions.chunks_exact(2))
                .map(step)
                .fold(Ok(()), Result::and);
        }
        let results: Vec<_> = self.pool.run(|| {
            slots
                .par_iter_mut()
                .with_min_len(8)
                .zip(actions.par_chunks_exact(2))
                .map(step)
                .collect()
        })?;
        results.into_iter().collect()
    }

    fn check(&self, actions: &[f32]) -> Result<(), EnvError> {
        let expected = 2 * self.slots.len();
        if actions.len() != expected {
            return Err(EnvError::ActionShape {
                got: actions.len(),
                expected,
            });
        }
        if let Some(at) = actions.iter().position(|a| !a.is_finite()) {
            return Err(EnvError::ActionNotFinite {
                env: at / 2,
                index: at % 2,
                value: actions[at],
            });
        }
        let ready = |slot: &Slot| match slot.env.state().phase {
            Phase::Running => true,
            Phase::Ended => self.autoreset == Autoreset::NextStep,
            Phase::Fresh => false,
        };
        match self.slots.iter().position(|slot| !ready(slot)) {
            Some(env) => Err(EnvError::NeedsReset { env }),
            None => Ok(()),
        }
    }

    /// Environment `i` as bytes, to be continued by [`Self::load`] bit for bit.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] if there is no such environment.
    pub fn save(&self, i: usize) -> Result<Vec<u8>, EnvError> {
        snapshot::save(&self.task, self.env(i)?.state())
    }

    /// Continues environment `i` from bytes.
    ///
    /// # Errors
    /// [`EnvError::Snapshot`], after which the environment is as it was.
    pub fn load(&mut self, i: usize, bytes: &[u8]) -> Result<(), EnvError> {
        let state = snapshot::load(&self.task, bytes)?;
        let env = Reach::from_state(&self.task, state);
        let record = Record::of(&self.task, &env, Step::default());
        *self.slot(i)? = Slot {
            env,
            record,
            last: None,
        };
        Ok(())
    }

    fn slot(&mut self, i: usize) -> Result<&mut Slot, EnvError> {
        let n = self.slots.len();
        self.slots.get_mut(i).ok_or_else(|| no_such_env(i, n))
    }
}

impl Slot {
    fn reset(&mut self, task: &ReachTask) -> Result<(), EnvError> {
        self.env.reset(task)?;
        self.record = Record::of(task, &self.env, Step::default());
        Ok(())
    }

    fn step(
        &mut self,
        task: &ReachTask,
        action: &[f32],
        autoreset: Autoreset,
    ) -> Result<(), EnvError> {
        self.last = None;
        if self.env.state().phase == Phase::Ended {
            return self.reset(task);
        }
        let step = self.env.step(task, action)?;
        let record = Record::of(task, &self.env, step);
        if autoreset == Autoreset::SameStep && (step.terminated || step.truncated) {
            self.last = Some(Last {
                record,
                state: self.env.state().clone(),
            });
            self.reset(task)?;
            self.record.step = step;
        } else {
            self.record = record;
        }
        Ok(())
    }
}

fn no_such_env(i: usize, n: usize) -> EnvError {
    EnvError::OutOfBounds {
        option: "env",
        value: i.to_string(),
        bound: format!("below {n}"),
    }
}
