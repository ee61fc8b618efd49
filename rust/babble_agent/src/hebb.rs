//! Neural maps tied by the covariance rule: from what is seen to how to move.

use std::fmt;
use std::str::FromStr;

use babble_brain::covariance::{Association, CovarianceConfig};
use babble_brain::maps::{ConjunctiveMap, MapConfig, PopulationMap};
use serde::{Deserialize, Serialize};

use crate::babbling::Experience;
use crate::error::AgentError;

/// Which input map and readout are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The paper's: obstacle alone, read out over the whole output map.
    Paper,
    /// Obstacle and target together, read out around the strongest output neuron.
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

/// Numbers of the maps and the learning rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HebbConfig {
    /// Which input map and readout are used.
    pub variant: Variant,
    /// Neurons along each side of the output map; 21 \[P\].
    pub output_neurons: usize,
    /// Neurons along each side of the obstacle's map; 21 \[P\] (conjunctive: 11 \[C\]).
    pub obstacle_neurons: usize,
    /// Angles that the obstacle's map spans, to each side \[deg\]; 60 \[C\] (conjunctive: 30 \[C\]).
    pub obstacle_field_deg: f64,
    /// Neurons along each side of the target's map; 5 \[C\]. Conjunctive variant only.
    pub target_neurons: usize,
    /// Width σ of the tuning curves in spacings of neurons (Eq. 3); 0.7 \[P, unit C\].
    pub sigma: f64,
    /// Neurons to each side of the strongest that are read out; 2 \[C\]. Conjunctive variant only.
    pub peak_radius: usize,
    /// Learning rate η, limit `w_max` and decay ξ of Eq. 7; 1, 0.2, 0.2 \[P\].
    pub rule: CovarianceConfig,
}

impl HebbConfig {
    /// The numbers of a variant.
    #[must_use]
    pub fn variant(variant: Variant) -> Self {
        let (obstacle_neurons, obstacle_field_deg) = match variant {
            Variant::Paper => (21, 60.0),
            Variant::Conjunctive => (11, 30.0),
        };
        Self {
            variant,
            output_neurons: 21,
            obstacle_neurons,
            obstacle_field_deg,
            target_neurons: 5,
            sigma: 0.7,
            peak_radius: 2,
            rule: CovarianceConfig::default(),
        }
    }
}

/// The input map of a variant.
#[derive(Debug, Clone)]
enum Input {
    Obstacle(PopulationMap),
    Conjunctive(ConjunctiveMap),
}

/// A network that learns which movement fits what is seen.
#[derive(Debug, Clone)]
pub struct Hebb {
    config: HebbConfig,
    input: Input,
    output: PopulationMap,
    weights: Association,
}

impl Hebb {
    /// A network that has learnt nothing.
    ///
    /// # Errors
    /// [`AgentError`] naming the field that is out of bounds.
    pub fn new(config: HebbConfig) -> Result<Self, AgentError> {
        let (input, output) = maps(&config)?;
        let weights = Association::new(&config.rule, input.len(), output.len())?;
        Ok(Self {
            config,
            input,
            output,
            weights,
        })
    }

    /// A network with known weights, as stored.
    ///
    /// # Errors
    /// [`AgentError`] for weights that do not fit the maps or their limit.
    pub fn from_parts(
        config: HebbConfig,
        weights: Vec<f32>,
        a_bar: Vec<f32>,
        g_bar: Vec<f32>,
    ) -> Result<Self, AgentError> {
        let (input, output) = maps(&config)?;
        let fits = |what: &str, got: usize, expected: usize| {
            if got == expected {
                return Ok(());
            }
            Err(AgentError::File {
                problem: format!("{what} has {got} numbers, expected {expected}"),
            })
        };
        fits("weights", weights.len(), input.len() * output.len())?;
        fits("a_bar", a_bar.len(), output.len())?;
        fits("g_bar", g_bar.len(), input.len())?;
        let weights = Association::from_parts(&config.rule, weights, a_bar, g_bar)?;
        Ok(Self {
            config,
            input,
            output,
            weights,
        })
    }

