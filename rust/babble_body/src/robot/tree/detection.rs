//! Which surfaces are about to touch.

use nalgebra::{Vector2, Vector3};

use super::contact::{CHAIN, Contact};
use super::factor::{BALL, Velocities};
use super::model::Tree;
use super::speeds::{Speeds, quarter_turn};
use crate::geometry::obstacle::Obstacle;
use crate::geometry::separation::{Separation, from_obstacle, from_projected, from_solid};
use crate::geometry::solid::Solid;
use crate::robot::contact_slots::{OBSTACLE, SUPPORT};
use crate::robot::kinematics::{LinkPose, MAX_JOINTS};
use crate::robot::mechanics::{MechanicalState, MovingBall};

/// Surfaces this near are looked at in any case: contacts may push things together that would not
/// meet without them \[m\].
const NEAR_M: f64 = 0.002;
/// Where to look for contacts of one step.
struct Search<'a> {
    tree: &'a Tree,
    poses: &'a [LinkPose; MAX_JOINTS],
    speeds: &'a Speeds,
    ball: &'a MovingBall,
    /// The ball's velocity if nothing touches \[m/s\].
    velocity: Vector3<f64>,
    found: Vec<Contact>,
}

impl Tree {
    /// All contacts that may matter, if the velocities without them are `free`.
    pub(super) fn contacts(
        &self,
        mechanics: &MechanicalState,
        poses: &[LinkPose; MAX_JOINTS],
        speeds: &Speeds,
        free: &Velocities,
    ) -> Vec<Contact> {
        let mut search = Search {
            tree: self,
            poses,
            speeds,
            ball: &mechanics.ball,
            velocity: Vector3::new(free[0], free[1], free[2]),
            found: Vec::new(),
        };
        search.solids_and_ball();
        if mechanics.support {
            search.support_and_ball();
        }
        if let Some(obstacle) = &mechanics.obstacle {
            search.obstacle_and_ball(obstacle);
            search.solids_and_obstacle(obstacle);
        }
        search.found
    }
}

impl Search<'_> {
    fn solids_and_ball(&mut self) {
        let radius = self.ball.radius;
        let mut local = Vector3::zeros();
        let mut of_link = usize::MAX;
        for slot in 0..self.tree.solids.len() {
            let place = self.tree.solids[slot];
            if place.link != of_link {
                of_link = place.link;
                local = self.poses[of_link].local_from_world(&self.ball.centre);
            }
            let separation = from_solid(&place.solid, &local);
            let apart = separation.distance - radius;
            let normal = self.poses[of_link].turn(&separation.normal);
            let point = self.ball.centre - normal * (radius + 0.5 * apart);
            let moved = self.speeds.at(of_link, self.poses, point.xy());
            let closing = normal.xy().dot(&moved) - normal.dot(&self.velocity);
            if self.is_far(apart, closing) {
                continue;
            }
            self.push(Contact {
                slot: Some(slot),
                depth: -apart,
                arm: Some(point - self.ball.centre),
                friction: self.tree.object.friction,
                ..self.on_link(of_link, point.xy(), normal)
            });
        }
    }

    fn support_and_ball(&mut self) {
        // It is as high as the ball at rest.
        let apart = self.ball.centre.z;
        let object = &self.tree.object;
        let friction = object.support_friction.min(object.friction);
        self.static_and_ball(SUPPORT, Vector3::z(), apart, friction);
    }

    fn obstacle_and_ball(&mut self, obstacle: &Obstacle) {
        let Separation { distance, normal } =
            from_obstacle(obstacle, self.tree.half_height, &self.ball.centre);
        let friction = self.tree.object.friction;
        self.static_and_ball(OBSTACLE, normal, distance - self.ball.radius, friction);
    }

    fn static_and_ball(&mut self, slot: usize, normal: Vector3<f64>, apart: f64, friction: f64) {
        if self.is_far(apart, -normal.dot(&self.velocity)) {
            return;
        }
        self.push(Contact {
            slot: Some(slot),
            normal,
            depth: -apart,
            arm: Some(normal * -(self.ball.radius + 0.5 * apart)),
            joints: [0; CHAIN],
            levers: [Vector2::zeros(); CHAIN],
            chain: 0,
            friction,
        });
    }

    /// Without friction: such a touch ends a movement.
    fn solids_and_obstacle(&mut self, obstacle: &Obstacle) {
        for slot in 0..self.tree.solids.len() {
            let place = self.tree.solids[slot];
            let poses = &self.poses[place.link];
            if !self.is_level(&place.solid, poses.origin.z) {
                continue;
            }
            let foot = poses.local_from_world(&obstacle.centre.push(0.0));
            let separation = from_projected(&place.solid, foot.xy());
            let apart = separation.distance - obstacle.radius;
            let normal = poses.turn(&separation.normal);
            let point = obstacle.centre - normal.xy() * (obstacle.radius + 0.5 * apart);
            let moved = self.speeds.at(place.link, self.poses, point);
            if self.is_far(apart, normal.xy().dot(&moved)) {
                continue;
            }
            self.push(Contact {
                depth: -apart,
                ..self.on_link(place.link, point, normal)
            });
        }
    }

    /// Whether a solid whose link is at a height \[m\] is as high as the obstacle somewhere.
    fn is_level(&self, solid: &Solid, height: f64) -> bool {
        let [z, half] = match solid {
            Solid::Capsule { a, radius, .. } => [a.z, *radius],
            Solid::Cuboid { centre, half } => [centre.z, half.z],
        };
        (height + z).abs() - half < self.tree.half_height
    }

    /// Whether surfaces that come closer at a speed \[m/s\] stay apart in this step.
    fn is_far(&self, apart: f64, closing: f64) -> bool {
        apart > NEAR_M + self.tree.dt * closing.max(0.0)
    }

    /// A contact of the obstacle at a point of a link.
    fn on_link(&self, link: usize, point: Vector2<f64>, normal: Vector3<f64>) -> Contact {
        let mut contact = Contact {
            slot: None,
            normal,
            depth: 0.0,
            arm: None,
            joints: [0; CHAIN],
            levers: [Vector2::zeros(); CHAIN],
            chain: 0,
            friction: 0.0,
        };
        let mut next = Some(link);
        while let Some(i) = next {
            let lever = quarter_turn(point - self.poses[i].origin.xy());
            contact.joints[contact.chain] = BALL + i;
            contact.levers[contact.chain] = lever * self.tree.links[i].sense();
            contact.chain += 1;
            next = self.tree.links[i].parent;
        }
        contact
    }

    fn push(&mut self, contact: Contact) {
        self.found.push(contact);
    }
}
