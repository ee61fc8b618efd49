//! How far arm and hand are from a point, by forward kinematics alone.

use nalgebra::{Vector2, Vector3};

use super::links::{Link, Solid};
use super::{Posture, Robot};
use crate::arm::rotate;

/// Where a link is in the plane of motion.
#[derive(Clone, Copy)]
struct Placed {
    origin: Vector3<f64>,
    /// (cos, sin) of its direction.
    direction: Vector2<f64>,
    angle: f64,
}

impl Placed {
    fn of(link: &Link, parent: Option<&Self>, q: f64) -> Self {
        let turn = link.direction + if link.clockwise { -q } else { q };
        let angle = parent.map_or(0.0, |parent| parent.angle) + turn;
        let (sin, cos) = libm::sincos(angle);
        Self {
            origin: parent.map_or(link.origin, |parent| parent.world_from_local(&link.origin)),
            direction: Vector2::new(cos, sin),
            angle,
        }
    }

    fn world_from_local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.origin + rotate(point.xy(), self.direction).push(point.z)
    }

    fn local_from_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let offset = point - self.origin;
        let back = Vector2::new(self.direction.x, -self.direction.y);
        rotate(offset.xy(), back).push(offset.z)
    }
}

impl Robot {
    /// Distance from the surface of arm and hand in `posture` to a point \[m\]; negative inside.
    #[must_use]
    pub fn clearance(&self, posture: Posture, point: &Vector3<f64>) -> f64 {
        self.least(posture, |placed, solid| {
            distance(solid, &placed.local_from_world(point))
        })
    }

    /// The same to a vertical line through a point of the plane \[m\].
    #[must_use]
    pub fn clearance_of_vertical(&self, posture: Posture, foot: Vector2<f64>) -> f64 {
        self.least(posture, |placed, solid| {
            let local = placed.local_from_world(&foot.push(0.0));
            distance(&flat(solid), &Vector3::new(local.x, local.y, 0.0))
        })
    }

    fn least(&self, posture: Posture, distance: impl Fn(&Placed, &Solid) -> f64) -> f64 {
        let mut placed: Vec<Placed> = Vec::with_capacity(self.links.len());
        let mut least = f64::INFINITY;
        for link in &self.links {
            let parent = link.parent.map(|parent| &placed[parent]);
            let own = Placed::of(link, parent, posture[link.muscle.index()]);
            for (_, solid) in &link.solids {
                least = least.min(distance(&own, solid));
            }
            placed.push(own);
        }
        least
    }
}

/// The solid's shadow in the plane.
fn flat(solid: &Solid) -> Solid {
    let level = |v: &Vector3<f64>| Vector3::new(v.x, v.y, 0.0);
    match solid {
        Solid::Capsule { a, b, radius } => Solid::Capsule {
            a: level(a),
            b: level(b),
            radius: *radius,
        },
        Solid::Cuboid { centre, half } => Solid::Cuboid {
            centre: level(centre),
            half: *half,
        },
    }
}

fn distance(solid: &Solid, point: &Vector3<f64>) -> f64 {
    match solid {
        Solid::Capsule { a, b, radius } => {
            let along = b - a;
            let share = (along.dot(&(point - a)) / along.norm_squared()).clamp(0.0, 1.0);
            (point - a - along * share).norm() - radius
        }
        Solid::Cuboid { centre, half } => {
            let beyond = (point - centre).abs() - half;
            let inside = beyond.max().min(0.0);
            beyond.map(|x| x.max(0.0)).norm() + inside
        }
    }
}
