//! How far arm and hand are from a point, by forward kinematics alone.

use nalgebra::{Vector2, Vector3};

use super::kinematics::{LinkPose, place};
use super::model::Robot;
use super::muscles::Posture;
use crate::geometry::solid::Solid;

impl Robot {
    /// Distance from the surface of arm and hand in `posture` to a point \[m\]; negative inside.
    #[must_use]
    pub fn clearance(&self, posture: Posture, point: &Vector3<f64>) -> f64 {
        self.least(posture, |pose, solid| {
            solid.distance(&pose.local_from_world(point))
        })
    }

    /// The same to a vertical line through a point of the plane \[m\].
    #[must_use]
    pub fn clearance_of_vertical(&self, posture: Posture, foot: Vector2<f64>) -> f64 {
        self.least(posture, |pose, solid| {
            let local = pose.local_from_world(&foot.push(0.0));
            solid
                .projected()
                .distance(&Vector3::new(local.x, local.y, 0.0))
        })
    }

    fn least(&self, posture: Posture, distance: impl Fn(&LinkPose, &Solid) -> f64) -> f64 {
        let poses = place(&self.links, |i| posture[self.links[i].muscle.index()]);
        let mut least = f64::INFINITY;
        for (link, pose) in self.links.iter().zip(&poses) {
            for (_, solid) in &link.solids {
                least = least.min(distance(pose, solid));
            }
        }
        least
    }
}
