//! Reaching a target around an obstacle (Sect. III).

pub mod case;
mod check;
pub mod config;
mod entry;
mod episode;
mod face;
pub mod movement;
mod options;
mod picture;
pub mod protocol;
pub mod request;
mod search;
mod spec;
mod state;
mod task;

pub use case::ReachCase;
pub use config::ReachConfig;
pub(crate) use entry::ENTRY;
pub use episode::{Drawn, Sight};
pub use movement::{Movement, MovementPath};
pub use options::{MAX_EPISODE_STEPS, ReachOptions};
pub use request::{CaseRequest, ObstacleRequest};
pub use state::{ReachState, SENSES, at};
pub use task::ReachTask;
