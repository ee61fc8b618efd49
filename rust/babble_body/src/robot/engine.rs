//! What a physics engine has to do.

use super::mechanics::MechanicalState;
use super::muscles::MuscleCommands;
use crate::error::BodyError;

/// Earth's, downwards \[m/s²\]. It acts on the object alone: muscles compensate for it (Sect. II-B).
pub(super) const GRAVITY: f64 = 9.81;

/// The most that a joint turns in a physics step \[rad\].
pub(super) const FASTEST_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// A physics engine for one robot and one size of step. It never changes; what changes is a world's
/// mechanical state, which all engines share, and the engine's own state of that world.
pub(super) trait Engine {
    /// What the engine keeps of a world beside its mechanical state.
    type State;

    /// The engine's state of a world that begins at rest.
    fn start(&self, mechanics: &MechanicalState) -> Self::State;

    /// One physics step.
    fn step(
        &self,
        mechanics: &mut MechanicalState,
        state: &mut Self::State,
        commands: &MuscleCommands,
    );

    /// Checks an engine's state that came from outside, and completes what was not written of it. The
    /// world began as `start`, at most `steps` physics steps ago; its numbers are in bounds.
    ///
    /// # Errors
    /// [`BodyError::World`] naming what is wrong.
    fn restore(
        &self,
        mechanics: &MechanicalState,
        state: &mut Self::State,
        start: &MechanicalState,
        steps: u64,
    ) -> Result<(), BodyError>;
}
