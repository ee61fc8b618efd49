//! The maps of a learning agent for what it senses now.

pub use babble_agent::network::Axis;
use serde::Serialize;

use crate::agent::{LearnerMind, task_name};
use crate::command::MapName;
use crate::fault::Fault;
use crate::lab::Lab;

/// Activities of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapActivity {
    /// What the map stands for.
    pub name: String,
    /// Neurons along the axes, the last axis fastest.
    pub shape: Vec<usize>,
    /// What the axes stand for.
    pub axes: Vec<Axis>,
    /// The activities; not part of the JSON, as there are many.
    #[serde(skip)]
    pub activity: Vec<f32>,
}

/// An association and its two maps.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AssociationView {
    /// What the output map stands for.
    pub name: String,
    /// The map that perceives.
    pub input: MapActivity,
    /// The map that is recalled.
    pub output: MapActivity,
    /// Silenced neurons of the input map.
    pub silenced_inputs: Vec<usize>,
    /// Silenced neurons of the output map.
    pub silenced_outputs: Vec<usize>,
}

/// A number that the output maps are read out as.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecidedNumber {
    /// What it is.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// The maps of a learning agent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Brain {
    /// The associations that act.
    pub associations: Vec<AssociationView>,
    /// What the output maps are read out as.
    pub decided: Vec<DecidedNumber>,
}

/// Names and units of what is decided, by its length.
const DECIDED: [&[(&str, &str)]; 3] = [
    &[("b1", ""), ("b2", "")],
    &[
        ("shoulder", "share of range"),
        ("elbow", "share of range"),
        ("thumb", "deg"),
        ("finger", "deg"),
    ],
    &[
        ("shoulder before the grasp", "share of range"),
        ("elbow before the grasp", "share of range"),
        ("shoulder at contact", "share of range"),
        ("elbow at contact", "share of range"),
        ("thumb", "deg"),
        ("finger", "deg"),
    ],
];

impl Lab {
    /// The maps of an agent for what it senses now; none for an agent without maps.
    ///
    /// # Errors
    /// A [`Fault`] for an agent that does not exist.
    pub fn brain(&self, agent: usize) -> Result<Option<Brain>, Fault> {
        let Some(mind) = self.agent(agent)?.learner() else {
            return Ok(None);
        };
        let senses = &self.stage.record(agent)?.senses;
        let percepts = mind.learner.perceive(senses)?;
        let recalls = mind.learner.recall(senses)?;
        let shapes = mind.learner.input_shapes();
        let axes = mind.learner.axes();
        let mut associations = Vec::new();
        let maps = percepts.into_iter().zip(recalls).zip(axes);
        for (i, ((percept, recall), [of_input, of_output])) in maps.enumerate() {
            associations.push(AssociationView {
                name: recall.name.to_owned(),
                input: MapActivity {
                    name: percept.name.to_owned(),
                    shape: shapes[i].clone(),
                    axes: of_input,
                    activity: percept.activity,
                },
                output: MapActivity {
                    name: recall.name.to_owned(),
                    shape: vec![recall.side; 2],
                    axes: of_output,
                    activity: recall.activity,
                },
                silenced_inputs: silenced(mind, i, MapName::Input),
                silenced_outputs: silenced(mind, i, MapName::Output),
            });
        }
        let decided = mind.learner.decide(senses)?;
        let named = DECIDED.iter().find(|named| named.len() == decided.len());
        let named = named.copied().unwrap_or_default();
        let decided = named.iter().zip(decided);
        let number = |(&(name, unit), value)| DecidedNumber { name, value, unit };
        Ok(Some(Brain {
            associations,
            decided: decided.map(number).collect(),
        }))
    }

    /// Weights of one neuron with all neurons of the other map, in that map's shape.
    ///
    /// # Errors
    /// A [`Fault`] that names the number out of bounds, or for an agent that does not learn.
    pub fn weights(
        &self,
        agent: usize,
        association: usize,
        map: MapName,
        neuron: usize,
    ) -> Result<MapActivity, Fault> {
        let mind = self.learner(agent)?;
        let found = mind.checked(association, map, &[neuron])?;
        let (n_in, n_out) = (found.n_in(), found.n_out());
        let all = found.weights();
        let input = mind.learner.input_shapes().swap_remove(association);
        let [of_input, of_output] = mind.learner.axes().swap_remove(association);
        let (name, shape, axes, activity) = match map {
            MapName::Output => {
                let weights = all[neuron * n_in..][..n_in].to_vec();
                ("input", input, of_input, weights)
            }
            MapName::Input => {
                let weights = (0..n_out).map(|j| all[j * n_in + neuron]);
                (
                    "output",
                    vec![n_out.isqrt(); 2],
                    of_output,
                    weights.collect(),
                )
            }
        };
        Ok(MapActivity {
            name: name.to_owned(),
            shape,
            axes,
            activity,
        })
    }

    /// What each number of the observation of an agent belongs to, and the numbers.
    pub(crate) fn senses(&self, agent: usize) -> Result<Vec<(&'static str, Vec<f32>)>, Fault> {
        let record = self.stage.record(agent)?;
        let mut at = 0;
        let mut senses = Vec::new();
        for entry in self.task.spec().senses {
            let end = at + entry.labels.len();
            senses.push((entry.name, record.senses[at..end].to_vec()));
            at = end;
        }
        debug_assert_eq!(at, record.senses.len(), "{:?}", task_name(&self.setup));
        Ok(senses)
    }
}

fn silenced(mind: &LearnerMind, association: usize, map: MapName) -> Vec<usize> {
    let of_map = |lesion: &&(usize, MapName, usize)| (lesion.0, lesion.1) == (association, map);
    let found = mind.lesions.iter().filter(of_map);
    found.map(|&(_, _, neuron)| neuron).collect()
}
