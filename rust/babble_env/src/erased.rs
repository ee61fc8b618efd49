//! Any task and any batch behind one object-safe trait each: for faces that choose the task at run
//! time, as the registry, Python, a server and a browser do.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use babble_body::description::LinkDescription;
use image::RgbImage;
use serde_json::Value;

use crate::batch::{Autoreset, Batch, Record};
use crate::case::{CasePart, CaseValues};
use crate::config::Config;
use crate::error::EnvError;
use crate::executor::Executor;
use crate::picture::{View, Visible};
use crate::snapshot;
use crate::spec::Spec;
use crate::stream::Purpose;
use crate::task::Task;

/// A task of any kind. Implemented for every [`Task`].
pub trait AnyTask: Any + fmt::Debug + Send + Sync {
    /// As [`Task::config`].
    fn config(&self) -> &Config;

    /// As [`Task::spec`].
    fn spec(&self) -> Spec;

    /// As [`Task::CASE_PARTS`].
    fn case_parts(&self) -> &'static [CasePart];

    /// As [`Task::quantities`].
    fn quantities(&self) -> Value;

    /// As [`Task::robot`].
    fn robot(&self) -> Vec<LinkDescription>;

    /// As [`Task::unconverged_steps`].
    fn unconverged_steps(&self) -> Option<u64>;

    /// Whether one step takes longer than handing it to a thread.
    fn has_long_steps(&self) -> bool;

    /// As [`Task::most_physics_steps`].
    fn most_physics_steps(&self) -> u64;

    /// As [`Task::most_replayed_steps`].
    fn most_replayed_steps(&self) -> u64;

    /// As [`Task::goal_reward`].
    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64;

    /// As [`Task::cases`].
    ///
    /// # Errors
    /// As [`Task::cases`].
    fn cases(
        &self,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError>;

    /// As [`Batch::with_executor`].
    ///
    /// # Errors
    /// As [`Batch::with_executor`].
    fn batch(
        self: Arc<Self>,
        n: usize,
        autoreset: Autoreset,
        executor: Executor,
    ) -> Result<Box<dyn AnyBatch>, EnvError>;
}

/// The task as one of its own type, if it is one: for agents, which are made for one task.
#[must_use]
pub fn downcast<T: Task>(task: &Arc<dyn AnyTask>) -> Option<Arc<T>> {
    let any: Arc<dyn Any + Send + Sync> = Arc::clone(task) as _;
    any.downcast().ok()
}

impl<T: Task> AnyTask for T {
    fn config(&self) -> &Config {
        Task::config(self)
    }

    fn spec(&self) -> Spec {
        Task::spec(self)
    }

    fn case_parts(&self) -> &'static [CasePart] {
        T::CASE_PARTS
    }

    fn quantities(&self) -> Value {
        Task::quantities(self)
    }

    fn robot(&self) -> Vec<LinkDescription> {
        Task::robot(self)
    }

    fn unconverged_steps(&self) -> Option<u64> {
        Task::unconverged_steps(self)
    }

    fn has_long_steps(&self) -> bool {
        self.min_per_thread() == 1
    }

    fn most_physics_steps(&self) -> u64 {
        Task::most_physics_steps(self)
    }

    fn most_replayed_steps(&self) -> u64 {
        Task::most_replayed_steps(self)
    }

    fn goal_reward(&self, achieved: &[f32], desired: &[f32]) -> f64 {
        Task::goal_reward(self, achieved, desired)
    }

    fn cases(
        &self,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: Purpose,
        executor: &mut Executor,
    ) -> Result<Vec<Option<CaseValues>>, EnvError> {
        Task::cases(self, protocol, n, seed, purpose, executor)
    }

    fn batch(
        self: Arc<Self>,
        n: usize,
        autoreset: Autoreset,
        executor: Executor,
    ) -> Result<Box<dyn AnyBatch>, EnvError> {
        Ok(Box::new(Batch::with_executor(
            self, n, autoreset, executor,
        )?))
    }
}

/// A batch of any task. Implemented for every [`Batch`], whose methods these are.
#[expect(clippy::missing_errors_doc, reason = "as the methods of Batch")]
pub trait AnyBatch: Any + fmt::Debug + Send + Sync {
    /// How many environments there are.
    fn envs(&self) -> usize;

    /// Threads that step them.
    fn threads(&self) -> usize;

    /// What environment `i` showed last.
    fn record(&self, i: usize) -> Option<&Record>;

    /// What the ended episode of environment `i` showed last, if it began anew by itself within the
    /// last step.
    fn final_record(&self, i: usize) -> Option<&Record>;