    /// Its numbers.
    #[must_use]
    pub const fn config(&self) -> &HebbConfig {
        &self.config
    }

    /// The weights `w_ji` and the running averages.
    #[must_use]
    pub const fn weights(&self) -> &Association {
        &self.weights
    }

    /// Neurons along the axes of the input map: (y, x) of the obstacle, or (y, x) of the target and
    /// (y, x) of the obstacle.
    #[must_use]
    pub fn input_shape(&self) -> Vec<usize> {
        let (target, obstacle) = (self.config.target_neurons, self.config.obstacle_neurons);
        match self.input {
            Input::Obstacle(_) => vec![obstacle; 2],
            Input::Conjunctive(_) => vec![target, target, obstacle, obstacle],
        }
    }

    /// Learns from legal movements in their order, Eq. 7. Runs in the rayon pool it is called in.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for activities that are not finite.
    pub fn learn(&mut self, experiences: &[Experience]) -> Result<(), AgentError> {
        let (n_in, n_out) = (self.input.len(), self.output.len());
        let mut g = vec![0.0; experiences.len() * n_in];
        let mut a = vec![0.0; experiences.len() * n_out];
        for (i, experience) in experiences.iter().enumerate() {
            self.input.encode(
                experience.eye,
                experience.obstacle,
                &mut g[i * n_in..][..n_in],
            );
            self.output
                .encode(experience.b.map(f64::from), &mut a[i * n_out..][..n_out]);
        }
        Ok(self.weights.learn_batch(&g, &a)?)
    }

    /// Activity of the input map for what is seen, Eq. 3.
    #[must_use]
    pub fn perceive(&self, eye: [f32; 2], obstacle: [f32; 2]) -> Vec<f32> {
        let mut g = vec![0.0; self.input.len()];
        self.input.encode(eye, obstacle, &mut g);
        g
    }

    /// Activity of the output map for what is seen.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are not finite.
    pub fn recall(&self, eye: [f32; 2], obstacle: [f32; 2]) -> Result<Vec<f32>, AgentError> {
        let mut a = vec![0.0; self.output.len()];
        self.weights.recall(&self.perceive(eye, obstacle), &mut a)?;
        Ok(a)
    }

    /// Parameters (b1, b2) of the movement that fits what is seen, Eq. 4.
    ///
    /// # Errors
    /// As [`Self::recall`].
    pub fn decide(&self, eye: [f32; 2], obstacle: [f32; 2]) -> Result<[f64; 2], AgentError> {
        let a = self.recall(eye, obstacle)?;
        Ok(match self.config.variant {
            Variant::Paper => self.output.read_out(&a),
            Variant::Conjunctive => self.output.read_out_peak(&a, self.config.peak_radius),
        })
    }
}

impl Input {
    fn len(&self) -> usize {
        match self {
            Self::Obstacle(map) => map.len(),
            Self::Conjunctive(map) => map.len(),
        }
    }

    fn encode(&self, eye: [f32; 2], obstacle: [f32; 2], out: &mut [f32]) {
        let obstacle = obstacle.map(f64::from);
        match self {
            Self::Obstacle(map) => map.encode(obstacle, out),
            Self::Conjunctive(map) => map.encode(obstacle, eye.map(f64::from), out),
        }
    }
}

fn maps(config: &HebbConfig) -> Result<(Input, PopulationMap), AgentError> {
    check(config)?;
    let map = |neurons: usize, low: f64, high: f64| {
        PopulationMap::new(&MapConfig {
            neurons: [neurons; 2],
            low: [low; 2],
            high: [high; 2],
            sigma: config.sigma,
        })
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

fn check(config: &HebbConfig) -> Result<(), AgentError> {
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
    if !(1.0..=180.0).contains(&config.obstacle_field_deg) {
        let problem = format!("{} is not in [1, 180]", config.obstacle_field_deg);
        return Err(AgentError::Config {
            field: "obstacle_field_deg",
            problem,
        });
    }
    Ok(())
}
