#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

mod block;
pub mod covariance;
pub mod error;
pub mod generator;
pub mod maps;

pub use covariance::{Association, CovarianceConfig};
pub use error::BrainError;
pub use generator::{TimeBaseGenerator, place};
pub use maps::{ConjunctiveMap, MapConfig, PopulationMap};
