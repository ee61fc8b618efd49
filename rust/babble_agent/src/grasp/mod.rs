//! The paper's agent of grasping (Sect. IV): babbling with the object in the hand, and four maps.

pub mod babbling;
pub mod holding;
mod network;
mod store;

pub use babbling::{Experience, GraspBabbling, HandPosture};
pub use network::{GraspHebb, GraspHebbConfig, Recalled};
pub use store::{Metadata, load, save};
