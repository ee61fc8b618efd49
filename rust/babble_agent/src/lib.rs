#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod babbling;
mod error;
pub mod grasp;
pub mod hebb;
pub mod reference;
pub mod store;
mod tensors;

pub use babbling::{Babbling, Experience};
pub use error::AgentError;
pub use hebb::{Hebb, HebbConfig, Variant};
