//! What stays the same between episodes of the toy task.

use crate::config::Config;
use crate::stream::Stream;

/// Params of the toy task.
#[derive(Debug, Clone)]
pub struct PointTask {
    /// The config it was made from, of which it needs nothing.
    pub config: Config,
    /// Time limit in steps.
    pub max_episode_steps: u32,
    /// Whether positions are recorded, for pictures.
    pub record: bool,
}

impl PointTask {
    /// A random position in the square of ±1 m.
    pub(super) fn sample(stream: &mut Stream) -> [f64; 2] {
        [0, 1].map(|_| stream.uniform(-1.0, 1.0))
    }
}
