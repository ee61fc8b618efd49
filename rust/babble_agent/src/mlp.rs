//! Networks of layers that were trained elsewhere, as PPO's, and act step by step.

use std::sync::Arc;

use babble_brain::association::dot;
use babble_env::spec::Spec;
use babble_env::{AnyTask, Config, Options, registry};
use serde::{Deserialize, Serialize};

use crate::error::AgentError;
use crate::policy::{Plan, Policy};
use crate::tensors::{self, Shaped, Tensor, whole_config};

/// Version of the files.
const VERSION: u32 = 1;
/// Most layers of a network.
const MOST_LAYERS: usize = 8;
/// Most neurons of a layer, and most numbers of an observation.
const MOST_NEURONS: usize = 4096;

/// What a neuron of a hidden layer does with its input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// max(0, x)
    Relu,
    /// The hyperbolic tangent.
    Tanh,
}

/// How the last layer's outputs are brought within the bounds of the action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Output {
    /// They are the action; beyond a bound they are the bound.
    Clip,
    /// The hyperbolic tangent, stretched from −1…1 to the bounds.
    Tanh,
}

/// What is known of a network beside its weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    /// Version of this format.
    pub version: u32,
    /// Algorithm that trained it, for people.
    pub algorithm: String,
    /// Name of the task in the registry.
    pub task: String,
    /// Options of the environment that it acts in, where they differ from the task's defaults.
    pub options: Options,
    /// Config of body and task.
    #[serde(deserialize_with = "whole_config")]
    pub config: Config,
    /// Names of the senses in a flat observation, and how many numbers each has.
    pub senses: Vec<(String, usize)>,
    /// What hidden neurons do.
    pub activation: Activation,
    /// What becomes of the outputs.
    pub output: Output,
}

/// Weights (outputs × inputs, row by row) and biases of the neurons of a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    inputs: usize,
    weights: Vec<f32>,
    biases: Vec<f32>,
}

impl Layer {
    /// The inputs of the layer's neurons for the activities `x` of those before.
    fn apply(&self, x: &[f32]) -> Vec<f32> {
        let rows = self.weights.chunks_exact(self.inputs).zip(&self.biases);
        rows.map(|(row, bias)| dot(row, x) + bias).collect()
    }
}

/// A network that maps a flat observation to an action. Sums have a fixed order and tanh is libm's, so its
/// actions are the same bits everywhere.
#[derive(Debug, Clone)]
pub struct PolicyNetwork {
    about: About,
    layers: Vec<Layer>,
    task: Arc<dyn AnyTask>,
    /// Bounds of each number of the action.
    bounds: Vec<[f32; 2]>,
}

impl PolicyNetwork {
    /// What a file of such a network is called in its header.
    pub const KEY: &'static str = "gym_babble.policy";

    /// The network in the bytes of a safetensors file, with tensors `0.weight` (outputs × inputs), `0.bias`
    /// (outputs), `1.weight` and so on.
    ///
    /// # Errors
    /// [`AgentError::File`] for bytes that are cut short, altered, or no such network, with layers that do not
    /// fit each other or the task, or with numbers that are not finite; [`AgentError::Env`] for a task, options
    /// or config that are unknown or out of bounds.
    pub fn load(bytes: &[u8]) -> Result<Self, AgentError> {
        let layers = tensors::count(bytes)? / 2;
        if layers == 0 || layers > MOST_LAYERS {
            return Err(refused(format!(
                "{layers} layers; a network has 1 to {MOST_LAYERS}"
            )));
        }
        let names: Vec<String> = (0..layers)
            .flat_map(|i| [format!("{i}.weight"), format!("{i}.bias")])
            .collect();
        let (json, values) = tensors::read(Self::KEY, bytes, &names)?;
        let about: About = serde_path_to_error::deserialize(tensors::fields(&json)?)
            .map_err(|e| tensors::file(&e))?;
        if about.version != VERSION {
            return Err(refused(format!(
                "version {} is not {VERSION}",
                about.version
            )));
        }
        about.config.validate()?;
        let task = registry::task(&about.task)?.make(about.config.clone(), &about.options)?;
        let layers: Vec<Layer> = values
            .as_chunks::<2>()
            .0
            .iter()
            .enumerate()
            .map(layer)
            .collect::<Result<_, _>>()?;
        let spec = task.spec();
        check_senses(&about, &spec)?;
        check_fit(&layers, &spec)?;
        let bounds = spec.action.low.iter().zip(&spec.action.high);
        let bounds = bounds
            .map(|(&low, &high)| [low as f32, high as f32])
            .collect();
        Ok(Self {
            about,
            layers,
            task,
            bounds,
        })
    }

