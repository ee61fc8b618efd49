//! Threads behind an executor: rayon's pools, clocks and process ids.

use std::ops::Range;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::{Executor, Stop};
use crate::error::EnvError;

/// Time between two questions whether to go on: short for a person, long for the interpreter, whose
/// lock an answer may have to wait for.
pub(super) const PATIENCE: Duration = Duration::from_millis(50);

/// Threads of one process, started at first use.
#[derive(Debug, Default)]
pub(super) struct Threads(Option<(u32, ThreadPool)>);

impl Executor {
    /// Runs `work` to its end with rayon's parallel iterators bound to this pool.
    ///
    /// # Errors
    /// [`EnvError::Threads`] when the system gives no threads.
    pub fn run<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> Result<T, EnvError> {
        Ok(self.pool.start(self.threads)?.install(work))
    }

    /// Runs `work` likewise, until it is interrupted: it should end soon after [`Stop::check`] says
    /// so.
    ///
    /// # Errors
    /// As [`Self::run`]; [`EnvError::Interrupted`], also if the work was done by then.
    pub fn run_until<T: Send>(
        &mut self,
        work: impl FnOnce(&Stop<'_>) -> T + Send,
    ) -> Result<T, EnvError> {
        let interrupted = self.interrupted;
        // Work in many short parts is interrupted between them.
        self.check()?;
        let pool = self.pool.start(self.threads)?;
        let stop = &Stop::default();
        let (sender, receiver) = channel();
        let result = pool.in_place_scope(|scope| {
            scope.spawn(move |_| {
                // The receiver waits below for as long as this runs.
                let _ = sender.send(work(stop));
            });
            loop {
                match receiver.recv_timeout(PATIENCE) {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Timeout) => {
                        if stop.check().is_ok() && interrupted() {
                            stop.interrupt();
                        }
                    }
                    // The work panicked, and so will the scope.
                    Err(RecvTimeoutError::Disconnected) => return Err(EnvError::Interrupted),
                }
            }
        });
        stop.check().and(result)
    }
}

impl Threads {
    fn start(&mut self, threads: usize) -> Result<&ThreadPool, EnvError> {
        self.forget_lost();
        let started = match self.0.take() {
            Some(started) => started,
            None => (std::process::id(), build(threads)?),
        };
        Ok(&self.0.insert(started).1)
    }

    /// Lets go of threads that a fork left in the parent: to wake them, as a drop does, could wait
    /// forever for a lock that one of them holds.
    fn forget_lost(&mut self) {
        let process = std::process::id();
        if let Some((_, lost)) = self.0.take_if(|(owner, _)| *owner != process) {
            std::mem::forget(lost);
        }
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        self.forget_lost();
    }
}

/// As [`Executor::map`], in the current pool.
pub(super) fn map<T: Send, E: From<EnvError> + Send>(
    indices: Range<usize>,
    stop: &Stop<'_>,
    each: impl Fn(usize, &Stop<'_>) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let one = |i| {
        stop.check()?;
        each(i, stop)
    };
    indices.into_par_iter().map(one).collect()
}

/// As [`Executor::for_each`], in the current pool.
pub(super) fn for_each<S: Send>(
    items: &mut [S],
    least: usize,
    stop: &Stop<'_>,
    each: impl Fn(usize, &mut S, &Stop<'_>) -> Result<(), EnvError> + Sync,
) -> Result<(), EnvError> {
    let first = items
        .par_iter_mut()
        .with_min_len(least)
        .enumerate()
        .filter_map(|(i, item)| {
            let done = stop.check().and_then(|()| each(i, item, stop));
            done.err().map(|error| (i, error))
        })
        .min_by_key(|&(i, _)| i);
    first.map_or(Ok(()), |(_, error)| Err(error))
}

fn build(threads: usize) -> Result<ThreadPool, EnvError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|i| format!("babble-{i}"))
        .build()
        .map_err(|error| EnvError::Threads {
            threads,
            problem: error.to_string(),
        })
}
