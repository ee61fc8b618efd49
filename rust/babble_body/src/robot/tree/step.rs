//! A physics step of the tree engine.

use nalgebra::Vector3;

use super::contact_cost::note_contacts;
use super::factor::{BALL, Velocities};
use super::model::Tree;
use super::speeds::Speeds;
use crate::error::BodyError;
use crate::robot::engine::{Engine, FASTEST_TURN};
use crate::robot::kinematics::place;
use crate::robot::mechanics::MechanicalState;
use crate::robot::muscles::MuscleCommands;

impl Engine for Tree {
    /// A world's mechanical state is all that there is.
    type State = ();

    fn start(&self, _: &MechanicalState) {}

    fn step(&self, mechanics: &mut MechanicalState, (): &mut (), commands: &MuscleCommands) {
        let springs = self.muscles.springs(commands, &mechanics.q);
        let poses = place(&self.links, |i| mechanics.q[i]);
        let equations = self.equations(mechanics, &poses, &springs);
        let free = self.without_contacts(&equations);
        let speeds = Speeds::of(&self.links, &poses, &free[BALL..]);
        let costs = self.contacts(mechanics, &poses, &speeds, &free);
        let mut velocities = self.with_contacts(mechanics, &poses, &equations, free, &costs);
        self.limit(&mut velocities);
        note_contacts(mechanics, &velocities, &costs);
        self.move_on(mechanics, &velocities);
    }

    fn restore(
        &self,
        _: &MechanicalState,
        (): &mut (),
        _: &MechanicalState,
        _: u64,
    ) -> Result<(), BodyError> {
        Ok(())
    }
}

impl Tree {
    /// Keeps joints from turning further than a quarter turn in a step: beyond that, centrifugal forces
    /// of its beginning say nothing of its end, and weak damping would let them grow without bound.
    fn limit(&self, velocities: &mut Velocities) {
        let most = FASTEST_TURN / self.dt;
        for velocity in &mut velocities[self.sparsity.joints()] {
            *velocity = velocity.clamp(-most, most);
        }
    }

    fn move_on(&self, mechanics: &mut MechanicalState, velocities: &Velocities) {
        let dt = self.dt;
        let joints = &velocities[self.sparsity.joints()];
        for ((v, q), &velocity) in mechanics.v.iter_mut().zip(&mut mechanics.q).zip(joints) {
            *v = velocity;
            *q += dt * velocity;
        }
        let ball = &mut mechanics.ball;
        ball.velocity = Vector3::new(velocities[0], velocities[1], velocities[2]);
        ball.spin = Vector3::new(velocities[3], velocities[4], velocities[5]);
        ball.centre += ball.velocity * dt;
    }
}
