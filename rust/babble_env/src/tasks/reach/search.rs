//! The search for a random case, which ends: some configs leave no room for any.

use super::task::ReachTask;
use crate::error::EnvError;
use crate::executor::Stop;

/// Most geometries that are drawn: a second of work.
const MOST_DRAWN: u32 = 1_000_000;
/// Physics steps that all movements together may take: a second of work.
const MOST_STEPS: usize = 20_000_000;
/// Movements that are tried however long they are, and however short.
const FEWEST_PLAYED: usize = 200;
const MOST_PLAYED: usize = 10_000;
/// Draws until it is asked whether to go on.
const STRIDE: u32 = 64;

/// What a search has cost.
#[derive(Debug)]
pub(super) struct Search<'a> {
    stop: &'a Stop<'a>,
    drawn: u32,
    played: u32,
    most_played: u32,
}

impl<'a> Search<'a> {
    pub(super) fn new(task: &ReachTask, stop: &'a Stop<'a>) -> Self {
        let steps = task.movement_physics_steps();
        Self {
            stop,
            drawn: 0,
            played: 0,
            most_played: (MOST_STEPS / steps).clamp(FEWEST_PLAYED, MOST_PLAYED) as u32,
        }
    }

    /// Counts one more geometry.
    ///
    /// # Errors
    /// [`EnvError::NoLegalCase`] when it would be one too many; [`EnvError::Interrupted`].
    pub(super) fn draw(&mut self) -> Result<(), EnvError> {
        if self.drawn == MOST_DRAWN {
            return Err(self.failed());
        }
        if self.drawn.is_multiple_of(STRIDE) {
            self.stop.check()?;
        }
        self.drawn += 1;
        Ok(())
    }

    /// Counts one more movement.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub(super) fn play(&mut self) -> Result<(), EnvError> {
        if self.played == self.most_played {
            return Err(self.failed());
        }
        self.stop.check()?;
        self.played += 1;
        Ok(())
    }

    fn failed(&self) -> EnvError {
        EnvError::NoLegalCase {
            drawn: self.drawn,
            played: self.played,
        }
    }
}
