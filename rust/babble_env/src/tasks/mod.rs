//! The tasks, each in a folder of its own.

pub mod grasp;
pub mod reach;
#[cfg(feature = "toy")]
pub mod toy;
