//! The robot that grasps, and its world: arm, hand, object, support and obstacle in a physics
//! engine, moved by the muscles of Eq. 2.
//!
//! [`Robot`] never changes; [`World`] is all that does. A new world is a copy of the robot's
//! template, with arm, hand and object put where a case has them.

mod build;
mod clearance;
mod links;
mod scene;
mod seam;
mod touch;
mod world;

use nalgebra::Vector3;
use rapier3d::prelude::*;

use crate::config::Body;
use crate::obstacle::Obstacle;
pub use links::Part;
use links::{FOREARM, Link};
pub use seam::Frame;
use seam::{from_pose, from_vector, vector};
pub use touch::Touch;
pub use world::World;

/// Angular x: the free axis of a joint in its own frame.
const FREE_AXIS: usize = 3;

/// Angles of shoulder, elbow, thumb and virtual finger \[rad\]: of the arm's joints, and flexions of
/// the hand's.
pub type Posture = [f64; 4];

/// What moves a joint, or every joint of a digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pull {
    /// Muscles with this equilibrium point \[rad\], Eq. 2.
    EquilibriumPoint(f64),
    /// This torque on top of the muscles' damping \[N·m\].
    Torque(f64),
}

/// What moves shoulder, elbow, thumb and virtual finger.
pub type Drive = [Pull; 4];

/// Muscles that pull towards a posture.
#[must_use]
pub fn towards(posture: Posture) -> Drive {
    posture.map(Pull::EquilibriumPoint)
}

/// A sphere that can be grasped.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ball {
    /// Its centre, in the arm's plane \[m\].
    pub centre: [f64; 2],
    /// Its radius \[m\].
    pub radius: f64,
}

/// How a world begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Posture at rest, and the equilibrium points.
    pub posture: Posture,
    /// The object.
    pub ball: Ball,
    /// Whether the object rests on a plane.
    pub support: bool,
    /// The cylinder in the way, if there is one.
    pub obstacle: Option<Obstacle>,
}

/// Arm, hand and everything around them, as params.
#[derive(Debug, Clone)]
pub struct Robot {
    body: Body,
    links: Vec<Link>,
    ranges: [[f64; 2]; 4],
    template: World,
    parameters: IntegrationParameters,
    gravity: Vector,
    bodies: Vec<RigidBodyHandle>,
    joints: Vec<MultibodyJointHandle>,
    object: RigidBodyHandle,
    object_collider: ColliderHandle,
    support: ColliderHandle,
    obstacle: ColliderHandle,
}

impl Robot {
    /// The body it was made from.
    #[must_use]
    pub const fn body(&self) -> &Body {
        &self.body
    }

    /// Lowest and highest equilibrium point of each joint group \[rad\].
    #[must_use]
    pub const fn ranges(&self) -> &[[f64; 2]; 4] {
        &self.ranges
    }

