//! What commands cost, estimated from their numbers: a file from anybody must not keep a machine busy for
//! hours.

use babble_env::{AnyTask, Config};
use serde_json::Value;

use crate::fault::Fault;

/// Most work of a session, in seconds of one thread of a usual machine.
const MOST_SECONDS: f64 = 1_800.0;
/// Most weights of an agent.
const MOST_WEIGHTS: usize = 10_000_000;

/// A step of physics without and with contacts \[s\].
const PHYSICS_STEP_S: [f64; 2] = [15e-9, 7e-6];
/// The rest of a control step, the eye's part without and with its image \[s\].
const CONTROL_STEP_S: [f64; 2] = [1e-6, 20e-6];
/// One weight in one application of a rule \[s\].
const WEIGHT_S: f64 = 0.5e-9;
/// How often a rule is applied within a second of a babble, and for how long, if the brain has a period.
const MOVING_S: f64 = 6.0;

/// What was spent so far \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Cost(f64);

impl Cost {
    /// Adds the cost of some control steps.
    pub(crate) fn add_steps(&mut self, task: &dyn AnyTask, steps: u64) {
        let Config { reach, grasp, .. } = task.config();
        let touches = task.unconverged_steps().is_some();
        let kind = usize::from(touches);
        let physics = if touches {
            grasp.physics_steps
        } else {
            reach.physics_steps
        };
        let each = CONTROL_STEP_S[kind] + f64::from(physics) * PHYSICS_STEP_S[kind];
        self.0 += steps as f64 * each;
    }

    /// Adds the cost of learning from babbles.
    pub(crate) fn add_learning(&mut self, babbles: u64, weights: usize, brain: &Value) {
        let period = brain.get("learning_period_s").and_then(Value::as_f64);
        let times = period.map_or(1.0, |s| MOVING_S / s);
        self.0 += babbles as f64 * times * weights as f64 * WEIGHT_S;
    }

    /// Checks that a session may cost so much.
    pub(crate) fn check(self) -> Result<(), Fault> {
        if self.0 <= MOST_SECONDS {
            return Ok(());
        }
        let problem = format!(
            "the commands of one session take more than about {MOST_SECONDS} s of computing: begin anew"
        );
        Err(Fault::config("n", problem))
    }
}

/// Checks that the maps of a brain are not too large together, before they are made.
pub(crate) fn check_weights(brain: &Value) -> Result<(), Fault> {
    let side = |name: &str| {
        brain
            .get(name)
            .and_then(Value::as_u64)
            .unwrap_or(1)
            .min(1_000) as usize
    };
    let square = |name: &str| side(name) * side(name);
    let neurons = if brain.get("output_neurons").is_some() {
        let pairs = if brain["variant"] == "conjunctive" {
            square("target_neurons")
        } else {
            1
        };
        [pairs * square("obstacle_neurons"), square("output_neurons")]
    } else if brain.get("eye_neurons").is_some() {
        [3 * side("sizes") * square("eye_neurons"), square("neurons")]
    } else {
        [square("neurons"), square("neurons")]
    };
    let weights = neurons[0].saturating_mul(neurons[1]);
    if weights <= MOST_WEIGHTS {
        return Ok(());
    }
    let problem = format!("maps of {weights} weights: there are at most {MOST_WEIGHTS} in the lab");
    Err(Fault::config("brain", problem))
}
