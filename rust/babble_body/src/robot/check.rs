//! Whether a world that somebody else wrote is one that this robot can go on with.

use super::muscles::MuscleCommand;
use super::rapier::Past;
use super::world::World;
use super::{FASTEST_TURN, Robot, Setup, Stepper};
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
        if world.ball.radius != begin.ball.radius || world.obstacle != begin.obstacle {
            return wrong("object or obstacle is not the case's");
        }
        self.check_numbers(world)?;
        match (&self.stepper, world.rapier.take()) {
            (Stepper::Tree(_), None) => Ok(()),
            (Stepper::Tree(_), Some(_)) => wrong("a state of rapier, which is not the engine"),
            (Stepper::Rapier(_), memory) => {
                let start = self.world(begin);
                let again = match memory {
                    None => start,
                    Some(memory) => {
                        self.check_past(&memory.past, &start, steps)?;
                        self.replay(&memory.past, begin.ball.radius, begin.obstacle)
                    }
                };
                take_over(world, again)
            }
        }
    }

    fn check_numbers(&self, world: &World) -> Result<(), BodyError> {
        let links = self.links.len();
        let ball = &world.ball;
        let turn = FASTEST_TURN / self.dt * (1.0 + f64::EPSILON);
        // Nothing gets faster than what pushes it.
        let speed = 100.0 / self.dt;
        let contact = &self.body.contact;
        let impulse = contact.stiffness_n_m * (self.dt + 200.0 * (contact.relaxation_s + self.dt));
        for (what, values, [low, high]) in [
            ("a joint's angle", &world.q[..links], [-MOST, MOST]),
            ("a joint's speed", &world.v[..links], [-turn, turn]),
            ("an impulse", &world.impulses, [0.0, impulse]),
            ("the depth", &[world.depth], [0.0, 10.0]),
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
                return wrong(&format!("{what} is {value}, not in [{low}, {high}]"));
            }
        }
        let beyond = world.q[links..].iter().chain(&world.v[links..]);
        if beyond.into_iter().any(|&x| x != 0.0) {
            return wrong("a joint moves that there is not");
        }
        Ok(())
    }

    /// Whether a past is one of `start`, in at most so many steps, by drives that there are.
    fn check_past(&self, past: &Past, start: &World, steps: u64) -> Result<(), BodyError> {
        if past.q != start.q || past.centre != start.ball.centre {
            return wrong("it did not begin as the case does");
        }
        let all: u64 = past.spells.iter().map(|spell| u64::from(spell.steps)).sum();
        if all == 0 || all > steps {
            return wrong(&format!("{all} physics steps, not in [1, {steps}]"));
        }
        if past
            .spells
            .windows(2)
            .any(|two| two[1].support && !two[0].support)
        {
            return wrong("its support was gone and came back");
        }
        let drives = past
            .spells
            .iter()
            .flat_map(|spell| spell.drive.iter().enumerate());
        for (muscle, pull) in drives {
            let (value, [low, high]) = match *pull {
                MuscleCommand::EquilibriumPoint(point) => (point, self.ranges[muscle]),
                MuscleCommand::Torque(torque) => {
                    let most = self.torque_max(muscle);
                    (torque, [-most, most])
                }
            };
            // Shares of a range may round to a little beyond it.
            let margin = 1e-9 * (high - low);
            if !(low - margin..=high + margin).contains(&value) {
                return wrong(&format!(
                    "a muscle pulled to {value}, not in [{low}, {high}]"
                ));
            }
        }
        Ok(())
    }

    /// Of shoulder, elbow, thumb or finger \[N·m\].
    const fn torque_max(&self, muscle: usize) -> f64 {
        let grip = &self.body.grip;
        if muscle < 2 {
            grip.arm_muscles.torque_max
        } else {
            grip.hand_muscles.torque_max
        }
    }
}

/// Puts what rapier knows into a world that is as its simulation ended.
fn take_over(world: &mut World, again: World) -> Result<(), BodyError> {
    let same = world.q == again.q
        && world.v == again.v
        && world.ball == again.ball
        && world.impulses == again.impulses
        && world.hit == again.hit
        && world.depth == again.depth;
    if !same {
        return wrong("it is not where its past leads to");
    }
    world.rapier = again.rapier;
    Ok(())
}

fn wrong(problem: &str) -> Result<(), BodyError> {
    Err(BodyError::World {
        problem: problem.to_owned(),
    })
}
