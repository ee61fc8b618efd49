//! A physics step of rapier's, and the engine's state of a world.

use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use super::input_log::InputLog;
use super::model::{FREE_AXIS, Rapier};
use super::seam::{from_vector, vector};
use super::simulation::Simulation;
use crate::error::BodyError;
use crate::robot::contact_slots::{SLOTS, SOLIDS};
use crate::robot::engine::{Engine, GRAVITY};
use crate::robot::mechanics::{MechanicalState, MovingBall};
use crate::robot::muscles::{MuscleCommands, Spring};

/// A world's inputs, and rapier's own state, to which they lead.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::robot) struct RapierState {
    log: InputLog,
    /// None before the first step, and in what was read: the log is replayed then.
    #[serde(skip)]
    simulation: Option<Simulation>,
}

impl Engine for Rapier {
    type State = RapierState;

    fn start(&self, mechanics: &MechanicalState) -> RapierState {
        RapierState {
            log: InputLog::new(mechanics),
            simulation: None,
        }
    }

    fn step(
        &self,
        mechanics: &mut MechanicalState,
        state: &mut RapierState,
        commands: &MuscleCommands,
    ) {
        let RapierState { log, simulation } = state;
        let simulation = simulation.get_or_insert_with(|| self.replay(log, mechanics).1);
        log.add(commands, mechanics.support);
        self.advance(mechanics, simulation, commands);
    }

    /// Passes if the log can be of such a world, and leads to where the world is.
    fn restore(
        &self,
        mechanics: &MechanicalState,
        state: &mut RapierState,
        start: &MechanicalState,
        steps: u64,
    ) -> Result<(), BodyError> {
        state.log.check(mechanics, start, steps, &self.bounds)?;
        let (mut replayed, simulation) = self.replay(&state.log, start);
        // A support that was removed after the last step is not in the log.
        replayed.support = mechanics.support;
        if replayed != *mechanics {
            return Err(BodyError::world("it is not where its past leads to"));
        }
        state.simulation = Some(simulation);
        Ok(())
    }
}

impl Rapier {
    fn advance(
        &self,
        mechanics: &mut MechanicalState,
        simulation: &mut Simulation,
        commands: &MuscleCommands,
    ) {
        if simulation.colliders[self.support].is_enabled() != mechanics.support {
            simulation.colliders[self.support].set_enabled(mechanics.support);
        }
        let springs = self.muscles.springs(commands, &mechanics.q);
        self.set_springs(simulation, &mechanics.q, &springs[..self.joints.len()]);
        simulation.step(Vector::new(0.0, 0.0, -GRAVITY as f32), &self.parameters);
        self.read_motion(simulation, mechanics);
        self.read_contacts(simulation, mechanics);
    }

    /// The world that a log leads to, with the object and the obstacle of `mechanics`.
    fn replay(&self, log: &InputLog, mechanics: &MechanicalState) -> (MechanicalState, Simulation) {
        let ball = MovingBall::at_rest(log.centre, mechanics.ball.radius);
        let mut mechanics = MechanicalState::at_rest(log.q, ball, mechanics.obstacle);
        let mut simulation = self.begin(&mechanics);
        for run in &log.runs {
            mechanics.support = run.support;
            for _ in 0..run.steps {
                self.advance(&mut mechanics, &mut simulation, &run.commands);
            }
        }
        (mechanics, simulation)
    }

    /// The simulation of a world at rest.
    fn begin(&self, mechanics: &MechanicalState) -> Simulation {
        let mut simulation = self.template.clone();
        self.place_joints(&mut simulation, &mechanics.q);
        let object = &mut simulation.bodies[self.object];
        object.set_translation(vector(&mechanics.ball.centre), true);
        let radius = mechanics.ball.radius as f32;
        simulation.colliders[self.object_collider].set_shape(SharedShape::ball(radius));
        let support = &mut simulation.colliders[self.support];
        support.set_translation(Vector::new(0.0, 0.0, -radius));
        if let Some(obstacle) = mechanics.obstacle {
            let collider = &mut simulation.colliders[self.obstacle];
            let shape = SharedShape::cylinder(self.half_height, obstacle.radius as f32);
            collider.set_shape(shape);
            collider.set_translation(vector(&obstacle.centre.push(0.0)));
            collider.set_enabled(true);
        }
        simulation
    }

    /// Turns every joint of the template by an angle \[rad\].
    fn place_joints(&self, simulation: &mut Simulation, q: &[f64]) {
        let Simulation {
            bodies,
            colliders,
            multibody_joints,
            ..
        } = simulation;
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

    fn set_springs(&self, simulation: &mut Simulation, q: &[f64], springs: &[Spring]) {
        let Some((multibody, _)) = simulation.multibody_joints.get_mut(self.joints[0]) else {
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

    fn read_motion(&self, simulation: &Simulation, mechanics: &mut MechanicalState) {
        if let Some((multibody, _)) = simulation.multibody_joints.get(self.joints[0]) {
            let speeds = multibody.generalized_velocity();
            for (i, joint) in multibody.links().skip(1).enumerate() {
                mechanics.q[i] = joint.joint().coords()[FREE_AXIS].into();
                mechanics.v[i] = speeds[i].into();
            }
        }
        let object = &simulation.bodies[self.object];
        mechanics.ball.centre = from_vector(object.translation());
        mechanics.ball.velocity = from_vector(object.linvel());
        mechanics.ball.spin = from_vector(object.angvel());
    }

    fn read_contacts(&self, simulation: &Simulation, mechanics: &mut MechanicalState) {
        mechanics.impulses = [0.0; SLOTS];
        mechanics.depth = 0.0;
        let mark = |handle: ColliderHandle| simulation.colliders[handle].user_data as usize;
        for pair in simulation
            .narrow_phase
            .contact_pairs_with(self.object_collider)
        {
            let slot = mark(other(pair, self.object_collider));
            mechanics.impulses[slot] = normal_impulse(pair);
            if slot < SOLIDS {
                mechanics.depth = mechanics.depth.max(depth(pair));
            }
        }
        mechanics.hit = simulation
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
