//! From the body's numbers to the engine's bodies, colliders and joints.

use nalgebra::{Unit, Vector3};
use rapier3d::prelude::*;

use super::links::{self, Link, Solid};
use super::seam::{hinge, vector};
use super::touch::Thing;
use super::world::World;
use super::{FREE_AXIS, Robot};
use crate::config::{Body, Contact};

/// Earth's, downwards \[m/s²\]. It acts on the object alone: muscles compensate for it (Sect. II-B).
const GRAVITY: f32 = 9.81;
/// Radius of the template's object and obstacle, which every case replaces \[m\].
const ANY_RADIUS: f32 = 0.03;

impl Robot {
    /// The robot of `body`, stepped by `dt` \[s\].
    #[must_use]
    pub fn new(body: &Body, dt: f64) -> Self {
        let links = links::links(body);
        let mut world = World::default();
        let shoulder = world.bodies.insert(RigidBodyBuilder::fixed());
        let mut bodies: Vec<RigidBodyHandle> = Vec::with_capacity(links.len());
        let mut joints = Vec::with_capacity(links.len());
        for link in &links {
            let handle = insert_link(&mut world, body, link);
            let parent = link.parent.map_or(shoulder, |parent| bodies[parent]);
            let joint = world
                .multibody_joints
                .insert(parent, handle, joint(link), true);
            // Each link is new, so no joint closes a loop.
            joints.extend(joint);
            bodies.push(handle);
        }
        set_damping(&mut world, body, &links, &joints);
        let (object, object_collider) = insert_object(&mut world, body);
        let support = insert_support(&mut world, body);
        let obstacle = insert_obstacle(&mut world, body);
        let mut robot = Self {
            ranges: ranges(body),
            body: body.clone(),
            links,
            template: world,
            parameters: parameters(&body.contact, dt),
            gravity: Vector::new(0.0, 0.0, -GRAVITY),
            bodies,
            joints,
            object,
            object_collider,
            support,
            obstacle,
        };
        robot.warm_up();
        robot
    }

    /// One step of the template far from everything, so that a copy's buffers have their sizes.
    fn warm_up(&mut self) {
        let mut template = std::mem::take(&mut self.template);
        template.step(Vector::ZERO, &self.parameters);
        self.template = template;
    }
}

/// Lowest and highest equilibrium point of shoulder, elbow, thumb and finger \[rad\].
fn ranges(body: &Body) -> [[f64; 2]; 4] {
    let arm = |name: &str| {
        let joint = &body.joints[name];
        [joint.lower_deg, joint.upper_deg].map(f64::to_radians)
    };
    let hand = body.grip.flexion_deg.map(f64::to_radians);
    [arm("shoulder"), arm("elbow"), hand, hand]
}

fn parameters(contact: &Contact, dt: f64) -> IntegrationParameters {
    let softness =
        SpringCoefficients::new(contact.frequency_hz as f32, contact.damping_ratio as f32);
    IntegrationParameters {
        dt: dt as f32,
        contact_softness: softness,
        static_contact_softness: softness,
        length_unit: contact.length_unit_m as f32,
        num_solver_iterations: contact.substeps,
        max_ccd_substeps: 0,
        // Its distance is as large as a hand.
        contact_recycling: false,
        friction_model: FrictionModel::Coulomb,
        ..IntegrationParameters::default()
    }
}

fn insert_link(world: &mut World, body: &Body, link: &Link) -> RigidBodyHandle {
    // A spring wakes nothing, so nothing may sleep.
    let builder = RigidBodyBuilder::dynamic()
        .gravity_scale(0.0)
        .can_sleep(false);
    let handle = world.bodies.insert(builder);
    for (part, solid) in &link.solids {
        let thing = Thing::Robot(*part);
        let collider = solid_collider(solid)
            .density(body.arm.density_kg_m3 as f32)
            .friction(body.object.friction as f32)
            .collision_groups(thing.groups())
            .user_data(thing.code());
        world
            .colliders
            .insert_with_parent(collider, handle, &mut world.bodies);
    }
    handle
}

fn solid_collider(solid: &Solid) -> ColliderBuilder {
    match solid {
        Solid::Capsule { a, b, radius } => {
            ColliderBuilder::capsule_from_endpoints(vector(a), vector(b), *radius as f32)
        }
        Solid::Cuboid { centre, half } => {
            let half = vector(half);
            ColliderBuilder::cuboid(half.x, half.y, half.z).translation(vector(centre))
        }
    }
}

/// A chain of joints with one free axis each: the engine has none with two.
fn joint(link: &Link) -> GenericJoint {
    GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
        .local_frame1(hinge(&link.origin, link.direction, link.clockwise))
        .local_frame2(hinge(&Vector3::zeros(), 0.0, link.clockwise))
        .build()
}

fn set_damping(world: &mut World, body: &Body, links: &[Link], joints: &[MultibodyJointHandle]) {
    let World {
        bodies,
        multibody_joints,
        ..
    } = world;
    let Some((multibody, _)) = multibody_joints.get_mut(joints[0]) else {
        return;
    };
    // Until this call the root counts as free, with six degrees of freedom of its own.
    multibody.forward_kinematics(bodies, true);
    multibody.set_self_contacts_enabled(false);
    // Replaces the engine's own default of 0.1 too.
    for (i, link) in links.iter().enumerate() {
        multibody.damping_mut()[i] = link.muscle.settings(body).kd as f32;
    }
    for (link, joint) in links.iter().zip(multibody.links_mut().skip(1)) {
        let kp = link.muscle.settings(body).kp as f32;
        joint.joint.set_spring(FREE_AXIS, kp, 0.0);
    }
    multibody.update_rigid_bodies(bodies, true);
}

fn insert_object(world: &mut World, body: &Body) -> (RigidBodyHandle, ColliderHandle) {
    let far = Vector::new(0.0, -10.0, 0.0);
    let handle = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(far)
            .linear_damping(body.object.linear_damping as f32)
            .angular_damping(body.object.angular_damping as f32)
            .can_sleep(false),
    );
    let collider = ColliderBuilder::ball(ANY_RADIUS)
        .density(body.object.density_kg_m3 as f32)
        .friction(body.object.friction as f32)
        .collision_groups(Thing::Object.groups())
        .user_data(Thing::Object.code());
    let collider = world
        .colliders
        .insert_with_parent(collider, handle, &mut world.bodies);
    (handle, collider)
}

fn insert_support(world: &mut World, body: &Body) -> ColliderHandle {
    let plane = ColliderBuilder::halfspace(Unit::new_unchecked(Vector::Z))
        .friction(body.object.support_friction as f32)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(Thing::Support.groups())
        .user_data(Thing::Support.code())
        .enabled(false);
    world.colliders.insert(plane)
}

fn insert_obstacle(world: &mut World, body: &Body) -> ColliderHandle {
    let half = body.obstacle.height_m as f32 / 2.0;
    // The engine's cylinders stand along y.
    let upright = Vector::X * std::f32::consts::FRAC_PI_2;
    let cylinder = ColliderBuilder::cylinder(half, ANY_RADIUS)
        .rotation(upright)
        .friction(body.object.friction as f32)
        .collision_groups(Thing::Obstacle.groups())
        .user_data(Thing::Obstacle.code())
        .enabled(false);
    world.colliders.insert(cylinder)
}
