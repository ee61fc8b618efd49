//! Four maps: where the object is recalls the arm, what it is recalls the hand (Fig. 6).

use std::sync::Arc;

use babble_brain::{Association, MapConfig, PopulationMap};
use babble_env::GraspTask;
use babble_env::tasks::grasp::{FOVEA_NEURONS, SENSES, at};
use serde::{Deserialize, Serialize};

use super::babbling::Experience;
use super::policy::{ChooseGrasp, GraspPolicy, Sight};
use crate::error::AgentError;
use crate::network::{Activities, Axis, Network, Percept, Recall};
use crate::policy::{Grasp, Policy, observation};
use crate::rule::Rule;

/// Numbers of the maps and the learning rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraspBrain {
    /// Neurons along each side of the maps of eye, arm and hand; 21 \[P\]. That of the fovea has 21
    /// always.
    pub neurons: usize,
    /// Width σ of the tuning curves in spacings of neurons (Eq. 3); 0.7 \[P, unit C\].
    pub sigma: f64,
    /// The learning rule and its numbers; Eq. 7 with η = 1, `w_max` = 0.2, ξ = 0.2 \[P\].
    pub rule: Rule,
    /// How much further than recalled the hand closes on contact \[deg\], up to the reflex's flexion;
    /// 20 \[C\]. The recalled posture is that of a hand around the object: as equilibrium point it
    /// would press with no force.
    pub squeeze_deg: f64,
    /// Time between two applications of the rule while the arm moves in babbling \[s\]; 0.2 \[C\]. None
    /// for one, at the end of a babble. The shorter, the more the running averages follow the movement,
    /// and the narrower the surround of the weights.
    pub learning_period_s: Option<f64>,
}

impl Default for GraspBrain {
    fn default() -> Self {
        Self {
            neurons: 21,
            sigma: 0.7,
            rule: Rule::default(),
            squeeze_deg: 20.0,
            learning_period_s: Some(0.2),
        }
    }
}

/// What the sight of an object recalls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recalled {
    /// Shoulder and elbow, as shares of their ranges.
    pub arm: [f64; 2],
    /// Thumb and finger, EP = 90° − flexion \[deg\].
    pub hand: [f64; 2],
}

/// A network that learns where to reach and how to grasp.
#[derive(Debug, Clone)]
pub struct GraspNetwork {
    config: GraspBrain,
    eye: PopulationMap,
    arm: PopulationMap,
    hand: PopulationMap,
    /// Eye to arm.
    reach: Association,
    /// Fovea to hand.
    grasp: Association,
}

impl Network for GraspNetwork {
    type Task = GraspTask;
    type Config = GraspBrain;

