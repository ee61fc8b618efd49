//! Tasks, batches and random actions that the tests share.
#![allow(dead_code, reason = "no test needs all of it")]

use std::sync::Arc;

use babble_env::batch::Record;
use babble_env::{Autoreset, Batch, Config, Control, Options, Purpose, ReachTask, Reward, Stream};

/// Options with that control, else the default ones.
pub(crate) fn control(control: Control) -> Options {
    Options {
        control,
        ..Options::default()
    }
}

/// Options of the goal form.
pub(crate) fn goal(control: Control) -> Options {
    Options {
        control,
        goal: true,
        reward: Reward::Sparse,
        ..Options::default()
    }
}

pub(crate) fn task(options: Options) -> Arc<ReachTask> {
    Arc::new(ReachTask::new(Config::profile("paper").unwrap(), options).unwrap())
}

/// n environments, reset from the seeds `seed`, `seed` + 1, …
pub(crate) fn batch(
    options: Options,
    n: usize,
    autoreset: Autoreset,
    threads: usize,
    seed: u64,
) -> Batch<ReachTask> {
    let mut batch = Batch::new(task(options), n, autoreset, threads).unwrap();
    for i in 0..n {
        batch.seed(i, seed + i as u64).unwrap();
    }
    batch.reset(&vec![true; n]).unwrap();
    batch
}

/// A stream of actions, a little beyond their bounds.
pub(crate) struct Actions(Vec<Stream>);

impl Actions {
    /// One stream for each of n environments; that of environment i is the same for any n.
    pub(crate) fn new(n: usize) -> Self {
        Self(
            (0..n as u64)
                .map(|i| Stream::new(Purpose::Policy, 77, i))
                .collect(),
        )
    }

    pub(crate) fn draw(&mut self) -> Vec<f32> {
        let mut pair = |stream: &mut Stream| [0, 1].map(|_| stream.uniform(-1.1, 1.1) as f32);
        self.0.iter_mut().flat_map(&mut pair).collect()
    }
}

/// Everything that a batch holds and shows.
pub(crate) fn bits(batch: &Batch<ReachTask>) -> (Vec<Vec<u8>>, Vec<Record>) {
    let states = (0..batch.len()).map(|i| batch.save(i).unwrap()).collect();
    (states, batch.records().cloned().collect())
}
