#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod batch;
mod bounds;
pub mod case;
mod check;
pub mod config;
mod document;
pub mod episode;
pub mod erased;
mod error;
mod executor;
pub mod guarded;
mod named_enum;
mod near;
pub mod noise;
pub mod option_spec;
pub mod options;
mod outcome;
pub mod picture;
pub mod progress;
pub mod registry;
pub mod seeding;
pub mod snapshot;
pub mod spec;
pub mod stream;
pub mod task;
pub mod tasks;

pub use batch::{Autoreset, Batch};
pub use case::{CaseValue, CaseValues};
pub use config::Config;
pub use document::Document;
pub use episode::Episode;
pub use erased::{AnyBatch, AnyTask, downcast};
pub use error::EnvError;
pub use executor::{Executor, Stop};
pub use near::nearest;
pub use option_spec::Options;
pub use options::{Control, Reward};
pub use outcome::Outcome;
pub use registry::make;
pub use stream::{Purpose, Stream};
pub use task::Task;
pub use tasks::grasp::{GraspCase, GraspOptions, GraspTask};
pub use tasks::reach::{Movement, MovementPath, ReachCase, ReachOptions, ReachTask};
