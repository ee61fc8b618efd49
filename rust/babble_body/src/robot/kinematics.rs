//! Where the links are for given joint angles.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::links::Link;
use crate::geometry::frame::{Frame, rotate, unrotate};

/// Most joints that a robot has: those of independent fingers.
pub(super) const MAX_JOINTS: usize = 18;

/// Where a link is: all are turned about the vertical alone.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkPose {
    /// Its joint \[m\].
    pub(super) origin: Vector3<f64>,
    /// (cos, sin) of its direction.
    pub(super) direction: Vector2<f64>,
    angle: f64,
}

impl LinkPose {
    /// Not placed yet.
    pub(super) const NOWHERE: Self = Self {
        origin: Vector3::new(0.0, 0.0, 0.0),
        direction: Vector2::new(1.0, 0.0),
        angle: 0.0,
    };

    fn of(link: &Link, parent: Option<&Self>, q: f64) -> Self {
        let angle = parent.map_or(0.0, |parent| parent.angle) + link.direction + link.sense() * q;
        let (sin, cos) = libm::sincos(angle);
        Self {
            origin: parent.map_or(link.origin, |parent| parent.world_from_local(&link.origin)),
            direction: Vector2::new(cos, sin),
            angle,
        }
    }

    pub(super) fn world_from_local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.origin + self.turn(point)
    }

    /// A vector of the link in world coordinates.
    pub(super) fn turn(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        rotate(vector.xy(), self.direction).push(vector.z)
    }

    pub(super) fn local_from_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let offset = point - self.origin;
        unrotate(offset.xy(), self.direction).push(offset.z)
    }

    pub(super) fn frame(&self) -> Frame {
        let (cos, sin) = (self.direction.x, self.direction.y);
        Frame {
            origin: self.origin,
            rotation: Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0),
        }
    }
}

/// Every link with its joint at `q` \[rad\].
pub(super) fn place(links: &[Link], q: impl Fn(usize) -> f64) -> [LinkPose; MAX_JOINTS] {
    let mut placed = [LinkPose::NOWHERE; MAX_JOINTS];
    for (i, link) in links.iter().enumerate() {
        placed[i] = LinkPose::of(link, link.parent.map(|parent| &placed[parent]), q(i));
    }
    placed
}
