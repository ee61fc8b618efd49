#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod babbling;
pub mod chain;
pub mod erased;
mod error;
pub mod grasp;
pub mod learner;
pub mod mlp;
pub mod network;
pub mod policy;
pub mod reach;
pub mod rule;
pub mod tensors;

pub use babbling::{Babble, Babbling, babble};
pub use chain::{ChainBrain, ChainNetwork};
pub use erased::{AnyLearner, REFERENCES, reference};
pub use error::AgentError;
pub use grasp::{GraspBrain, GraspNetwork};
pub use learner::Learner;
pub use mlp::PolicyNetwork;
pub use network::{Activities, Network};
pub use policy::{Decisions, Plan, Policy, Random, predict};
pub use reach::{ReachBabbling, ReachBrain, ReachNetwork, Variant};
pub use rule::Rule;
