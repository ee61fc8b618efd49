#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod arm;
pub mod config;
pub mod description;
mod error;
pub mod geometry;
pub mod joints;
mod profiles;
pub mod robot;
pub mod skeleton;
mod validate;
pub mod visual;

pub use arm::{ArmState, ContactWatch, Dynamics, PlanarArm, Pull};
pub use config::Body;
pub use error::BodyError;
pub use geometry::obstacle::Obstacle;
pub use robot::Robot;
