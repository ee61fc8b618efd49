//! rapier3d as the engine: general, in single precision, and the reference of the one made for this
//! robot.

mod build;
mod memory;
mod seam;

use std::fmt;

use rapier3d::prelude::*;

pub(in crate::robot) use self::memory::{Memory, Past};
use self::seam::{from_vector, vector};
use super::GRAVITY;
use super::muscles::{MuscleCommands, Spring};
use super::touch::{SLOTS, SOLIDS};
use super::world::World;

/// Angular x: the free axis of a joint in its own frame.
const FREE_AXIS: usize = 3;
/// The object's mark; what can touch it has its slot.
const OBJECT: usize = SLOTS;

/// Everything that the engine carries from one step to the next.
#[derive(Clone, Default)]
struct State {
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    workspace: Workspace,
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("State")
            .field("bodies", &self.bodies.len())
            .field("colliders", &self.colliders.len())
            .finish_non_exhaustive()
    }
}

/// The engine's scratch memory, which holds nothing between steps.
#[derive(Default)]
struct Workspace {
    pipeline: PhysicsPipeline,
    ccd: CCDSolver,
}

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl State {
    fn step(&mut self, gravity: Vector, parameters: &IntegrationParameters) {
        self.workspace.pipeline.step(
            gravity,
            parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.workspace.ccd,
            &(),
            &(),
        );
    }
}

/// The engine's params, and a template of its worlds.
#[derive(Debug, Clone)]
pub(super) struct Rapier {
    template: State,
    parameters: IntegrationParameters,
    bodies: Vec<RigidBodyHandle>,
    joints: Vec<MultibodyJointHandle>,
    object: RigidBodyHandle,
    object_collider: ColliderHandle,
    support: ColliderHandle,
    obstacle: ColliderHandle,
    half_height: f32,
}

impl Rapier {
    /// One physics step with the springs that `drive` is. The engine's own state is made from the
    /// world's at the first one.
    pub(super) fn step(&self, world: &mut World, drive: &MuscleCommands, springs: &[Spring]) {
        let mut memory = world
            .rapier
            .take()
            .unwrap_or_else(|| Box::new(Memory::of(world)));
        memory.past.add(drive, world.support);
        let state = memory.state.get_or_insert_with(|| self.begin(world));
        if state.colliders[self.support].is_enabled() != world.support {
            state.colliders[self.support].set_enabled(world.support);
        }
        self.drive(state, &world.q, springs);
        state.step(Vector::new(0.0, 0.0, -GRAVITY as f32), &self.parameters);
        self.read_motion(state, world);
        self.read_contacts(state, world);
        world.rapier = Some(memory);
    }

    fn begin(&self, world: &World) -> State {
        let mut state = self.template.clone();
        self.place_joints(&mut state, &world.q);
        let object = &mut state.bodies[self.object];
        object.set_translation(vector(&world.ball.centre), true);
        let radius = world.ball.radius as f32;
        state.colliders[self.object_collider].set_shape(SharedShape::ball(radius));
        let support = &mut state.colliders[self.support];
        support.set_translation(Vector::new(0.0, 0.0, -radius));
        if let Some(obstacle) = world.obstacle {
            let collider = &mut state.colliders[self.obstacle];
            let shape = SharedShape::cylinder(self.half_height, obstacle.radius as f32);
            collider.set_shape(shape);
            collider.set_translation(vector(&obstacle.centre.push(0.0)));
            collider.set_enabled(true);
        }
        state
    }

    /// Turns every joint of the template by an angle \[rad\].
    fn place_joints(&self, state: &mut State, q: &[f64]) {
        let State {
            bodies,
            colliders,
            multibody_joints,
            ..
        } = state;
        let Some((multibody, _)) = multibody_joints.get_mut(self.joints[0]) else {
            return;
        };
        let angles: Vec<f32> = q[..self.joints.len()].iter().map(|&q| q as f32).collect();
        multibody.apply_displacements(&angles);
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

    fn drive(&self, state: &mut State, q: &[f64], springs: &[Spring]) {
        let Some((multibody, _)) = state.multibody_joints.get_mut(self.joints[0]) else {
            return;
        };
        // The root, which does not move, comes first.
        for ((joint, spring), q) in multibody.links_mut().skip(1).zip(springs).zip(q) {
            let (stiffness, rest) = as_spring(spring, *q);
            joint
                .joint
                .set_spring(FREE_AXIS, stiffness as f32, rest as f32);
        }
    }

    fn read_motion(&self, state: &State, world: &mut World) {
        if let Some((multibody, _)) = state.multibody_joints.get(self.joints[0]) {
            let speeds = multibody.generalized_velocity();
            for (i, joint) in multibody.links().skip(1).enumerate() {
                world.q[i] = joint.joint().coords()[FREE_AXIS].into();
                world.v[i] = speeds[i].into();
            }
        }
        let object = &state.bodies[self.object];
        world.ball.centre = from_vector(object.translation());
        world.ball.velocity = from_vector(object.linvel());
        world.ball.spin = from_vector(object.angvel());
    }

    fn read_contacts(&self, state: &State, world: &mut World) {
        world.impulses = [0.0; SLOTS];
        world.depth = 0.0;
        let mark = |handle: ColliderHandle| state.colliders[handle].user_data as usize;
        for pair in state.narrow_phase.contact_pairs_with(self.object_collider) {
            let slot = mark(other(pair, self.object_collider));
            world.impulses[slot] = normal_impulse(pair);
            if slot < SOLIDS {
                world.depth = world.depth.max(depth(pair));
            }
        }
        world.hit = state
            .narrow_phase
            .contact_pairs_with(self.obstacle)
            .any(|pair| mark(other(pair, self.obstacle)) < SOLIDS && normal_impulse(pair) > 0.0);
    }
}

/// A torque as a spring, as the engine adds those implicitly; so soft that it hardly varies within a
/// step.
fn as_spring(spring: &Spring, q: f64) -> (f64, f64) {
    const SOFT: f64 = 1e-3;
    if spring.torque == 0.0 {
        return (spring.stiffness, spring.rest);
    }
    let stiffness = SOFT * spring.torque.abs();
    (stiffness, q + spring.torque / stiffness)
}

fn normal_impulse(pair: &ContactPair) -> f64 {
    let points = pair.solver_manifolds().iter().flat_map(|m| &m.points);
    points.map(|point| f64::from(point.data.impulse)).sum()
}

fn depth(pair: &ContactPair) -> f64 {
    let points = pair.manifolds().iter().flat_map(|m| &m.points);
    points
        .map(|point| f64::from(-point.dist))
        .fold(0.0, f64::max)
}

fn other(pair: &ContactPair, one: ColliderHandle) -> ColliderHandle {
    if pair.collider1 == one {
        pair.collider2
    } else {
        pair.collider1
    }
}
