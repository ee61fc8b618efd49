//! What an object holds, kept from being changed by two threads at once: they get an error, and
//! never wait.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::BusyError;

static THREADS: AtomicU64 = AtomicU64::new(1);

thread_local! {
    /// Number of this thread; 0 is none.
    static THREAD: u64 = THREADS.fetch_add(1, Ordering::Relaxed);
}

/// A value that threads may read together and change one at a time, and that a thread may keep to
/// itself over several calls.
#[derive(Debug)]
pub(crate) struct Guarded<T> {
    /// What errors call it.
    name: &'static str,
    value: RwLock<T>,
    /// The thread that keeps it to itself, and how many times over.
    keeper: AtomicU64,
    depth: AtomicU32,
}

impl<T> Guarded<T> {
    pub(crate) const fn new(name: &'static str, value: T) -> Self {
        Self {
            name,
            value: RwLock::new(value),
            keeper: AtomicU64::new(0),
            depth: AtomicU32::new(0),
        }
    }

    /// The value, which others may read meanwhile.
    pub(crate) fn read(&self) -> PyResult<RwLockReadGuard<'_, T>> {
        self.check_keeper()?;
        self.value.try_read().map_err(|error| self.refused(&error))
    }

    /// The value, to be changed.
    pub(crate) fn write(&self) -> PyResult<RwLockWriteGuard<'_, T>> {
        self.check_keeper()?;
        self.value.try_write().map_err(|error| self.refused(&error))
    }

    /// Keeps the value to this thread until as many calls of [`Self::leave`].
    pub(crate) fn enter(&self) -> PyResult<()> {
        let this = THREAD.with(|number| *number);
        let found = self
            .keeper
            .compare_exchange(0, this, Ordering::Acquire, Ordering::Relaxed);
        if found.is_err_and(|keeper| keeper != this) {
            return Err(self.busy());
        }
        self.depth.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    /// Undoes [`Self::enter`].
    pub(crate) fn leave(&self) {
        if self.depth.fetch_sub(1, Ordering::Relaxed) == 1 {
            self.keeper.store(0, Ordering::Release);
        }
    }

    fn check_keeper(&self) -> PyResult<()> {
        let keeper = self.keeper.load(Ordering::Relaxed);
        if keeper == 0 || keeper == THREAD.with(|number| *number) {
            return Ok(());
        }
        Err(self.busy())
    }

    fn refused<G>(&self, error: &TryLockError<G>) -> PyErr {
        match error {
            TryLockError::WouldBlock => self.busy(),
            TryLockError::Poisoned(_) => PyRuntimeError::new_err(format!(
                "this {} was left half-changed by an error in the core: make a new one",
                self.name
            )),
        }
    }

    fn busy(&self) -> PyErr {
        BusyError::new_err(format!(
            "this {0} is in use by another thread (or by the call that a signal's handler \
             interrupts, or it was in use when this process was forked): give each thread an {0} \
             of its own",
            self.name
        ))
    }
}
