//! A value that several threads know, kept from being used by two of them at once. No thread waits:
//! the later one is refused.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};

static THREADS: AtomicU64 = AtomicU64::new(1);

thread_local! {
    /// Number of this thread; 0 is none.
    static THREAD: u64 = THREADS.fetch_add(1, Ordering::Relaxed);
}

/// Bits of an admission that count the users; those above are the keeper's number.
const USER_BITS: u32 = 24;
/// Instead of a count: one thread changes the value.
const WRITING: u64 = (1 << USER_BITS) - 1;

/// Why a thread cannot use the value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// Another thread uses it, or keeps it to itself.
    Busy,
    /// A thread panicked while it changed the value.
    Poisoned,
}

/// A value that threads may read together and change one at a time, and that a thread may keep to
/// itself over several calls.
///
/// One atomic number says who keeps the value and how many use it, so that no thread can come between
/// the question and the answer. The lock lends the value, and is always free for those admitted.
#[derive(Debug)]
pub struct Guarded<T> {
    value: RwLock<T>,
    admission: AtomicU64,
    /// How many times over the keeper keeps it.
    depth: AtomicU32,
}

impl<T> Guarded<T> {
    /// A value that no thread uses yet.
    pub const fn new(value: T) -> Self {
        Self {
            value: RwLock::new(value),
            admission: AtomicU64::new(0),
            depth: AtomicU32::new(0),
        }
    }

    /// The value, which others may read meanwhile.
    ///
    /// # Errors
    /// [`Refusal`] while another thread changes or keeps it, or after a panic.
    pub fn read(&self) -> Result<impl Deref<Target = T> + '_, Refusal> {
        let visit = self.visit(1, |users| users < WRITING - 1)?;
        let value = self.value.try_read().map_err(|error| refusal(&error))?;
        Ok(Reading {
            value,
            _visit: visit,
        })
    }

    /// The value, to be changed.
    ///
    /// # Errors
    /// [`Refusal`] while another thread reads, changes or keeps it, or after a panic.
    pub fn write(&self) -> Result<impl DerefMut<Target = T> + '_, Refusal> {
        let visit = self.visit(WRITING, |users| users == 0)?;
        let value = self.value.try_write().map_err(|error| refusal(&error))?;
        Ok(Writing {
            value,
            _visit: visit,
        })
    }

    /// Keeps the value to this thread until as many calls of [`Self::leave`].
    ///
    /// # Errors
    /// [`Refusal::Busy`] while another thread reads, changes or keeps it.
    pub fn enter(&self) -> Result<(), Refusal> {
        let this = THREAD.with(|number| *number);
        self.admit(|keeper, users| match keeper {
            0 if users == 0 => Some(this << USER_BITS),
            _ if keeper == this => Some(keeper << USER_BITS | users),
            _ => None,
        })?;
        self.depth.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    /// Undoes [`Self::enter`], in the same thread.
    pub fn leave(&self) {
        if self.depth.fetch_sub(1, Ordering::Relaxed) == 1 {
            self.admission.fetch_and(WRITING, Ordering::Release);
        }
    }

    /// Counts `weight` more users if no other thread keeps the value and the count so far `allows` it.
    fn visit(&self, weight: u64, allows: impl Fn(u64) -> bool) -> Result<Visit<'_>, Refusal> {
        let this = THREAD.with(|number| *number);
        self.admit(|keeper, users| {
            let admitted = (keeper == 0 || keeper == this) && allows(users);
            admitted.then_some(keeper << USER_BITS | (users + weight))
        })?;
        Ok(Visit {
            admission: &self.admission,
            weight,
        })
    }

    /// Replaces keeper and users by what `next` says; refused where it says nothing.
    fn admit(&self, next: impl Fn(u64, u64) -> Option<u64>) -> Result<(), Refusal> {
        let replaced = self
            .admission
            .fetch_update(Ordering::Acquire, Ordering::Relaxed, |now| {
                next(now >> USER_BITS, now & WRITING)
            });
        replaced.map(|_| ()).map_err(|_| Refusal::Busy)
    }
}

/// One use of the value.
struct Visit<'a> {
    admission: &'a AtomicU64,
    weight: u64,
}

impl Drop for Visit<'_> {
    fn drop(&mut self) {
        self.admission.fetch_sub(self.weight, Ordering::Release);
    }
}

/// The value while it is read. The lock is released before the visit ends: fields drop in this order.
struct Reading<'a, T> {
    value: RwLockReadGuard<'a, T>,
    _visit: Visit<'a>,
}

impl<T> Deref for Reading<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// The same while it is changed.
struct Writing<'a, T> {
    value: RwLockWriteGuard<'a, T>,
    _visit: Visit<'a>,
}

impl<T> Deref for Writing<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Writing<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

fn refusal<G>(error: &TryLockError<G>) -> Refusal {
    match error {
        TryLockError::WouldBlock => Refusal::Busy,
        TryLockError::Poisoned(_) => Refusal::Poisoned,
    }
}
