//! Neural maps and the association between them: from what is seen to how to move.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use babble_brain::{Association, ConjunctiveMap, MapConfig, PopulationMap};
use babble_env::ReachTask;
use babble_env::tasks::reach::{SENSES, at};
use serde::{Deserialize, Serialize};

use super::babbling::Experience;
use super::policy::{ChooseMovement, ReachPolicy};
use crate::error::AgentError;
use crate::network::{Activities, Axis, Network, Percept, Recall};
use crate::policy::{Policy, observation};
use crate::rule::Rule;

/// Which input map is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The paper's: obstacle alone.
    Paper,
    /// Obstacle and target together.
    Conjunctive,
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Paper => "paper",
            Self::Conjunctive => "conjunctive",
        })
    }
}

impl FromStr for Variant {
    type Err = AgentError;

    fn from_str(text: &str) -> Result<Self, AgentError> {
        match text {
            "paper" => Ok(Self::Paper),
            "conjunctive" => Ok(Self::Conjunctive),
            _ => Err(AgentError::Config {
                field: "variant",
                problem: format!("{text:?} is not one of paper, conjunctive"),
            }),
        }
    }
}

/// How the output map is read out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Readout {
    /// The mean over the whole map, Eq. 4: between two peaks it lies between them.
    Population,
    /// The mean over the neurons around the strongest one.
    Peak,
}

/// Numbers of the maps and the learning rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReachBrain {
    /// Which input map is used.
    pub variant: Variant,
    /// Neurons along each side of the output map; 21 \[P\].
    pub output_neurons: usize,
    /// Neurons along each side of the obstacle's map; 21 \[P\] (conjunctive: 11 \[C\]).
    pub obstacle_neurons: usize,
    /// Angles that the obstacle's map spans, to each side \[deg\]; 60 \[C\] (conjunctive: 30 \[C\]).
    pub obstacle_field_deg: f64,
    /// Neurons along each side of the target's map; 5 \[C\]. Conjunctive variant only.
    pub target_neurons: usize,
    /// Factor of the activities of the pairs, which sum to one without it; what exceeds 1 is cut to 1;
    /// 1 \[C\]. A larger one lets a synapse reach its bound within fewer movements. Conjunctive variant
    /// only.
    pub input_gain: f64,
    /// Width σ of the tuning curves in spacings of neurons (Eq. 3); 0.7 \[P, unit C\].
    pub sigma: f64,
    /// How the output map is read out; over all of it (Eq. 4) \[P\] (conjunctive: around its peak \[C\]).
    pub readout: Readout,
    /// Neurons to each side of the strongest that are read out; 2 \[C\]. Readout `peak` only.
    pub peak_radius: usize,
    /// The learning rule and its numbers; Eq. 7 with η = 1, `w_max` = 0.2, ξ = 0.2 \[P\].
    pub rule: Rule,
}

impl ReachBrain {
    /// The numbers of a variant.
    #[must_use]
    pub fn variant(variant: Variant) -> Self {
        let (obstacle_neurons, obstacle_field_deg, readout) = match variant {
            Variant::Paper => (21, 60.0, Readout::Population),
            Variant::Conjunctive => (11, 30.0, Readout::Peak),
        };
        Self {
            variant,
            output_neurons: 21,
            obstacle_neurons,
            obstacle_field_deg,
            target_neurons: 5,
            input_gain: 1.0,
            sigma: 0.7,
            readout,
            peak_radius: 2,
            rule: Rule::default(),
        }
    }
}

/// The input map of a variant.
#[derive(Debug, Clone)]
enum Input {
    Obstacle(PopulationMap),
    Conjunctive(ConjunctiveMap),
}

/// A network that learns which movement fits what is seen (Fig. 3).
#[derive(Debug, Clone)]
pub struct ReachNetwork {
    config: ReachBrain,
    input: Input,
    output: PopulationMap,
    association: Association,
}

impl Network for ReachNetwork {
    type Task = ReachTask;
    type Config = ReachBrain;

