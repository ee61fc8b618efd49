//! Reaching a target around an obstacle (Sect. III).

pub mod case;
mod check;
mod entry;
mod episode;
pub mod movement;
mod options;
mod picture;
pub mod protocol;
mod spec;
mod task;

pub use case::ReachCase;
pub(crate) use entry::ENTRY;
pub use episode::{Drawn, EVER_SUCCESS, IS_SUCCESS, Reach, ReachState, SENSES, goal_reward};
pub use movement::{Movement, MovementPath};
pub use options::{MAX_EPISODE_STEPS, ReachOptions};
pub use task::ReachTask;
