//! The state of a world: all that changes from one physics step to the next.

use serde::{Deserialize, Serialize};

use super::any_engine::EngineState;
use super::mechanics::MechanicalState;

/// Everything that moves, and what the next step needs of the last. A copy continues bit for bit, and
/// so does a world that was written and read again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct World {
    pub(super) mechanics: MechanicalState,
    /// What the engine keeps beside that.
    pub(super) engine: EngineState,
}
