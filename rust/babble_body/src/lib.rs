#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod arm;
pub mod config;
pub mod description;
pub mod dynamics;
mod error;
pub mod joints;
pub mod mass;
pub mod obstacle;
pub mod robot;
pub mod skeleton;
pub mod visual;

pub use arm::PlanarArm;
pub use config::Body;
pub use dynamics::{ArmState, Dynamics};
pub use error::BodyError;
pub use obstacle::{ContactWatch, Obstacle};
pub use robot::Robot;
