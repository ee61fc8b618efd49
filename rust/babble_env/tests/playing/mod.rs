//! Tasks, batches and random actions that the tests share.
#![allow(dead_code, reason = "no test needs all of it")]

pub(crate) mod golden;
pub(crate) mod grasping;

use std::sync::Arc;

use babble_env::batch::Record;
use babble_env::{
    Autoreset, Batch, Config, Control, Purpose, ReachOptions, ReachTask, Reward, Stream, Task,
};

/// Options with that control, else the default ones.
pub(crate) fn control(control: Control) -> ReachOptions {
    ReachOptions {
        control,
        ..ReachOptions::default()
    }
}

/// Options of the goal form.
pub(crate) fn goal(control: Control) -> ReachOptions {
    ReachOptions {
        control,
        goal: true,
        reward: Reward::Sparse,
        ..ReachOptions::default()
    }
}

pub(crate) fn task(options: ReachOptions) -> Arc<ReachTask> {
    Arc::new(ReachTask::new(Config::profile("paper").unwrap(), options).unwrap())
}

/// n environments of reaching, reset from the seeds `seed`, `seed` + 1, …
pub(crate) fn batch(
    options: ReachOptions,
    n: usize,
    autoreset: Autoreset,
    threads: usize,
    seed: u64,
) -> Batch<ReachTask> {
    seeded(task(options), n, autoreset, threads, seed)
}

/// n environments of any task, reset from the seeds `seed`, `seed` + 1, …
pub(crate) fn seeded<T: Task>(
    task: Arc<T>,
    n: usize,
    autoreset: Autoreset,
    threads: usize,
    seed: u64,
) -> Batch<T> {
    let mut batch = Batch::new(task, n, autoreset, threads).unwrap();
    for i in 0..n {
        batch.seed(i, seed + i as u64).unwrap();
    }
    batch.reset(&vec![true; n]).unwrap();
    batch
}

/// A stream of actions, a little beyond their bounds.
pub(crate) struct Actions {
    streams: Vec<Stream>,
    width: usize,
}

impl Actions {
    /// One stream of reaching's actions for each of n environments.
    pub(crate) fn new(n: usize) -> Self {
        Self::of_width(n, 2)
    }

    /// One stream for each of n environments, `width` numbers an action; that of environment i is
    /// the same for any n.
    pub(crate) fn of_width(n: usize, width: usize) -> Self {
        let stream = |i| Stream::new(Purpose::Policy, 77, i);
        Self {
            streams: (0..n as u64).map(stream).collect(),
            width,
        }
    }

    pub(crate) fn draw(&mut self) -> Vec<f32> {
        let width = self.width;
        let mut action = |stream: &mut Stream| {
            vec![(); width]
                .into_iter()
                .map(|()| stream.uniform(-1.1, 1.1) as f32)
                .collect::<Vec<_>>()
        };
        self.streams.iter_mut().flat_map(&mut action).collect()
    }
}

/// What a batch of one shows.
pub(crate) fn record<T: Task>(batch: &Batch<T>) -> Record {
    batch.records().next().unwrap().clone()
}

/// Whether that step was an episode's last.
pub(crate) fn ended(record: &Record) -> bool {
    record.step.terminated || record.step.truncated
}

/// Everything that a batch holds and shows.
pub(crate) fn bits<T: Task>(batch: &Batch<T>) -> (Vec<Vec<u8>>, Vec<Record>) {
    let states = (0..batch.len()).map(|i| batch.save(i).unwrap()).collect();
    (states, batch.records().cloned().collect())
}
