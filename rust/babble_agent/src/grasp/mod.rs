//! The paper's agent of grasping (Sect. IV): babbling with the object in the hand, and four maps; and
//! how well the reflex holds.

pub mod approach;
pub mod babbling;
pub mod holding;
mod network;
mod oracle;
pub mod policy;

pub use approach::ElbowApproach;
pub use babbling::{Experience, GraspBabbling, HandPosture};
pub use network::{GraspBrain, GraspNetwork, Recalled};
pub use oracle::Oracle;
