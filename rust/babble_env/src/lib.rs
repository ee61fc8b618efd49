#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod batch;
mod check;
mod choice;
pub mod config;
mod error;
pub mod options;
mod outcome;
pub mod picture;
mod pool;
pub mod snapshot;
pub mod spec;
pub mod stream;
pub mod task;
pub mod tasks;

pub use batch::{Autoreset, Batch};
pub use config::Config;
pub use error::EnvError;
pub use options::{Control, Reward};
pub use outcome::Outcome;
pub use pool::{Pool, Stop};
pub use stream::{Purpose, Stream};
pub use task::Task;
pub use tasks::grasp::{GraspCase, GraspOptions, GraspTask};
pub use tasks::reach::{Movement, MovementPath, Options, ReachCase, ReachTask};
