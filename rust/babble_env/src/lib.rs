#![doc = include_str!("../README.md")]

pub mod batch;
pub mod case;
mod choice;
pub mod config;
mod error;
pub mod movement;
pub mod options;
pub mod picture;
mod pool;
pub mod protocol;
pub mod reach;
pub mod snapshot;
pub mod spec;
pub mod stream;
pub mod task;

pub use batch::{Autoreset, Batch};
pub use case::ReachCase;
pub use config::Config;
pub use error::EnvError;
pub use movement::{Movement, MovementPath};
pub use options::{Control, Options, Outcome, Reward};
pub use pool::Pool;
pub use reach::Reach;
pub use stream::{Purpose, Stream};
pub use task::ReachTask;
