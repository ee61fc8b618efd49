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

/// When the calling thread asks, and whom.
type Asked<'a> = (&'a Clock, fn() -> bool);

/// Tells work that it was interrupted.
#[derive(Debug, Default)]
pub struct Stop<'a> {
    interrupted: AtomicBool,
    /// Who is asked in the thread that calls. In other threads that thread asks meanwhile.
    asked: Option<Asked<'a>>,
}

impl<'a> Stop<'a> {
    /// For work in the thread that calls.
    const fn asking(clock: &'a Clock, interrupted: fn() -> bool) -> Self {
        Self {
            interrupted: AtomicBool::new(false),
            asked: Some((clock, interrupted)),
        }
    }

    fn interrupt(&self) {
        self.interrupted.store(true, Ordering::Relaxed);
    }

    /// Whether to go on. Work that may take long asks at least once a millisecond.
    ///
    /// # Errors
    /// [`EnvError::Interrupted`] once it was interrupted.
    pub fn check(&self) -> Result<(), EnvError> {
        if let Some((clock, interrupted)) = self.asked
            && clock.is_due()
            && interrupted()
        {
            self.interrupt();
        }
        if self.interrupted.load(Ordering::Relaxed) {
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

    /// Whether to go on, for work in the thread that calls: it asks at least once a second.
    ///
    /// # Errors
    /// [`EnvError::Interrupted`] once it was interrupted.
    pub fn check(&self) -> Result<(), EnvError> {
        Stop::asking(&self.clock, self.interrupted).check()
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
        each: impl Fn(usize, &Stop<'_>) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        #[cfg(feature = "threads")]
        if self.threads > 1 {
            let each = &each;
            return self.run_until(move |stop| threads::map(indices, stop, each))?;
        }
        let stop = Stop::asking(&self.clock, self.interrupted);
        let mut results = Vec::with_capacity(indices.len());
        for i in indices {
            stop.check()?;
            results.push(each(i, &stop)?);
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
        each: impl Fn(usize, &mut S, &Stop<'_>) -> Result<(), EnvError> + Sync,
    ) -> Result<(), EnvError> {
        if let [item] = items {
            return each(0, item, &Stop::asking(&self.clock, self.interrupted));
        }
        #[cfg(feature = "threads")]
        if self.threads > 1 && items.len() > least {
            let each = &each;
            return self.run_until(move |stop| threads::for_each(items, least, stop, each))?;
        }
        let _ = least;
        let stop = Stop::asking(&self.clock, self.interrupted);
        self.in_turn(items.iter_mut(), |i, item| each(i, item, &stop))
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
        let clock = Clock::default();
        let stop = Stop::asking(&clock, self.interrupted);
        for (i, item) in items.into_iter().enumerate() {
            if i % STRIDE == STRIDE - 1 {
                stop.check()?;
            }
            let done = each(i, item);
            if done == Err(EnvError::Interrupted) {
                return done;
            }
            first = first.and(done);
        }
        first
    }
}

/// When it was last asked whether to go on; without threads there is no clock, and it is asked always.
#[derive(Debug)]
struct Clock {
    #[cfg(feature = "threads")]
    began: std::time::Instant,
    /// Since then \[ms\].
    #[cfg(feature = "threads")]
    asked: std::sync::atomic::AtomicU64,
}

#[cfg_attr(
    not(feature = "threads"),
    expect(clippy::derivable_impls, reason = "no instant is a default")
)]
impl Default for Clock {
    fn default() -> Self {
        Self {
            #[cfg(feature = "threads")]
            began: std::time::Instant::now(),
            #[cfg(feature = "threads")]
            asked: 0.into(),
        }
    }
}

impl Clock {
    /// Whether it is time to ask again.
    #[cfg_attr(
        not(feature = "threads"),
        expect(clippy::unused_self, reason = "there is no clock")
    )]
    fn is_due(&self) -> bool {
        #[cfg(feature = "threads")]
        {
            let now = self.began.elapsed().as_millis() as u64;
            if now - self.asked.load(Ordering::Relaxed) < PATIENCE.as_millis() as u64 {
                return false;
            }
            self.asked.store(now, Ordering::Relaxed);
        }
        true
    }
}
