//! The log of all that a world was made to do.
//!
//! rapier cannot check a state of its own that was written by somebody else. So that state is never
//! written. The inputs that led to it are: they can be checked, and replayed.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::config::Body;
use crate::error::BodyError;
use crate::robot::kinematics::MAX_JOINTS;
use crate::robot::mechanics::MechanicalState;
use crate::robot::muscles::{MuscleCommand, MuscleCommands};

/// How a world began, and the inputs of each step since.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct InputLog {
    /// Angles of the joints at the beginning \[rad\].
    pub(super) q: [f64; MAX_JOINTS],
    /// Centre of the object at the beginning \[m\].
    pub(super) centre: Vector3<f64>,
    pub(super) runs: Vec<InputRun>,
}

/// Steps in a row with the same inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct InputRun {
    pub(super) commands: MuscleCommands,
    /// Whether the object's support was there.
    pub(super) support: bool,
    pub(super) steps: u32,
}

impl InputRun {
    /// Whether these are its inputs, to the bit: a zero's sign goes on into the motion.
    fn has(&self, commands: &MuscleCommands, support: bool) -> bool {
        let bits = |command: &MuscleCommand| match *command {
            MuscleCommand::EquilibriumPoint(point) => (false, point.to_bits()),
            MuscleCommand::Torque(torque) => (true, torque.to_bits()),
        };
        self.support == support && self.commands.iter().map(bits).eq(commands.iter().map(bits))
    }
}

impl InputLog {
    /// The log of a world before its first step.
    pub(super) const fn new(mechanics: &MechanicalState) -> Self {
        Self {
            q: mechanics.q,
            centre: mechanics.ball.centre,
            runs: Vec::new(),
        }
    }

    /// Adds the inputs of one step.
    pub(super) fn add(&mut self, commands: &MuscleCommands, support: bool) {
        match self.runs.last_mut() {
            Some(last) if last.has(commands, support) => last.steps += 1,
            _ => self.runs.push(InputRun {
                commands: *commands,
                support,
                steps: 1,
            }),
        }
    }

    /// Checks that a world can have these inputs: it began as `start`, at most `steps` steps ago, its
    /// support never came back, and its muscles can follow the commands.
    pub(super) fn check(
        &self,
        mechanics: &MechanicalState,
        start: &MechanicalState,
        steps: u64,
        bounds: &CommandBounds,
    ) -> Result<(), BodyError> {
        if self.q != start.q || self.centre != start.ball.centre {
            return Err(BodyError::world("it did not begin as the case does"));
        }
        let all: u64 = self.runs.iter().map(|run| u64::from(run.steps)).sum();
        if all > steps {
            return Err(BodyError::world(&format!(
                "{all} physics steps, not in [0, {steps}]"
            )));
        }
        let mut supported = start.support;
        for support in self
            .runs
            .iter()
            .map(|run| run.support)
            .chain([mechanics.support])
        {
            if support && !supported {
                return Err(BodyError::world("its support was gone and came back"));
            }
            supported = support;
        }
        let commands = self
            .runs
            .iter()
            .flat_map(|run| run.commands.into_iter().enumerate());
        for (group, command) in commands {
            if let Some((value, [low, high])) = bounds.excess(group, command) {
                return Err(BodyError::world(&format!(
                    "a muscle pulled to {value}, not in [{low}, {high}]"
                )));
            }
        }
        Ok(())
    }
}

/// What muscles can be commanded to do.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommandBounds {
    /// Lowest and highest equilibrium point of each group \[rad\].
    ranges: [[f64; 2]; 4],
    /// Largest torque of each group \[N·m\].
    torque_max: [f64; 4],
}

impl CommandBounds {
    pub(super) fn new(body: &Body, ranges: [[f64; 2]; 4]) -> Self {
        let [arm, hand] = [body.grip.arm_muscles, body.grip.hand_muscles];
        Self {
            ranges,
            torque_max: [arm, arm, hand, hand].map(|muscles| muscles.torque_max),
        }
    }

    /// The value of a command and its bounds, if it is out of them.
    fn excess(&self, group: usize, command: MuscleCommand) -> Option<(f64, [f64; 2])> {
        let (value, [low, high]) = match command {
            MuscleCommand::EquilibriumPoint(point) => (point, self.ranges[group]),
            MuscleCommand::Torque(torque) => {
                let most = self.torque_max[group];
                (torque, [-most, most])
            }
        };
        // Shares of a range may round to a little beyond it.
        let margin = 1e-9 * (high - low);
        let inside = (low - margin..=high + margin).contains(&value);
        (!inside).then_some((value, [low, high]))
    }
}
