//! How far arm and hand are from a point, by forward kinematics alone.

use nalgebra::{Vector2, Vector3};

use super::kinematics::{Placed, place};
use super::links::Solid;
use super::{Posture, Robot};

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
            distance(&solid.flat(), &Vector3::new(local.x, local.y, 0.0))
        })
    }

    fn least(&self, posture: Posture, distance: impl Fn(&Placed, &Solid) -> f64) -> f64 {
        let placed = place(&self.links, |i| posture[self.links[i].muscle.index()]);
        let mut least = f64::INFINITY;
        for (link, placed) in self.links.iter().zip(&placed) {
            for (_, solid) in &link.solids {
                least = least.min(distance(placed, solid));
            }
        }
        least
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
