//! How fast links and their points move.

use nalgebra::Vector2;

use crate::robot::kinematics::{LinkPose, MAX_JOINTS};
use crate::robot::links::Link;

/// Velocities of the links.
pub(super) struct Speeds {
    /// Velocities of the joints \[m/s\].
    origin: [Vector2<f64>; MAX_JOINTS],
    /// Angular speeds about the vertical \[rad/s\].
    turn: [f64; MAX_JOINTS],
}

impl Speeds {
    pub(super) fn of(links: &[Link], poses: &[LinkPose; MAX_JOINTS], v: &[f64]) -> Self {
        let mut speeds = Self {
            origin: [Vector2::zeros(); MAX_JOINTS],
            turn: [0.0; MAX_JOINTS],
        };
        for (i, link) in links.iter().enumerate() {
            let mut turn = link.sense() * v[i];
            if let Some(parent) = link.parent {
                turn += speeds.turn[parent];
                speeds.origin[i] = speeds.at(parent, poses, poses[i].origin.xy());
            }
            speeds.turn[i] = turn;
        }
        speeds
    }

    /// Velocity of a link's joint \[m/s\].
    pub(super) const fn origin(&self, link: usize) -> Vector2<f64> {
        self.origin[link]
    }

    /// Angular speed of a link \[rad/s\].
    pub(super) const fn turn(&self, link: usize) -> f64 {
        self.turn[link]
    }

    /// Velocity of the point of a link that is at `point` \[m/s\].
    pub(super) fn at(
        &self,
        link: usize,
        poses: &[LinkPose; MAX_JOINTS],
        point: Vector2<f64>,
    ) -> Vector2<f64> {
        self.origin[link] + quarter_turn(point - poses[link].origin.xy()) * self.turn[link]
    }
}

/// `v` turned counter-clockwise by 90°.
pub(super) fn quarter_turn(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}
