//! What a world of rapier's remembers: the engine's state, and all that led to it.
//!
//! The engine cannot check a state of its own that was written by somebody else. So it is never
//! written, but made again from what the robot was made to do, which can be checked.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::State;
use crate::robot::kinematics::MAX_JOINTS;
use crate::robot::muscles::{MuscleCommand, MuscleCommands};
use crate::robot::world::World;

/// The engine's state and what led to it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::robot) struct Memory {
    pub(in crate::robot) past: Past,
    /// Missing in what was read.
    #[serde(skip)]
    pub(super) state: Option<State>,
}

impl Memory {
    /// That of a world before its first step.
    pub(super) fn of(world: &World) -> Self {
        let past = Past {
            q: world.q,
            centre: world.ball.centre,
            spells: Vec::new(),
        };
        Self { past, state: None }
    }

    /// Whether the engine's state has to be made again.
    pub(in crate::robot) const fn is_bare(&self) -> bool {
        self.state.is_none()
    }
}

/// How a world began, and what was done to it in each step since.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::robot) struct Past {
    /// \[rad\]
    pub(in crate::robot) q: [f64; MAX_JOINTS],
    /// Of the object \[m\].
    pub(in crate::robot) centre: Vector3<f64>,
    pub(in crate::robot) spells: Vec<Spell>,
}

/// Steps that are driven alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::robot) struct Spell {
    pub(in crate::robot) drive: MuscleCommands,
    pub(in crate::robot) support: bool,
    pub(in crate::robot) steps: u32,
}

impl Spell {
    /// To the bit: a zero's sign goes on into the motion.
    fn is(&self, drive: &MuscleCommands, support: bool) -> bool {
        let bits = |pull: &MuscleCommand| match *pull {
            MuscleCommand::EquilibriumPoint(point) => (false, point.to_bits()),
            MuscleCommand::Torque(torque) => (true, torque.to_bits()),
        };
        self.support == support && self.drive.iter().map(bits).eq(drive.iter().map(bits))
    }
}

impl Past {
    pub(super) fn add(&mut self, drive: &MuscleCommands, support: bool) {
        match self.spells.last_mut() {
            Some(last) if last.is(drive, support) => last.steps += 1,
            _ => self.spells.push(Spell {
                drive: *drive,
                support,
                steps: 1,
            }),
        }
    }
}
