//! The paper's agent of reaching (Sect. III), and choices of a movement that need no learning.

pub mod babbling;
mod network;
pub mod policy;
pub mod reference;

pub use babbling::{Experience, ReachBabbling};
pub use network::{ReachBrain, ReachNetwork, Variant};
