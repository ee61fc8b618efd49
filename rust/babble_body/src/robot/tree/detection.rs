//! Which surfaces are about to touch.

use nalgebra::{Vector2, Vector3};

use super::contact::{CHAIN, Chain, Contact};
use super::contact_cost::{ContactCost, above_zero};
use super::factor::Velocities;
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
/// More contacts than are usual.
const USUAL: usize = 8;

/// Where to look for contacts of one step.
struct Search<'t, 'a> {
    tree: &'t Tree,
    poses: &'a [LinkPose; MAX_JOINTS],
    speeds: &'a Speeds,
    mechanics: &'a MechanicalState,
    ball: &'a MovingBall,
    /// The ball's velocity if nothing touches \[m/s\].
    velocity: Vector3<f64>,
    found: Vec<ContactCost<'t>>,
}

impl Tree {
    /// All contacts that may matter, if the velocities without them are `free`.
    pub(super) fn contacts(
        &self,
        mechanics: &MechanicalState,
        poses: &[LinkPose; MAX_JOINTS],
        speeds: &Speeds,
        free: &Velocities,
    ) -> Vec<ContactCost<'_>> {
        let mut search = Search {
            tree: self,
            poses,
            speeds,
            mechanics,
            ball: &mechanics.ball,
            velocity: Vector3::new(free[0], free[1], free[2]),
            found: Vec::with_capacity(USUAL),
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

impl<'t> Search<'t, '_> {
    fn solids_and_ball(&mut self) {
        let radius = self.ball.radius;
        let mut local = Vector3::zeros();
        let mut of_link = usize::MAX;
        let mut within = 0.0;
        let tree = self.tree;
        for (slot, place) in tree.solids.iter().enumerate() {
            if place.link != of_link {
                of_link = place.link;
                local = self.poses[of_link].local_from_world(&self.ball.centre);
                within = radius + self.reach(of_link, &local);
            }
            if place.bounds.are_beyond(&local, within) {
                continue;
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
                normal,
                depth: -apart,
                arm: Some(point - self.ball.centre),
                chain: &tree.chains[of_link],
                levers: self.levers(of_link, point.xy()),
                friction: tree.object.friction,
            });
        }
    }

    /// More than how far apart \[m\] the ball, whose centre is at `local`, and a solid of a link can be
    /// that are not far: no point between them moves faster than the link's joint and its lever let it.
    fn reach(&self, link: usize, local: &Vector3<f64>) -> f64 {
        const ROUNDING: f64 = 1.0 + 1e-9;
        let sum = |v: Vector2<f64>| v.x.abs() + v.y.abs();
        let lever = sum(local.xy()).max(self.tree.levers[link]);
        let speed = sum(self.speeds.origin(link)) + lever * self.speeds.turn(link).abs();
        let ball = sum(self.velocity.xy()) + self.velocity.z.abs();
        (NEAR_M + self.tree.dt * (speed + ball)) * ROUNDING
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
            chain: &Chain::NONE,
            levers: [Vector2::zeros(); CHAIN],
            friction,
        });
    }

    /// Without friction: such a touch ends a movement.
    fn solids_and_obstacle(&mut self, obstacle: &Obstacle) {
        for place in &self.tree.solids {
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
                slot: None,
                normal,
                depth: -apart,
                arm: None,
                chain: &self.tree.chains[place.link],
                levers: self.levers(place.link, point),
                friction: 0.0,
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
        apart > NEAR_M + self.tree.dt * above_zero(closing)
    }

    /// How the joints of a link move a point of it, per rad/s \[m\].
    fn levers(&self, link: usize, point: Vector2<f64>) -> [Vector2<f64>; CHAIN] {
        let mut levers = [Vector2::zeros(); CHAIN];
        for (lever, i) in levers.iter_mut().zip(self.tree.chains[link].links()) {
            let turned = quarter_turn(point - self.poses[i].origin.xy());
            *lever = turned * self.tree.links[i].sense();
        }
        levers
    }

    fn push(&mut self, contact: Contact<'t>) {
        self.found
            .push(self.tree.contact_cost(self.mechanics, contact));
    }
}