    const TASK: &'static str = "reach";
    const KEY: &'static str = "gym_babble.reach";
    const PREFIXES: &'static [&'static str] = &[""];

    fn variant(name: &str) -> Result<ReachBrain, AgentError> {
        Ok(ReachBrain::variant(name.parse()?))
    }

    fn new(config: ReachBrain) -> Result<Self, AgentError> {
        let (input, output) = maps(&config)?;
        let association = Association::new(input.len(), output.len())?;
        Ok(Self {
            config,
            input,
            output,
            association,
        })
    }

    fn config(&self) -> &ReachBrain {
        &self.config
    }

    fn rule(&self) -> &Rule {
        &self.config.rule
    }

    fn associations(&self) -> Vec<&Association> {
        vec![&self.association]
    }

    fn associations_mut(&mut self) -> Vec<&mut Association> {
        vec![&mut self.association]
    }

    fn encode(&self, experiences: &[Experience]) -> Result<Vec<Activities>, AgentError> {
        let eye: Vec<[f32; 2]> = experiences.iter().map(|e| e.eye).collect();
        let obstacle: Vec<[f32; 2]> = experiences.iter().map(|e| e.obstacle).collect();
        let b: Vec<f64> = experiences
            .iter()
            .flat_map(|e| e.b.map(f64::from))
            .collect();
        let mut a = vec![0.0; experiences.len() * self.output.len()];
        self.output.encode(&b, &mut a)?;
        let g = self.perceive(&eye, &obstacle)?;
        Ok(vec![Activities { g, a }])
    }

    /// (y, x) of the obstacle, or (y, x) of the target and (y, x) of the obstacle.
    fn input_shapes(&self) -> Vec<Vec<usize>> {
        let (target, obstacle) = (self.config.target_neurons, self.config.obstacle_neurons);
        vec![match self.input {
            Input::Obstacle(_) => vec![obstacle; 2],
            Input::Conjunctive(_) => vec![target, target, obstacle, obstacle],
        }]
    }

    fn axes(&self) -> Vec<[Vec<Axis>; 2]> {
        let field = self.config.obstacle_field_deg;
        let obstacle = ["obstacle up", "obstacle to the right"]
            .map(|name| Axis::new(name, "deg", [-field, field]));
        let target = match self.input {
            Input::Obstacle(_) => None,
            Input::Conjunctive(_) => {
                Some(Axis::shares(["tilt on the target", "pan on the target"]))
            }
        };
        let input = target.into_iter().flatten().chain(obstacle).collect();
        let output = ["b2", "b1"].map(|name| Axis::new(name, "", [0.0, 1.0]));
        vec![[input, output.to_vec()]]
    }

    fn perceive_maps(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError> {
        let (eye, obstacle) = percepts(observation(senses)?);
        Ok(vec![Percept {
            name: match self.input {
                Input::Obstacle(_) => "obstacle",
                Input::Conjunctive(_) => "target_obstacle",
            },
            activity: self.perceive(&[eye], &[obstacle])?,
        }])
    }

    fn recall_maps(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError> {
        let (eye, obstacle) = percepts(observation(senses)?);
        Ok(vec![Recall {
            name: "movement",
            activity: self.recall(eye, obstacle)?,
            side: self.config.output_neurons,
        }])
    }

    /// Parameters (b1, b2) of the movement.
    fn decide_from(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError> {
        let (eye, obstacle) = percepts(observation(senses)?);
        Ok(self.decide(eye, obstacle)?.to_vec())
    }

    fn policy(&self, task: Arc<ReachTask>) -> Result<Box<dyn Policy + '_>, AgentError> {
        Ok(Box::new(ReachPolicy::new(task, self)?))
    }
}

impl ReachNetwork {
    /// Activity of the input map for what is seen, Eq. 3.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for another number of obstacles than of eyes.
    pub fn perceive(
        &self,
        eye: &[[f32; 2]],
        obstacle: &[[f32; 2]],
    ) -> Result<Vec<f32>, AgentError> {
        let double = |pairs: &[[f32; 2]]| -> Vec<f64> {
            pairs
                .as_flattened()
                .iter()
                .copied()
                .map(f64::from)
                .collect()
        };
        let obstacle = double(obstacle);
        let mut g = vec![0.0; eye.len() * self.input.len()];
        match &self.input {
            Input::Obstacle(map) => map.encode(&obstacle, &mut g)?,
            Input::Conjunctive(map) => {
                map.encode(&obstacle, &double(eye), &mut g)?;
                self.amplify(&mut g);
            }
        }
        Ok(g)
    }

    fn amplify(&self, g: &mut [f32]) {
        let gain = self.config.input_gain as f32;
        if gain != 1.0 {
            for g_i in g {
                *g_i = (gain * *g_i).min(1.0);
            }
        }
    }

    /// Activity of the output map for what is seen.
    ///
    /// # Errors
    /// As [`Self::perceive`].
    pub fn recall(&self, eye: [f32; 2], obstacle: [f32; 2]) -> Result<Vec<f32>, AgentError> {
        let mut a = vec![0.0; self.output.len()];
        self.association
            .recall(&self.perceive(&[eye], &[obstacle])?, &mut a)?;
        Ok(a)
    }

    /// Parameters (b1, b2) of the movement that fits what is seen, by the brain's readout.
    ///
    /// # Errors
    /// As [`Self::recall`].
    pub fn decide(&self, eye: [f32; 2], obstacle: [f32; 2]) -> Result<[f64; 2], AgentError> {
        let a = self.recall(eye, obstacle)?;
        let mut b = [0.0; 2];
        match self.config.readout {
            Readout::Population => self.output.read_out(&a, &mut b)?,
            Readout::Peak => {
                self.output
                    .read_out_peak(&a, self.config.peak_radius, &mut b)?;
            }
        }
        Ok(b)
    }
}

impl ChooseMovement for &ReachNetwork {
    fn choose(&self, _task: &ReachTask, senses: &[f32; SENSES]) -> Result<[f64; 2], AgentError> {
        let (eye, obstacle) = percepts(senses);
        self.decide(eye, obstacle)
    }
}

/// Eye and obstacle of a flat observation.
fn percepts(senses: &[f32; SENSES]) -> ([f32; 2], [f32; 2]) {
    let pair = |at: usize| [senses[at], senses[at + 1]];
    (pair(at::EYE), pair(at::OBSTACLE))
}

impl Input {
    fn len(&self) -> usize {
        match self {
            Self::Obstacle(map) => map.len(),
            Self::Conjunctive(map) => map.len(),
        }
    }
}

fn maps(config: &ReachBrain) -> Result<(Input, PopulationMap), AgentError> {
    check(config)?;
    let map = |neurons: usize, low: f64, high: f64| {
        PopulationMap::new(&MapConfig::square(neurons, low, high, config.sigma))
    };
    let field = config.obstacle_field_deg.to_radians();
    let obstacle = map(config.obstacle_neurons, -field, field)?;
    let input = match config.variant {
        Variant::Paper => Input::Obstacle(obstacle),
        Variant::Conjunctive => Input::Conjunctive(ConjunctiveMap::new(
            obstacle,
            map(config.target_neurons, 0.0, 1.0)?,
        )),
    };
    Ok((input, map(config.output_neurons, 0.0, 1.0)?))
}

fn check(config: &ReachBrain) -> Result<(), AgentError> {
    let sides = [
        ("output_neurons", config.output_neurons),
        ("obstacle_neurons", config.obstacle_neurons),
        ("target_neurons", config.target_neurons),
    ];
    for (field, side) in sides {
        if !(2..=101).contains(&side) {
            return Err(AgentError::Config {
                field,
                problem: format!("{side} is not in [2, 101]"),
            });
        }
    }
    let within = |field, value: f64, low: f64, high: f64| {
        if (low..=high).contains(&value) {
            return Ok(());
        }
        let problem = format!("{value} is not in [{low}, {high}]");
        Err(AgentError::Config { field, problem })
    };
    within("obstacle_field_deg", config.obstacle_field_deg, 1.0, 180.0)?;
    within("input_gain", config.input_gain, 0.001, 1000.0)?;
    Ok(config.rule.validate()?)
}
