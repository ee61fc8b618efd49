//! Frames, solids, distances between them, and mass properties.

pub mod frame;
pub mod mass;
pub mod obstacle;
pub(crate) mod separation;
pub mod solid;
