//! From the body's numbers to the engine's bodies, colliders and joints.

use nalgebra::{Unit, Vector3};
use rapier3d::prelude::*;

use super::input_log::CommandBounds;
use super::model::{FREE_AXIS, OBJECT, Rapier};
use super::seam::{hinge, vector};
use super::simulation::Simulation;
use crate::config::Body;
use crate::geometry::solid::Solid;
use crate::robot::contact_slots::{OBSTACLE, SUPPORT};
use crate::robot::links::Link;
use crate::robot::muscles::MuscleModel;

/// Radius of the template's object and obstacle, which every world replaces \[m\].
const ANY_RADIUS: f32 = 0.03;

impl Rapier {
    /// The robot of `body`, stepped by `dt` \[s\].
    pub(in crate::robot) fn new(body: &Body, links: &[Link], dt: f64) -> Self {
        let muscles = MuscleModel::new(body, links);
        let mut simulation = Simulation::default();
        let shoulder = simulation.bodies.insert(RigidBodyBuilder::fixed());
        let mut bodies: Vec<RigidBodyHandle> = Vec::with_capacity(links.len());
        let mut joints = Vec::with_capacity(links.len());
        let mut slot = 0;
        for link in links {
            let handle = insert_link(&mut simulation, body, link, &mut slot);
            let parent = link.parent.map_or(shoulder, |parent| bodies[parent]);
            let joint = simulation
                .multibody_joints
                .insert(parent, handle, joint(link), true);
            // Each link is new, so no joint closes a loop.
            joints.extend(joint);
            bodies.push(handle);
        }
        set_damping(&mut simulation, body, links, &joints);
        let (object, object_collider) = insert_object(&mut simulation, body);
        let support = insert_support(&mut simulation, body);
        let obstacle = insert_obstacle(&mut simulation, body);
        let parameters = parameters(dt);
        // One step far from everything, so that a copy's buffers have their sizes.
        simulation.step(Vector::ZERO, &parameters);
        Self {
            bounds: CommandBounds::new(body, muscles.ranges),
            muscles,
            template: simulation,
            parameters,
            bodies,
            joints,
            object,
            object_collider,
            support,
            obstacle,
            half_height: body.obstacle.height_m as f32 / 2.0,
        }
    }
}

/// Numbers with which the engine holds a light ball: hard contacts that damp well, and tolerances
/// for things as small as a finger.
fn parameters(dt: f64) -> IntegrationParameters {
    const FREQUENCY_HZ: f32 = 120.0;
    const DAMPING_RATIO: f32 = 5.0;
    let softness = SpringCoefficients::new(FREQUENCY_HZ, DAMPING_RATIO);
    IntegrationParameters {
        dt: dt as f32,
        contact_softness: softness,
        static_contact_softness: softness,
        length_unit: 0.1,
        // These are substeps; two cost twice as much.
        num_solver_iterations: 1,
        max_ccd_substeps: 0,
        // Its distance is as large as a hand.
        contact_recycling: false,
        friction_model: FrictionModel::Coulomb,
        ..IntegrationParameters::default()
    }
}

/// The role of a collider, which decides what it may touch: arm and hand pass through themselves and
/// the support.
#[derive(Clone, Copy)]
enum Role {
    Robot,
    Object,
    Support,
    Obstacle,
}

impl Role {
    fn groups(self) -> InteractionGroups {
        const ROBOT: Group = Group::GROUP_1;
        const OBJECT: Group = Group::GROUP_2;
        const SUPPORT: Group = Group::GROUP_3;
        const OBSTACLE: Group = Group::GROUP_4;
        let (member, filter) = match self {
            Self::Robot => (ROBOT, OBJECT | OBSTACLE),
            Self::Object => (OBJECT, ROBOT | SUPPORT | OBSTACLE),
            Self::Support => (SUPPORT, OBJECT),
            Self::Obstacle => (OBSTACLE, ROBOT | OBJECT),
        };
        InteractionGroups::new(member, filter, InteractionTestMode::And)
    }
}

/// A link whose solids are marked with their slots, from `slot` on.
fn insert_link(
    simulation: &mut Simulation,
    body: &Body,
    link: &Link,
    slot: &mut u128,
) -> RigidBodyHandle {
    // A spring wakes nothing, so nothing may sleep.
    let builder = RigidBodyBuilder::dynamic()
        .gravity_scale(0.0)
        .can_sleep(false);
    let handle = simulation.bodies.insert(builder);
    for (_, solid) in &link.solids {
        let collider = solid_collider(solid)
            .density(body.arm.density_kg_m3 as f32)
            .friction(body.object.friction as f32)
            .collision_groups(Role::Robot.groups())
            .user_data(*slot);
        *slot += 1;
        simulation
            .colliders
            .insert_with_parent(collider, handle, &mut simulation.bodies);
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

fn set_damping(
    simulation: &mut Simulation,
    body: &Body,
    links: &[Link],
    joints: &[MultibodyJointHandle],
) {
    let Simulation {
        bodies,
        multibody_joints,
        ..
    } = simulation;
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

fn insert_object(simulation: &mut Simulation, body: &Body) -> (RigidBodyHandle, ColliderHandle) {
    let far = Vector::new(0.0, -10.0, 0.0);
    let handle = simulation.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(far)
            .linear_damping(body.object.linear_damping as f32)
            .angular_damping(body.object.angular_damping as f32)
            .can_sleep(false),
    );
    let collider = ColliderBuilder::ball(ANY_RADIUS)
        .density(body.object.density_kg_m3 as f32)
        .friction(body.object.friction as f32)
        .collision_groups(Role::Object.groups())
        .user_data(OBJECT as u128);
    let collider =
        simulation
            .colliders
            .insert_with_parent(collider, handle, &mut simulation.bodies);
    (handle, collider)
}

fn insert_support(simulation: &mut Simulation, body: &Body) -> ColliderHandle {
    let plane = ColliderBuilder::halfspace(Unit::new_unchecked(Vector::Z))
        .friction(body.object.support_friction as f32)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(Role::Support.groups())
        .user_data(SUPPORT as u128)
        .enabled(false);
    simulation.colliders.insert(plane)
}

fn insert_obstacle(simulation: &mut Simulation, body: &Body) -> ColliderHandle {
    let half = body.obstacle.height_m as f32 / 2.0;
    // The engine's cylinders stand along y.
    let upright = Vector::X * std::f32::consts::FRAC_PI_2;
    let cylinder = ColliderBuilder::cylinder(half, ANY_RADIUS)
        .rotation(upright)
        .friction(body.object.friction as f32)
        .collision_groups(Role::Obstacle.groups())
        .user_data(OBSTACLE as u128)
        .enabled(false);
    simulation.colliders.insert(cylinder)
}
