//! The robot that grasps, and its world: arm, hand, object, support and obstacle, moved by the
//! muscles of Eq. 2.
//!
//! [`Robot`] never changes; [`World`] is all that does. One of two engines steps a world: `tree`, made
//! for this robot, or `rapier`, a general one, its reference. Both implement the trait `Engine`.

mod any_engine;
mod check;
mod clearance;
mod contact_slots;
mod description;
mod engine;
mod kinematics;
mod links;
mod mechanics;
mod model;
mod muscles;
#[cfg(feature = "rapier")]
mod rapier;
mod setup;
mod touch;
mod tree;
mod visual;
mod world;

pub use model::Robot;
pub use muscles::{MuscleCommand, MuscleCommands, Posture, towards};
pub use setup::{Ball, Setup};
pub use touch::Touch;
pub use world::World;
