//! Grasping an object (Sect. IV).

pub mod case;
mod check;
pub mod config;
mod enclosure;
mod entry;
mod episode;
mod face;
mod in_hand;
mod options;
mod palm;
mod picture;
pub mod protocol;
mod sight;
mod spec;
mod state;
mod task;

pub use case::{GraspCase, GraspRequest, ObjectPlace};
pub use config::{GraspConfig, RegionConfig};
pub use enclosure::{Contacts, Enclosure, Grip};
pub(crate) use entry::ENTRY;
pub use episode::Potential;
pub use in_hand::InHand;
pub use options::{GraspOptions, Region};
pub use sight::{FOVEA_NEURONS, see};
pub use state::{FACTS, GraspState, SENSES, at};
pub use task::GraspTask;
