//! Grasping an object (Sect. IV).

pub mod case;
mod check;
mod enclosure;
mod entry;
mod episode;
mod in_hand;
mod numbers;
mod options;
mod picture;
pub mod protocol;
mod sight;
mod spec;
mod task;

pub use case::{GraspCase, GraspRequest};
pub use enclosure::{Contacts, Enclosure, Grip};
pub(crate) use entry::ENTRY;
pub use episode::{Drawn, FACTS, Grasp, GraspState, goal_reward};
pub use in_hand::InHand;
pub use numbers::{GraspNumbers, RegionNumbers};
pub use options::{GraspOptions, Region};
pub use sight::{FOVEA_NEURONS, see};
pub use task::GraspTask;
