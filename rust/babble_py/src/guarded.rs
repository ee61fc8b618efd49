//! What a Python object holds, and the errors of a thread that finds it in use.

use std::ops::{Deref, DerefMut};

use babble_env::guarded::{self, Refusal};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::BusyError;

/// [`babble_env::guarded::Guarded`], whose refusals are Python's exceptions.
#[derive(Debug)]
pub(crate) struct Guarded<T> {
    /// What errors call it.
    name: &'static str,
    value: guarded::Guarded<T>,
}

impl<T> Guarded<T> {
    pub(crate) const fn new(name: &'static str, value: T) -> Self {
        Self {
            name,
            value: guarded::Guarded::new(value),
        }
    }

    /// The value, which others may read meanwhile.
    pub(crate) fn read(&self) -> PyResult<impl Deref<Target = T> + '_> {
        self.value.read().map_err(|refusal| self.refused(refusal))
    }

    /// The value, to be changed.
    pub(crate) fn write(&self) -> PyResult<impl DerefMut<Target = T> + '_> {
        self.value.write().map_err(|refusal| self.refused(refusal))
    }

    /// Keeps the value to this thread until as many calls of [`Self::leave`].
    pub(crate) fn enter(&self) -> PyResult<()> {
        self.value.enter().map_err(|refusal| self.refused(refusal))
    }

    /// Undoes [`Self::enter`].
    pub(crate) fn leave(&self) {
        self.value.leave();
    }

    fn refused(&self, refusal: Refusal) -> PyErr {
        let name = self.name;
        match refusal {
            Refusal::Busy => BusyError::new_err(format!(
                "this {name} is in use by another thread (or by the call that a signal's handler \
                 interrupts, or it was in use when this process was forked): give each thread an \
                 {name} of its own"
            )),
            Refusal::Poisoned => PyRuntimeError::new_err(format!(
                "this {name} was left half-changed by an error in the core: make a new one"
            )),
        }
    }
}
