//! Where work is done: one after the other, or in threads that belong to one owner, survive a fork and
//! can be interrupted. Threads and clocks are behind the feature `threads`; without it the same calls
//! work in the calling thread, with the same results.

use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(feature = "threads")]
use self::threads::{PATIENCE, Threads};
use crate::error::EnvError;

#[cfg(feature = "threads")]
mod threads;

/// Items between two looks at the clock.
const STRIDE: usize = 16;

/// Tells work that it was interrupted.
#[derive(Debug, Default)]
pub struct Stop(AtomicBool);

impl Stop {
    #[cfg(feature = "threads")]
    fn interrupt(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

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

/// Does work in a number of threads, which are started at first use.
///
/// A forked child does not have its parent's threads; the executor notices and starts new ones.
#[derive(Debug)]
pub struct Executor {
    threads: usize,
    #[cfg(feature = "threads")]
    pool: Threads,
    interrupted: fn() -> bool,
    clock: Clock,
}

impl Executor {
    /// An executor with `threads` threads that nothing interrupts.
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
            #[cfg(feature = "threads")]
            pool: Threads::default(),
            interrupted: || false,
            clock: Clock::default(),
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
        #[cfg(feature = "threads")]
        if self.threads > 1 {
            let each = &each;
            return self.run_until(move |stop| threads::map(indices, stop, each))?;
        }
        let mut results = Vec::with_capacity(indices.len());
        for i in indices {
            self.clock.check(self.interrupted)?;
            results.push(each(i)?);
        }
        Ok(results)
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
        #[cfg(feature = "threads")]
        if self.threads > 1 && items.len() > least {
            let each = &each;
            return self.run_until(move |stop| threads::for_each(items, least, stop, each))?;
        }
        let _ = least;
        self.in_turn(items.iter_mut(), each)
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
        let mut clock = Clock::default();
        for (i, item) in items.into_iter().enumerate() {
            if i % STRIDE == STRIDE - 1 {
                clock.check(self.interrupted)?;
            }
            first = first.and(each(i, item));
        }
        first
    }
}

/// When it was last asked whether to go on; without threads there is no clock, and it is asked always.
#[derive(Debug)]
struct Clock {
    #[cfg(feature = "threads")]
    asked: std::time::Instant,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            #[cfg(feature = "threads")]
            asked: std::time::Instant::now(),
        }
    }
}

impl Clock {
    fn check(&mut self, interrupted: fn() -> bool) -> Result<(), EnvError> {
        #[cfg(feature = "threads")]
        {
            if self.asked.elapsed() < PATIENCE {
                return Ok(());
            }
            self.asked = std::time::Instant::now();
        }
        if interrupted() {
            return Err(EnvError::Interrupted);
        }
        Ok(())
    }
}
