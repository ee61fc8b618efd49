//! How a world begins.

use super::muscles::Posture;
use crate::geometry::obstacle::Obstacle;

/// A sphere that can be grasped.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ball {
    /// Its centre, in the arm's plane \[m\].
    pub centre: [f64; 2],
    /// Its radius \[m\].
    pub radius: f64,
}

/// How a world begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Posture at rest, and the equilibrium points.
    pub posture: Posture,
    /// The object.
    pub ball: Ball,
    /// Whether the object rests on a plane.
    pub support: bool,
    /// The cylinder in the way, if there is one.
    pub obstacle: Option<Obstacle>,
}