    /// Degrees of freedom: 9 with a virtual finger, 18 with independent ones.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        self.links.len()
    }

    /// The open hand with the arm in a posture \[rad\].
    #[must_use]
    pub fn open_hand(&self, arm: [f64; 2]) -> Posture {
        [arm[0], arm[1], self.ranges[2][0], self.ranges[3][0]]
    }

    /// A posture moved into the joint ranges.
    #[must_use]
    pub fn clamp(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| posture[i].clamp(self.ranges[i][0], self.ranges[i][1]))
    }

    /// A posture as shares of the joint ranges.
    #[must_use]
    pub fn normalised(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges[i];
            (posture[i] - low) / (high - low)
        })
    }

    /// The posture at the given shares of the joint ranges.
    #[must_use]
    pub fn denormalised(&self, share: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges[i];
            low + share[i] * (high - low)
        })
    }

    /// A world as `setup` has it, at rest.
    #[must_use]
    pub fn world(&self, setup: &Setup) -> World {
        let mut world = self.template.clone();
        self.place_robot(&mut world, setup.posture);
        self.place_ball(&mut world, &setup.ball);
        if setup.support {
            let height = -setup.ball.radius as f32;
            let support = &mut world.colliders[self.support];
            support.set_translation(Vector::new(0.0, 0.0, height));
            support.set_enabled(true);
        }
        if let Some(obstacle) = setup.obstacle {
            let half = self.body.obstacle.height_m as f32 / 2.0;
            let collider = &mut world.colliders[self.obstacle];
            collider.set_shape(SharedShape::cylinder(half, obstacle.radius as f32));
            collider.set_translation(vector(&obstacle.centre.push(0.0)));
            collider.set_enabled(true);
        }
        world
    }

    /// A world with every joint at its angle, in the order of [`Self::joint_angles`] \[rad\], and the
    /// object at a point \[m\]: to be looked at, not to be stepped.
    #[must_use]
    pub fn posed(&self, joints: &[f32], object: &Vector3<f64>) -> World {
        let mut world = self.template.clone();
        self.place_joints(&mut world, joints);
        world.bodies[self.object].set_translation(vector(object), true);
        world
    }

    fn place_robot(&self, world: &mut World, posture: Posture) {
        let angles: Vec<f32> = self
            .links
            .iter()
            .map(|link| posture[link.muscle.index()] as f32)
            .collect();
        self.place_joints(world, &angles);
        self.drive(world, &towards(posture));
    }

    /// Turns every joint of the template by an angle \[rad\].
    fn place_joints(&self, world: &mut World, angles: &[f32]) {
        let World {
            bodies,
            colliders,
            multibody_joints,
            ..
        } = world;
        let Some((multibody, _)) = multibody_joints.get_mut(self.joints[0]) else {
            return;
        };
        multibody.apply_displacements(angles);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
        // The engine moves colliders after a step only: the first one would see the template's.
        for body in self.bodies.iter().map(|&handle| &bodies[handle]) {
            for &handle in body.colliders() {
                let collider = &mut colliders[handle];
                if let Some(within) = collider.position_wrt_parent() {
                    collider.set_position(body.position() * within);
                }
            }
        }
    }

    fn place_ball(&self, world: &mut World, ball: &Ball) {
        let [x, y] = ball.centre;
        let centre = vector(&Vector3::new(x, y, 0.0));
        world.bodies[self.object].set_translation(centre, true);
        world.colliders[self.object_collider].set_shape(SharedShape::ball(ball.radius as f32));
    }

    /// One physics step.
    pub fn step(&self, world: &mut World, drive: &Drive) {
        self.drive(world, drive);
        world.step(self.gravity, &self.parameters);
    }

    /// Takes the support away for good.
    pub fn remove_support(&self, world: &mut World) {
        world.colliders[self.support].set_enabled(false);
    }

    /// Whether the object's support is there.
    #[must_use]
    pub fn has_support(&self, world: &World) -> bool {
        world.colliders[self.support].is_enabled()
    }

    fn drive(&self, world: &mut World, drive: &Drive) {
        let Some((multibody, _)) = world.multibody_joints.get_mut(self.joints[0]) else {
            return;
        };
        // The root, which does not move, comes first.
        for (link, joint) in self.links.iter().zip(multibody.links_mut().skip(1)) {
            let i = link.muscle.index();
            let kp = link.muscle.settings(&self.body).kp;
            let joint = &mut joint.joint;
            let (stiffness, rest) = match drive[i] {
                Pull::EquilibriumPoint(point) => (kp, point),
                Pull::Torque(torque) => {
                    let q = f64::from(joint.coords()[FREE_AXIS]);
                    torque_as_spring(torque, q, self.ranges[i], kp)
                }
            };
            joint.set_spring(FREE_AXIS, stiffness as f32, rest as f32);
        }
    }

    /// Angle of every joint, from the shoulder outwards, the fingers before the thumb \[rad\].
    pub fn joint_angles<'a>(&'a self, world: &'a World) -> impl Iterator<Item = f64> + 'a {
        let multibody = world.multibody_joints.get(self.joints[0]);
        multibody
            .into_iter()
            .flat_map(|(multibody, _)| multibody.links().skip(1))
            .map(|link| f64::from(link.joint().coords()[FREE_AXIS]))
    }

    /// Angles of arm and hand; thumb and finger are the means over their joints \[rad\].
    #[must_use]
    pub fn posture(&self, world: &World) -> Posture {
        self.means(self.joint_angles(world))
    }

    /// Speeds of arm and hand, as [`Self::posture`] has the angles \[rad/s\].
    #[must_use]
    pub fn speeds(&self, world: &World) -> Posture {
        let multibody = world.multibody_joints.get(self.joints[0]);
        self.means(multibody.into_iter().flat_map(|(multibody, _)| {
            let velocity = multibody.generalized_velocity();
            (0..self.links.len()).map(move |i| f64::from(velocity[i]))
        }))
    }

    fn means(&self, values: impl Iterator<Item = f64>) -> Posture {
        let (mut sums, mut counts) = ([0.0; 4], [0.0; 4]);
        for (link, value) in self.links.iter().zip(values) {
            sums[link.muscle.index()] += value;
            counts[link.muscle.index()] += 1.0;
        }
        std::array::from_fn(|i| sums[i] / counts[i])
    }

    /// Centre of the object \[m\].
    #[must_use]
    pub fn object(&self, world: &World) -> Vector3<f64> {
        from_vector(world.bodies[self.object].translation())
    }

    /// Velocity of the object \[m/s\].
    #[must_use]
    pub fn object_velocity(&self, world: &World) -> Vector3<f64> {
        from_vector(world.bodies[self.object].linvel())
    }

    /// The palm: its centre, x towards the fingers, y out of the side that grasps.
    #[must_use]
    pub fn palm(&self, world: &World) -> Frame {
        let forearm = self.frame(world, FOREARM);
        Frame {
            origin: forearm.world_from_local(&Vector3::new(self.palm_centre(), 0.0, 0.0)),
            ..forearm
        }
    }

    /// Distance of the palm's centre from the elbow \[m\].
    #[must_use]
    pub fn palm_centre(&self) -> f64 {
        self.body.arm.forearm_m + links::palm_length(&self.body) / 2.0
    }

    /// Where the centre of a ball is that lies against the palm, in the palm's frame \[m\].
    #[must_use]
    pub fn pocket(&self, radius: f64) -> Vector3<f64> {
        // A little towards the fingers, which reach around it there.
        let along = 0.12 * links::palm_length(&self.body);
        Vector3::new(along, self.body.arm.half_width_m + radius, 0.0)
    }

    fn frame(&self, world: &World, link: usize) -> Frame {
        from_pose(world.bodies[self.bodies[link]].position())
    }
}

/// Stiffness and rest angle of a spring that pulls a joint at `q` \[rad\] with `torque` \[N·m\], and
/// of the stop behind the end of its range.
///
/// A spring, as the engine adds those implicitly; so soft that it hardly varies within a step.
fn torque_as_spring(torque: f64, q: f64, [low, high]: [f64; 2], kp: f64) -> (f64, f64) {
    const SOFT: f64 = 1e-3;
    if (q > high && torque > 0.0) || (q < low && torque < 0.0) {
        return (kp, q.clamp(low, high));
    }
    let stiffness = SOFT * kp;
    (stiffness, q + torque / stiffness)
}
