//! Four maps: where the object is recalls the arm, what it is recalls the hand (Fig. 6).

use babble_brain::covariance::{Association, CovarianceConfig};
use babble_brain::maps::{MapConfig, PopulationMap};
use babble_env::tasks::grasp::FOVEA_NEURONS;
use serde::{Deserialize, Serialize};

use super::babbling::Experience;
use crate::error::AgentError;

/// Numbers of the maps and the learning rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraspHebbConfig {
    /// Neurons along each side of the maps of eye, arm and hand; 21 \[P\]. That of the fovea has 21
    /// always.
    pub neurons: usize,
    /// Width σ of the tuning curves in spacings of neurons (Eq. 3); 0.7 \[P, unit C\].
    pub sigma: f64,
    /// Learning rate η, limit `w_max` and decay ξ of Eq. 7; 1, 0.2, 0.2 \[P\].
    pub rule: CovarianceConfig,
    /// How much further than recalled the hand closes on contact \[deg\], up to the reflex's flexion;
    /// 20 \[C\]. The recalled posture is that of a hand around the object: as equilibrium point it
    /// would press with no force.
    pub squeeze_deg: f64,
}

impl Default for GraspHebbConfig {
    fn default() -> Self {
        Self {
            neurons: 21,
            sigma: 0.7,
            rule: CovarianceConfig::default(),
            squeeze_deg: 20.0,
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
pub struct GraspHebb {
    config: GraspHebbConfig,
    eye: PopulationMap,
    arm: PopulationMap,
    hand: PopulationMap,
    /// Eye to arm.
    reach: Association,
    /// Fovea to hand.
    grasp: Association,
}

impl GraspHebb {
    /// A network that has learnt nothing.
    ///
    /// # Errors
    /// [`AgentError`] naming the field that is out of bounds.
    pub fn new(config: GraspHebbConfig) -> Result<Self, AgentError> {
        let (unit, hand) = maps(&config)?;
        let reach = Association::new(&config.rule, unit.len(), unit.len())?;
        let grasp = Association::new(&config.rule, FOVEA_NEURONS, hand.len())?;
        Self::with(config, reach, grasp)
    }

    /// A network with known weights, as stored: weights, averages of output and of input, of eye to
    /// arm and of fovea to hand.
    ///
    /// # Errors
    /// [`AgentError`] for weights that do not fit the maps or their limit.
    pub fn from_parts(
        config: GraspHebbConfig,
        reach: [Vec<f32>; 3],
        grasp: [Vec<f32>; 3],
    ) -> Result<Self, AgentError> {
        let (unit, hand) = maps(&config)?;
        let reach = association(&config, "reach", reach, [unit.len(), unit.len()])?;
        let grasp = association(&config, "grasp", grasp, [FOVEA_NEURONS, hand.len()])?;
        Self::with(config, reach, grasp)
    }

    fn with(
        config: GraspHebbConfig,
        reach: Association,
        grasp: Association,
    ) -> Result<Self, AgentError> {
        let (unit, hand) = maps(&config)?;
        Ok(Self {
            eye: unit.clone(),
            arm: unit,
            hand,
            reach,
            grasp,
            config,
        })
    }

    /// Its numbers.
    #[must_use]
    pub const fn config(&self) -> &GraspHebbConfig {
        &self.config
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

    /// Learns from babbles in their order, Eq. 7. Runs in the rayon pool it is called in.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for activities that are not finite.
    pub fn learn(&mut self, experiences: &[Experience]) -> Result<(), AgentError> {
        let encode = |map: &PopulationMap, values: &dyn Fn(&Experience) -> [f32; 2]| {
            let mut activity = vec![0.0; experiences.len() * map.len()];
            for (experience, out) in experiences.iter().zip(activity.chunks_mut(map.len())) {
                map.encode(values(experience).map(f64::from), out);
            }
            activity
        };
        let eye = encode(&self.eye, &|experience| experience.eye);
        let arm = encode(&self.arm, &|experience| experience.arm);
        let hand = encode(&self.hand, &|experience| experience.hand);
        let fovea: Vec<f32> = experiences
            .iter()
            .flat_map(|experience| experience.fovea.iter().copied())
            .collect();
        self.reach.learn_batch(&eye, &arm)?;
        Ok(self.grasp.learn_batch(&fovea, &hand)?)
    }

    /// Activity of the arm's map for where the object is (pan and tilt over their ranges).
    ///
    /// # Errors
    /// [`AgentError::Brain`] for percepts that are not finite.
    pub fn recall_arm(&self, eye: [f32; 2]) -> Result<Vec<f32>, AgentError> {
        let mut g = vec![0.0; self.eye.len()];
        self.eye.encode(eye.map(f64::from), &mut g);
        let mut a = vec![0.0; self.arm.len()];
        self.reach.recall(&g, &mut a)?;
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
        Ok(Recalled {
            arm: self.arm.read_out(&self.recall_arm(eye)?),
            hand: self.hand.read_out(&self.recall_hand(fovea)?),
        })
    }
}

/// The map of two shares, which eye and arm have, and the map of the hand's equilibrium points.
fn maps(config: &GraspHebbConfig) -> Result<(PopulationMap, PopulationMap), AgentError> {
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
    let map = |high: f64| {
        PopulationMap::new(&MapConfig {
            neurons: [config.neurons; 2],
            low: [0.0; 2],
            high: [high; 2],
            sigma: config.sigma,
        })
    };
    Ok((map(1.0)?, map(90.0)?))
}

fn association(
    config: &GraspHebbConfig,
    name: &str,
    [weights, a_bar, g_bar]: [Vec<f32>; 3],
    [n_in, n_out]: [usize; 2],
) -> Result<Association, AgentError> {
    for (what, got, expected) in [
        ("weights", weights.len(), n_in * n_out),
        ("a_bar", a_bar.len(), n_out),
        ("g_bar", g_bar.len(), n_in),
    ] {
        if got != expected {
            return Err(AgentError::File {
                problem: format!("{name}.{what} has {got} numbers, expected {expected}"),
            });
        }
    }
    Ok(Association::from_parts(
        &config.rule,
        weights,
        a_bar,
        g_bar,
    )?)
}
