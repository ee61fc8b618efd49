//! Threads that belong to one owner, survive a fork and can be interrupted.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::EnvError;

/// Time between two questions whether to go on: short for a person, long for the interpreter, whose
/// lock an answer may have to wait for.
const PATIENCE: Duration = Duration::from_millis(50);
/// Items between two looks at the clock.
const STRIDE: usize = 16;

/// Tells work that it was interrupted.
#[derive(Debug, Default)]
pub struct Stop(AtomicBool);

impl Stop {
    /// Whether to go on.
    ///
    /// # Errors
    /// [`EnvError::Interrupted`] once it was interrupted.
    pub fn check(&self) -> Result<(), EnvError> {
        if self.0.load(Ordering::Relaxed) {
            return Err(EnvError::Interrupted);
        }
        Ok(())
    }
}

/// A pool of threads, started at first use.
///
/// A forked child does not have its parent's threads; the pool notices and starts new ones.
#[derive(Debug)]
pub struct Executor {
    threads: usize,
    started: Option<(u32, ThreadPool)>,
    interrupted: fn() -> bool,
}

impl Executor {
    /// A pool of `threads` threads that nothing interrupts.
    ///
    /// # Errors
    /// [`EnvError::OutOfBounds`] for no threads or more than 1024.
    pub fn new(threads: usize) -> Result<Self, EnvError> {
        if !(1..=1024).contains(&threads) {
            return Err(EnvError::OutOfBounds {
                option: "threads",
                value: threads.to_string(),
                bound: "in [1, 1024]".to_owned(),
            });
        }
        Ok(Self {
            threads,
            started: None,
            interrupted: || false,
        })
    }

    /// The same with long work interrupted when `interrupted` says so. It is asked every 50 ms, in the
    /// thread that waits for the work.
    #[must_use]
    pub fn interrupted_by(mut self, interrupted: fn() -> bool) -> Self {
        self.interrupted = interrupted;
        self
    }

    /// How many threads there are.
    #[must_use]
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// Runs `work` to its end with rayon's parallel iterators bound to this pool.
    ///
    /// # Errors
    /// [`EnvError::Threads`] when the system gives no threads.
    pub fn run<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> Result<T, EnvError> {
        Ok(self.start()?.install(work))
    }

    /// Runs `work` likewise, until it is interrupted: it should end soon after [`Stop::check`] says
    /// so.
    ///
    /// # Errors
    /// As [`Self::run`]; [`EnvError::Interrupted`], also if the work was done by then.
    pub fn run_until<T: Send>(
        &mut self,
        work: impl FnOnce(&Stop) -> T + Send,
    ) -> Result<T, EnvError> {
        let interrupted = self.interrupted;
        let pool = self.start()?;
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
                            stop.0.store(true, Ordering::Relaxed);
                        }
                    }
                    // The work panicked, and so will the scope.
                    Err(RecvTimeoutError::Disconnected) => return Err(EnvError::Interrupted),
                }
            }
        });
        stop.check().and(result)
    }

    /// The results of `each` for all indices, in their order.
    ///
    /// # Errors
    /// One of those of `each`, after which some were not called; [`EnvError::Interrupted`]; or as
    /// [`Self::run`].
    pub fn map<T: Send, E: From<EnvError> + Send>(
        &mut self,
        indices: std::ops::Range<usize>,
        each: impl Fn(usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        self.run_until(|stop| {
            indices
                .into_par_iter()
                .map(|i| {
                    stop.check()?;
                    each(i)
                })
                .collect::<Result<Vec<T>, E>>()
        })?
    }

    /// Does `each` to all items, with their places; to at least `least` of them in a thread.
    ///
    /// # Errors
    /// The first error in the order of the items, after which all of them are done;
    /// [`EnvError::Interrupted`], after which only some are; or as [`Self::run`].
    pub fn for_each<S: Send>(
        &mut self,
        items: &mut [S],
        least: usize,
        each: impl Fn(usize, &mut S) -> Result<(), EnvError> + Sync,
    ) -> Result<(), EnvError> {
        if let [item] = items {
            return each(0, item);
        }
        if self.threads == 1 || items.len() <= least {
            return self.in_turn(items.iter_mut(), each);
        }
        let first = self.run_until(|stop| {
            items
                .par_iter_mut()
                .with_min_len(least)
                .enumerate()
                .filter_map(|(i, item)| {
                    let done = stop.check().and_then(|()| each(i, item));
                    done.err().map(|error| (i, error))
                })
                .min_by_key(|&(i, _)| i)
        })?;
        first.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The same, one after the other in the thread that calls: none is started for it.
    ///
    /// # Errors
    /// As [`Self::for_each`].
    pub fn in_turn<S>(
        &self,
        items: impl IntoIterator<Item = S>,
        mut each: impl FnMut(usize, S) -> Result<(), EnvError>,
    ) -> Result<(), EnvError> {
        let mut first = Ok(());
        let mut asked = Instant::now();
        for (i, item) in items.into_iter().enumerate() {
            if i % STRIDE == STRIDE - 1 && asked.elapsed() >= PATIENCE {
                if (self.interrupted)() {
                    return Err(EnvError::Interrupted);
                }
                asked = Instant::now();
            }
            first = first.and(each(i, item));
        }
        first
    }

    fn start(&mut self) -> Result<&ThreadPool, EnvError> {
        self.forget_lost();
        let started = match self.started.take() {
            Some(started) => started,
            None => (std::process::id(), threads(self.threads)?),
        };
        Ok(&self.started.insert(started).1)
    }

    /// Lets go of threads that a fork left in the parent: to wake them, as a drop does, could wait
    /// forever for a lock that one of them holds.
    fn forget_lost(&mut self) {
        let process = std::process::id();
        if let Some((_, lost)) = self.started.take_if(|(owner, _)| *owner != process) {
            std::mem::forget(lost);
        }
    }
}

impl Drop for Executor {
    fn drop(&mut self) {
        self.forget_lost();
    }
}

fn threads(n: usize) -> Result<ThreadPool, EnvError> {
    ThreadPoolBuilder::new()
        .num_threads(n)
        .thread_name(|i| format!("babble-{i}"))
        .build()
        .map_err(|error| EnvError::Threads {
            threads: n,
            problem: error.to_string(),
        })
}