    const TASK: &'static str = "grasp";
    const KEY: &'static str = "gym_babble.grasp";
    const PREFIXES: &'static [&'static str] = &["reach.", "grasp."];

    fn variant(name: &str) -> Result<GraspBrain, AgentError> {
        if name == "paper" {
            return Ok(GraspBrain::default());
        }
        Err(AgentError::Config {
            field: "variant",
            problem: format!("{name:?} is not one of paper, chain, in grasping"),
        })
    }

    fn new(config: GraspBrain) -> Result<Self, AgentError> {
        let (unit, hand) = maps(&config)?;
        Ok(Self {
            reach: Association::new(unit.len(), unit.len())?,
            grasp: Association::new(FOVEA_NEURONS, hand.len())?,
            eye: unit.clone(),
            arm: unit,
            hand,
            config,
        })
    }

    fn config(&self) -> &GraspBrain {
        &self.config
    }

    fn rule(&self) -> &Rule {
        &self.config.rule
    }

    fn learning_period_s(&self) -> Option<f64> {
        self.config.learning_period_s
    }

    fn associations(&self) -> Vec<&Association> {
        vec![&self.reach, &self.grasp]
    }

    fn associations_mut(&mut self) -> Vec<&mut Association> {
        vec![&mut self.reach, &mut self.grasp]
    }

    fn encode(&self, experiences: &[Experience]) -> Result<Vec<Activities>, AgentError> {
        let encode = |map: &PopulationMap, pair: fn(&Experience) -> [f32; 2]| {
            let x: Vec<f64> = experiences
                .iter()
                .flat_map(|experience| pair(experience).map(f64::from))
                .collect();
            let mut activity = vec![0.0; experiences.len() * map.len()];
            map.encode(&x, &mut activity).map(|()| activity)
        };
        let fovea: Vec<f32> = experiences
            .iter()
            .flat_map(|experience| experience.fovea.iter().copied())
            .collect();
        // The only activities that are not encoded here.
        babble_brain::error::check_activity("fovea", &fovea)?;
        Ok(vec![
            Activities {
                g: encode(&self.eye, |e| e.eye)?,
                a: encode(&self.arm, |e| e.arm)?,
            },
            Activities {
                g: fovea,
                a: encode(&self.hand, |e| e.hand)?,
            },
        ])
    }

    /// (tilt, pan) of the eye, and (y, x) of the fovea.
    fn input_shapes(&self) -> Vec<Vec<usize>> {
        let fovea = FOVEA_NEURONS.isqrt();
        vec![vec![self.config.neurons; 2], vec![fovea; 2]]
    }

    fn axes(&self) -> Vec<[Vec<Axis>; 2]> {
        let last = FOVEA_NEURONS.isqrt() as f64;
        let fovea = ["row from the top", "column from the left"]
            .map(|name| Axis::new(name, "", [1.0, last]));
        let eye = Axis::shares(["tilt", "pan"]).to_vec();
        let arm = Axis::shares(["elbow", "shoulder"]).to_vec();
        vec![[eye, arm], [fovea.to_vec(), Axis::hand().to_vec()]]
    }

    fn perceive_maps(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError> {
        let (eye, fovea) = Self::split(senses)?;
        let percept = |name, activity| Percept { name, activity };
        Ok(vec![
            percept("eye", self.perceive(eye)?),
            percept("fovea", fovea.to_vec()),
        ])
    }

    fn recall_maps(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError> {
        let (eye, fovea) = Self::split(senses)?;
        let side = self.config.neurons;
        let recall = |name, activity| Recall {
            name,
            activity,
            side,
        };
        Ok(vec![
            recall("arm", self.recall_arm(eye)?),
            recall("hand", self.recall_hand(fovea)?),
        ])
    }

    /// Shoulder and elbow as shares of their ranges, and equilibrium points of thumb and finger,
    /// EP = 90° − flexion \[deg\].
    fn decide_from(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError> {
        let (eye, fovea) = Self::split(senses)?;
        let Recalled { arm, hand } = self.decide(eye, fovea)?;
        Ok([arm, hand].concat())
    }

    fn policy(&self, task: Arc<GraspTask>) -> Result<Box<dyn Policy + '_>, AgentError> {
        Ok(Box::new(GraspPolicy::new(task, self)?))
    }
}

impl GraspNetwork {
    /// Eye and fovea of a flat observation.
    fn split(senses: &[f32]) -> Result<([f32; 2], &[f32]), AgentError> {
        // The senses that an option adds come last.
        let senses: &[f32; SENSES] = observation(&senses[..senses.len().min(SENSES)])?;
        let eye = [senses[at::EYE], senses[at::EYE + 1]];
        Ok((eye, &senses[at::FOVEA..at::HAND]))
    }

    /// How much further than recalled the hand closes on contact \[deg\].
    #[must_use]
    pub const fn squeeze_deg(&self) -> f64 {
        self.config.squeeze_deg
    }

    /// Weights from eye to arm.
    #[must_use]
    pub const fn reach(&self) -> &Association {
        &self.reach
    }

    /// Weights from fovea to hand.
    #[must_use]
    pub const fn grasp(&self) -> &Association {
        &self.grasp
    }

    /// Activity of the eye's map for where the object is (pan and tilt over their ranges), Eq. 3.
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as any eye posture is encoded.
    pub fn perceive(&self, eye: [f32; 2]) -> Result<Vec<f32>, AgentError> {
        let mut g = vec![0.0; self.eye.len()];
        self.eye.encode(&eye.map(f64::from), &mut g)?;
        Ok(g)
    }

    /// Activity of the arm's map for where the object is (pan and tilt over their ranges).
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as any eye posture is encoded.
    pub fn recall_arm(&self, eye: [f32; 2]) -> Result<Vec<f32>, AgentError> {
        let mut a = vec![0.0; self.arm.len()];
        self.reach.recall(&self.perceive(eye)?, &mut a)?;
        Ok(a)
    }

    /// Activity of the hand's map for what the object is.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are no activities.
    pub fn recall_hand(&self, fovea: &[f32]) -> Result<Vec<f32>, AgentError> {
        let mut a = vec![0.0; self.hand.len()];
        self.grasp.recall(fovea, &mut a)?;
        Ok(a)
    }

    /// Postures of arm and hand that fit what is seen, Eq. 4.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are no activities.
    pub fn decide(&self, eye: [f32; 2], fovea: &[f32]) -> Result<Recalled, AgentError> {
        let (mut arm, mut hand) = ([0.0; 2], [0.0; 2]);
        self.arm.read_out(&self.recall_arm(eye)?, &mut arm)?;
        self.hand.read_out(&self.recall_hand(fovea)?, &mut hand)?;
        Ok(Recalled { arm, hand })
    }
}

impl ChooseGrasp for &GraspNetwork {
    fn choose(&self, task: &GraspTask, sight: &Sight<'_>) -> Result<Grasp, AgentError> {
        let recalled = self.decide(sight.eye, sight.fovea)?;
        let (ranges, reflex) = (task.robot.ranges(), task.reflex());
        let arm = [0, 1].map(|i| {
            let [low, high] = ranges[i];
            low + recalled.arm[i] * (high - low)
        });
        // A hand around the object would press with no force at its own posture.
        let squeeze = self.squeeze_deg();
        let hand = [0, 1].map(|i| {
            (90.0 - recalled.hand[i] + squeeze)
                .to_radians()
                .min(reflex[i])
        });
        Ok(Grasp::straight(arm, hand))
    }
}

/// The map of two shares, which eye and arm have, and the map of the hand's equilibrium points.
fn maps(config: &GraspBrain) -> Result<(PopulationMap, PopulationMap), AgentError> {
    if !(2..=101).contains(&config.neurons) {
        return Err(AgentError::Config {
            field: "neurons",
            problem: format!("{} is not in [2, 101]", config.neurons),
        });
    }
    if !(0.0..=90.0).contains(&config.squeeze_deg) {
        return Err(AgentError::Config {
            field: "squeeze_deg",
            problem: format!("{} is not in [0, 90]", config.squeeze_deg),
        });
    }
    config.rule.validate()?;
    let map =
        |high| PopulationMap::new(&MapConfig::square(config.neurons, 0.0, high, config.sigma));
    Ok((map(1.0)?, map(90.0)?))
}
