//! Threads that belong to one owner and survive a fork.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::EnvError;

/// A pool of threads, started at first use.
///
/// A forked child does not have its parent's threads; the pool notices and starts new ones.
#[derive(Debug)]
pub struct Pool {
    threads: usize,
    started: Option<(u32, ThreadPool)>,
}

impl Pool {
    /// A pool of `threads` threads.
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
        })
    }

    /// How many threads there are.
    #[must_use]
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// Runs `work` with rayon's parallel iterators bound to this pool.
    ///
    /// # Errors
    /// [`EnvError::Threads`] when the system gives no threads.
    pub fn run<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> Result<T, EnvError> {
        let process = std::process::id();
        if let Some((_, dead)) = self.started.take_if(|(owner, _)| *owner != process) {
            // Its threads live in the parent; dropping it here could wait for them.
            std::mem::forget(dead);
        }
        if self.started.is_none() {
            let pool = ThreadPoolBuilder::new()
                .num_threads(self.threads)
                .thread_name(|i| format!("babble-{i}"))
                .build()
                .map_err(|error| EnvError::Threads {
                    threads: self.threads,
                    problem: error.to_string(),
                })?;
            self.started = Some((process, pool));
        }
        match &self.started {
            Some((_, pool)) => Ok(pool.install(work)),
            None => Ok(work()),
        }
    }
}
