//! The mechanical state of a world: what every engine reads and writes.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::contact_slots::SLOTS;
use super::kinematics::MAX_JOINTS;
use crate::geometry::obstacle::Obstacle;

/// Positions, velocities, and the contacts of the last step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct MechanicalState {
    /// Angles of the joints \[rad\].
    pub(super) q: [f64; MAX_JOINTS],
    /// Their speeds \[rad/s\].
    pub(super) v: [f64; MAX_JOINTS],
    pub(super) ball: MovingBall,
    /// Whether the object's support is there.
    pub(super) support: bool,
    pub(super) obstacle: Option<Obstacle>,
    /// Normal impulses on the object in the last step, by slot \[N·s\].
    pub(super) impulses: [f64; SLOTS],
    /// Whether arm or hand touched the obstacle in the last step.
    pub(super) hit: bool,
    /// How deep the object was in arm and hand as the last step began \[m\].
    pub(super) depth: f64,
}

impl MechanicalState {
    /// A state in which nothing moves or touches, without a support.
    pub(super) fn at_rest(
        q: [f64; MAX_JOINTS],
        ball: MovingBall,
        obstacle: Option<Obstacle>,
    ) -> Self {
        Self {
            q,
            v: [0.0; MAX_JOINTS],
            ball,
            support: false,
            obstacle,
            impulses: [0.0; SLOTS],
            hit: false,
            depth: 0.0,
        }
    }
}

/// A sphere in motion. Its orientation has no effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct MovingBall {
    /// Radius \[m\].
    pub(super) radius: f64,
    /// Centre \[m\].
    pub(super) centre: Vector3<f64>,
    /// Velocity \[m/s\].
    pub(super) velocity: Vector3<f64>,
    /// Angular velocity \[rad/s\].
    pub(super) spin: Vector3<f64>,
}

impl MovingBall {
    pub(super) fn at_rest(centre: Vector3<f64>, radius: f64) -> Self {
        Self {
            radius,
            centre,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
        }
    }
}