    /// The network as the bytes of a file.
    ///
    /// # Errors
    /// [`AgentError::File`] if it cannot be written.
    pub fn save(&self) -> Result<Vec<u8>, AgentError> {
        let tensors: Vec<Tensor> = self
            .layers
            .iter()
            .enumerate()
            .flat_map(|(i, layer)| {
                let outputs = layer.biases.len();
                [
                    Tensor {
                        name: format!("{i}.weight"),
                        shape: vec![outputs, layer.inputs],
                        values: &layer.weights,
                    },
                    Tensor {
                        name: format!("{i}.bias"),
                        shape: vec![outputs],
                        values: &layer.biases,
                    },
                ]
            })
            .collect();
        tensors::write(Self::KEY, &self.about, &tensors)
    }

    /// What is known of it beside its weights.
    #[must_use]
    pub const fn about(&self) -> &About {
        &self.about
    }

    /// The task that it acts in, of its own options and config.
    #[must_use]
    pub const fn task(&self) -> &Arc<dyn AnyTask> {
        &self.task
    }

    /// The outputs of the last layer for a flat observation.
    fn outputs(&self, senses: &[f32]) -> Vec<f32> {
        let mut x = senses.to_vec();
        for (i, layer) in self.layers.iter().enumerate() {
            x = layer.apply(&x);
            if i + 1 == self.layers.len() {
                break;
            }
            match self.about.activation {
                // f32::max may return either of two zeros, so its bits are not the same everywhere.
                Activation::Relu => x
                    .iter_mut()
                    .for_each(|x| *x = if *x > 0.0 { *x } else { 0.0 }),
                Activation::Tanh => x.iter_mut().for_each(|x| *x = libm::tanhf(*x)),
            }
        }
        x
    }
}

impl Policy for PolicyNetwork {
    fn senses_len(&self) -> usize {
        self.layers[0].inputs
    }

    fn action_len(&self) -> usize {
        self.bounds.len()
    }

    fn act(&self, _plan: &mut Plan, senses: &[f32], action: &mut [f32]) -> Result<(), AgentError> {
        let outputs = self.outputs(senses);
        for ((action, x), [low, high]) in action.iter_mut().zip(outputs).zip(&self.bounds) {
            *action = match self.about.output {
                Output::Clip => x.clamp(*low, *high),
                Output::Tanh => low + 0.5 * (libm::tanhf(x) + 1.0) * (high - low),
            };
            if !action.is_finite() {
                return Err(AgentError::Config {
                    field: "agent",
                    problem: format!(
                        "the network's weights are so large that an action is {action}"
                    ),
                });
            }
        }
        Ok(())
    }
}

/// A layer from its tensors: weights and biases.
fn layer((i, [weights, biases]): (usize, &[Shaped; 2])) -> Result<Layer, AgentError> {
    let (shape, weights) = weights;
    let &[outputs, inputs] = shape.as_slice() else {
        return Err(refused(format!(
            "{i}.weight has {} axes, expected 2",
            shape.len()
        )));
    };
    if biases.0 != [outputs] {
        return Err(refused(format!(
            "{i}.bias has shape {:?}, expected [{outputs}]",
            biases.0
        )));
    }
    for (what, n) in [("outputs", outputs), ("inputs", inputs)] {
        if n == 0 || n > MOST_NEURONS {
            return Err(refused(format!(
                "{i}.weight has {n} {what}, expected 1 to {MOST_NEURONS}"
            )));
        }
    }
    if let Some(x) = weights.iter().chain(&biases.1).find(|x| !x.is_finite()) {
        return Err(refused(format!("layer {i} has the weight {x}")));
    }
    Ok(Layer {
        inputs,
        weights: weights.clone(),
        biases: biases.1.clone(),
    })
}

/// Checks that the network was trained on the task's senses.
fn check_senses(about: &About, spec: &Spec) -> Result<(), AgentError> {
    let senses = spec
        .senses
        .iter()
        .map(|sense| (sense.name, sense.labels.len()));
    if about
        .senses
        .iter()
        .map(|(name, n)| (name.as_str(), *n))
        .eq(senses.clone())
    {
        return Ok(());
    }
    let senses: Vec<_> = senses.collect();
    Err(refused(format!(
        "senses {:?}; the task has {senses:?}",
        about.senses
    )))
}

/// Checks that each layer fits the one before, the first one the senses and the last one the action.
fn check_fit(layers: &[Layer], spec: &Spec) -> Result<(), AgentError> {
    let mut expected = spec.senses.iter().map(|sense| sense.labels.len()).sum();
    for (i, layer) in layers.iter().enumerate() {
        if layer.inputs != expected {
            return Err(refused(format!(
                "layer {i} has {} inputs, expected {expected}",
                layer.inputs
            )));
        }
        expected = layer.biases.len();
    }
    let action = spec.action.labels.len();
    if expected == action {
        return Ok(());
    }
    Err(refused(format!(
        "{expected} outputs, and an action has {action} numbers"
    )))
}

fn refused(problem: String) -> AgentError {
    AgentError::File { problem }
}
