//! The world's state: all that changes from one physics step to the next.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::kinematics::MAX_JOINTS;
use super::rapier;
use super::touch::SLOTS;
use crate::obstacle::Obstacle;

/// Everything that moves, and what the next step needs of the last. A copy, or what was written and
/// read again, continues bit for bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct World {
    /// Angles of the joints \[rad\].
    pub(super) q: [f64; MAX_JOINTS],
    /// Their speeds \[rad/s\].
    pub(super) v: [f64; MAX_JOINTS],
    pub(super) ball: MovingBall,
    /// Whether the object's support is there.
    pub(super) support: bool,
    pub(super) obstacle: Option<Obstacle>,
    /// What touched the object in the last step: impulses of the contacts' normals \[N·s\].
    pub(super) impulses: [f64; SLOTS],
    /// Whether arm or hand touched the obstacle in it.
    pub(super) hit: bool,
    /// How deep the object was in arm and hand at its start \[m\].
    pub(super) depth: f64,
    /// What rapier remembers, if it is the engine.
    pub(super) rapier: Option<Box<rapier::Memory>>,
}

impl World {
    /// A world in which nothing moves, without a support.
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
            rapier: None,
        }
    }
}

/// A sphere in motion. How it is turned makes no difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct MovingBall {
    /// \[m\]
    pub(super) radius: f64,
    /// \[m\]
    pub(super) centre: Vector3<f64>,
    /// \[m/s\]
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
