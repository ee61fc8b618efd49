//! How often the solver did not converge.

use std::sync::atomic::{AtomicU64, Ordering};

/// A count that threads add to. It says nothing of any world, and no step depends on it.
#[derive(Debug, Default)]
pub(super) struct Tally(AtomicU64);

impl Tally {
    /// One more.
    pub(super) fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// The count so far.
    pub(super) fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// A copy of an engine counts on from where it is.
impl Clone for Tally {
    fn clone(&self) -> Self {
        Self(self.count().into())
    }
}
