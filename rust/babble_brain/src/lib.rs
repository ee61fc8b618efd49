#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod association;
pub mod error;
pub mod generator;
pub mod maps;
pub mod rules;

pub use association::Association;
pub use error::BrainError;
pub use generator::{TimeBaseGenerator, place};
pub use maps::{ConjunctiveMap, MapConfig, PopulationMap};
pub use rules::{CovarianceRule, HebbRule, LearningRule, OjaRule, OutstarRule};
