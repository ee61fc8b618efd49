#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod batch;
mod check;
mod choice;
pub mod config;
mod error;
pub mod grasp;
pub mod options;
mod outcome;
pub mod picture;
mod pool;
pub mod reach;
pub mod snapshot;
pub mod spec;
pub mod stream;
pub mod task;

pub use batch::{Autoreset, Batch};
pub use config::Config;
pub use error::EnvError;
pub use grasp::{GraspCase, GraspOptions, GraspTask};
pub use options::{Control, Reward};
pub use outcome::Outcome;
pub use pool::{Pool, Stop};
pub use reach::{Movement, MovementPath, Options, ReachCase, ReachTask};
pub use stream::{Purpose, Stream};
pub use task::Task;
