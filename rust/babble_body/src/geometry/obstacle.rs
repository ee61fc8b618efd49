//! The vertical cylinder in the way.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// A vertical cylinder through the plane of motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Obstacle {
    /// Where its axis meets the plane \[m\].
    pub centre: Vector2<f64>,
    /// Its radius \[m\].
    pub radius: f64,
}
