//! What is about to touch, and what a contact does to velocities.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::distance::{Gap, from_obstacle, from_shadow, from_solid};
use super::factor::{BALL, Matrix, SIZE};
use super::mechanics::{Speeds, quarter_turn};
use super::{MovingBall, Tree, Velocities};
use crate::obstacle::Obstacle;
use crate::robot::kinematics::{MAX_JOINTS, Placed};
use crate::robot::links::{FOREARM, Solid};
use crate::robot::touch::{OBSTACLE, SUPPORT};
use crate::robot::world::World;

/// Surfaces this near are looked at in any case: contacts may push things together that would not
/// meet without them \[m\].
const NEAR_M: f64 = 0.002;
/// Most joints between the shoulder and a link, both counted: those of the thumb.
const CHAIN: usize = FOREARM + 5;

/// One point where the ball, or the obstacle, meets a link or something that does not move.
///
/// The force is along `normal` on the ball's or the obstacle's side and against it on the link's.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    /// What touches; none if it is the obstacle that a link meets.
    pub(super) slot: Option<usize>,
    pub(super) normal: Vector3<f64>,
    /// Depth \[m\]; negative if apart.
    pub(super) depth: f64,
    /// From the ball's centre \[m\]; none if the obstacle is in the ball's place.
    pub(super) arm: Option<Vector3<f64>>,
    /// Velocities that move the link.
    pub(super) joints: [usize; CHAIN],
    /// How they move the point, per rad/s \[m\].
    pub(super) levers: [Vector2<f64>; CHAIN],
    /// How many there are.
    pub(super) chain: usize,
    /// Coefficient of friction.
    pub(super) friction: f64,
}

impl Contact {
    /// Velocity of the ball's side against the link's \[m/s\].
    pub(super) fn relative(&self, velocities: &Velocities) -> Vector3<f64> {
        let [ux, uy, uz, wx, wy, wz, ..] = *velocities;
        let mut relative = self.arm.map_or_else(Vector3::zeros, |arm| {
            Vector3::new(ux, uy, uz) + Vector3::new(wx, wy, wz).cross(&arm)
        });
        for i in 0..self.chain {
            let moved = self.levers[i] * velocities[self.joints[i]];
            relative.x -= moved.x;
            relative.y -= moved.y;
        }
        relative
    }

    /// Adds the impulses in the joints and of the ball that `impulse` \[N·s\] makes.
    pub(super) fn apply(&self, impulse: &Vector3<f64>, to: &mut [f64; SIZE]) {
        if let Some(arm) = self.arm {
            let turn = arm.cross(impulse);
            for k in 0..3 {
                to[k] += impulse[k];
                to[3 + k] += turn[k];
            }
        }
        for i in 0..self.chain {
            to[self.joints[i]] -= self.levers[i].dot(&impulse.xy());
        }
    }

    /// Adds `JᵀWJ` for a curvature W \[kg\] of the impulse.
    pub(super) fn add(&self, w: &Matrix3<f64>, to: &mut Matrix) {
        // ω × r = X ω
        let x = self.arm.map(|arm| -arm.cross_matrix());
        if let Some(x) = &x {
            let turned = x.tr_mul(w);
            let both = turned * x;
            for i in 0..3 {
                for j in 0..=i {
                    to[i][j] += w[(i, j)];
                    to[3 + i][3 + j] += both[(i, j)];
                }
                for j in 0..3 {
                    to[3 + i][j] += turned[(i, j)];
                }
            }
        }
        for i in 0..self.chain {
            let row = &mut to[self.joints[i]];
            let lever = self.levers[i].push(0.0);
            let pull = w * lever;
            if let Some(x) = &x {
                let turn = x.tr_mul(&pull);
                for j in 0..3 {
                    row[j] -= pull[j];
                    row[3 + j] -= turn[j];
                }
            }
            // The chain is listed from the link inwards.
            for j in i..self.chain {
                row[self.joints[j]] += pull.xy().dot(&self.levers[j]);
            }
        }
    }
}

/// Where to look for contacts of one step.
struct Search<'a> {
    tree: &'a Tree,
    placed: &'a [Placed; MAX_JOINTS],
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
        world: &World,
        placed: &[Placed; MAX_JOINTS],
        speeds: &Speeds,
        free: &Velocities,
    ) -> Vec<Contact> {
        let mut search = Search {
            tree: self,
            placed,
            speeds,
            ball: &world.ball,
            velocity: Vector3::new(free[0], free[1], free[2]),
            found: Vec::new(),
        };
        search.solids_and_ball();
        if world.support {
            search.support_and_ball();
        }
        if let Some(obstacle) = &world.obstacle {
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
                local = self.placed[of_link].local_from_world(&self.ball.centre);
            }
            let gap = from_solid(&place.solid, &local);
            let apart = gap.distance - radius;
            let normal = self.placed[of_link].turn(&gap.normal);
            let point = self.ball.centre - normal * (radius + 0.5 * apart);
            let moved = self.speeds.at(of_link, self.placed, point.xy());
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
        let Gap { distance, normal } =
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
            let placed = &self.placed[place.link];
            if !self.is_level(&place.solid, placed.origin.z) {
                continue;
            }
            let foot = placed.local_from_world(&obstacle.centre.push(0.0));
            let gap = from_shadow(&place.solid, foot.xy());
            let apart = gap.distance - obstacle.radius;
            let normal = placed.turn(&gap.normal);
            let point = obstacle.centre - normal.xy() * (obstacle.radius + 0.5 * apart);
            let moved = self.speeds.at(place.link, self.placed, point);
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
            let lever = quarter_turn(point - self.placed[i].origin.xy());
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