    /// Starts the stream of environment `i` anew from `seed`.
    fn seed(&mut self, i: usize, seed: u64) -> Result<(), EnvError>;

    /// Sets what the following resets of environment `i` ask of their cases.
    fn request(&mut self, i: usize, asked: &CaseValues) -> Result<(), EnvError>;

    /// Begins a new episode in every environment for which `mask` is true.
    fn reset(&mut self, mask: &[bool]) -> Result<(), EnvError>;

    /// One step of every environment.
    fn step(&mut self, actions: &[f32]) -> Result<(), EnvError>;

    /// Environment `i` as bytes.
    fn save(&self, i: usize) -> Result<Vec<u8>, EnvError>;

    /// The episode of [`Self::final_record`] as bytes.
    fn save_final(&self, i: usize) -> Result<Option<Vec<u8>>, EnvError>;

    /// Continues environment `i` from bytes.
    fn load(&mut self, i: usize, bytes: &[u8]) -> Result<(), EnvError>;

    /// A number that two states share only if they are the same to the bit.
    fn state_hash(&self, i: usize) -> Result<u64, EnvError>;

    /// The case of environment `i`.
    fn case(&self, i: usize) -> Result<CaseValues, EnvError>;

    /// The recorded positions of the hand of environment `i` \[m\].
    fn trail(&self, i: usize) -> Result<Vec<[f64; 2]>, EnvError>;

    /// How many moments of environment `i` were recorded since its reset.
    fn moments(&self, i: usize) -> Result<usize, EnvError>;

    /// What there is to see of environment `i`; none where a task has nothing solid.
    fn visible(&self, i: usize) -> Result<Option<Visible>, EnvError>;

    /// A picture (width, height) of environment `i`; `frame` picks a recorded moment, none is now.
    fn picture(
        &self,
        i: usize,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError>;

    /// A picture of the last moment of the episode of [`Self::final_record`].
    fn final_picture(
        &self,
        i: usize,
        view: View,
        size: [u32; 2],
    ) -> Result<Option<RgbImage>, EnvError>;
}

impl<T: Task> AnyBatch for Batch<T> {
    fn envs(&self) -> usize {
        self.len()
    }

    fn threads(&self) -> usize {
        self.threads()
    }

    fn record(&self, i: usize) -> Option<&Record> {
        self.records().nth(i)
    }

    fn final_record(&self, i: usize) -> Option<&Record> {
        Some(&self.final_episodes().nth(i)??.record)
    }

    fn seed(&mut self, i: usize, seed: u64) -> Result<(), EnvError> {
        self.seed(i, seed)
    }

    fn request(&mut self, i: usize, asked: &CaseValues) -> Result<(), EnvError> {
        let request = self.task().request(asked);
        self.request(i, request)
    }

    fn reset(&mut self, mask: &[bool]) -> Result<(), EnvError> {
        self.reset(mask)
    }

    fn step(&mut self, actions: &[f32]) -> Result<(), EnvError> {
        self.step(actions)
    }

    fn save(&self, i: usize) -> Result<Vec<u8>, EnvError> {
        self.save(i)
    }

    fn save_final(&self, i: usize) -> Result<Option<Vec<u8>>, EnvError> {
        self.save_final(i)
    }

    fn load(&mut self, i: usize, bytes: &[u8]) -> Result<(), EnvError> {
        self.load(i, bytes)
    }

    fn state_hash(&self, i: usize) -> Result<u64, EnvError> {
        snapshot::hash(&**self.task(), self.state(i)?)
    }

    fn case(&self, i: usize) -> Result<CaseValues, EnvError> {
        Ok(self.task().case(self.state(i)?))
    }

    fn trail(&self, i: usize) -> Result<Vec<[f64; 2]>, EnvError> {
        Ok(self.task().trail(self.state(i)?))
    }

    fn moments(&self, i: usize) -> Result<usize, EnvError> {
        Ok(self.task().moments(self.state(i)?))
    }

    fn visible(&self, i: usize) -> Result<Option<Visible>, EnvError> {
        Ok(self.task().visible(self.state(i)?))
    }

    fn picture(
        &self,
        i: usize,
        view: View,
        size: [u32; 2],
        frame: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        self.task().picture(self.state(i)?, view, size, frame)
    }

    fn final_picture(
        &self,
        i: usize,
        view: View,
        size: [u32; 2],
    ) -> Result<Option<RgbImage>, EnvError> {
        let ended = self.final_episodes().nth(i).flatten();
        let draw = |state| self.task().picture(state, view, size, None);
        ended.map(|ended| draw(&ended.state)).transpose()
    }
}
