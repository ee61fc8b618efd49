//! A point that moves to a target in the plane: the smallest task, by which tests see that a task needs
//! one folder and one line in the registry. It is part of development builds alone.

mod entry;
mod episode;
mod face;
mod task;

pub(crate) use entry::ENTRY;
pub use episode::{PointState, TargetRequest};
pub use task::PointTask;
