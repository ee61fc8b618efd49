//! Checks of a world that came from outside.

use super::engine::FASTEST_TURN;
use super::mechanics::MechanicalState;
use super::model::Robot;
use super::setup::Setup;
use super::world::World;
use crate::error::BodyError;

/// No angle \[rad\] or place \[m\] gets there.
const MOST: f64 = 1e9;

impl Robot {
    /// Checks a world that somebody else wrote, which began as `begin` at most `steps` physics steps
    /// ago, and takes what rapier has to know of it from a simulation of those steps.
    ///
    /// A world of the tree engine passes if all of its numbers are finite and in bounds: it goes on,
    /// whether it can have got there or not. One of rapier passes if it got there.
    ///
    /// # Errors
    /// [`BodyError::World`] naming what is wrong, after which the world should not be stepped.
    pub fn check(&self, world: &mut World, begin: &Setup, steps: u64) -> Result<(), BodyError> {
        let World { mechanics, engine } = world;
        if mechanics.ball.radius != begin.ball.radius || mechanics.obstacle != begin.obstacle {
            return Err(BodyError::world("object or obstacle is not the case's"));
        }
        self.check_numbers(mechanics)?;
        let start = self.world(begin).mechanics;
        self.engine.restore(mechanics, engine, &start, steps)
    }

    fn check_numbers(&self, mechanics: &MechanicalState) -> Result<(), BodyError> {
        let links = self.links.len();
        let ball = &mechanics.ball;
        let turn = FASTEST_TURN / self.dt * (1.0 + f64::EPSILON);
        // Nothing gets faster than what pushes it.
        let speed = 100.0 / self.dt;
        let contact = &self.body.contact;
        let impulse = contact.stiffness_n_m * (self.dt + 200.0 * (contact.relaxation_s + self.dt));
        for (what, values, [low, high]) in [
            ("a joint's angle", &mechanics.q[..links], [-MOST, MOST]),
            ("a joint's speed", &mechanics.v[..links], [-turn, turn]),
            ("an impulse", &mechanics.impulses, [0.0, impulse]),
            ("the depth", &[mechanics.depth], [0.0, 10.0]),
            ("the object's place", ball.centre.as_slice(), [-MOST, MOST]),
            (
                "the object's velocity",
                ball.velocity.as_slice(),
                [-speed, speed],
            ),
            (
                "the object's spin",
                (ball.spin * ball.radius).as_slice(),
                [-speed, speed],
            ),
        ] {
            if let Some(value) = values.iter().find(|x| !(low..=high).contains(*x)) {
                return Err(BodyError::world(&format!(
                    "{what} is {value}, not in [{low}, {high}]"
                )));
            }
        }
        let beyond = mechanics.q[links..].iter().chain(&mechanics.v[links..]);
        if beyond.into_iter().any(|&x| x != 0.0) {
            return Err(BodyError::world("a joint moves that there is not"));
        }
        Ok(())
    }
}
