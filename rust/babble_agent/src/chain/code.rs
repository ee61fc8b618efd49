//! The chain's maps: what is seen, and where arm and hand are.

use babble_brain::{ConjunctiveMap, MapConfig, PopulationMap};
use babble_env::tasks::grasp::FOVEA_NEURONS;

use super::brain::ChainBrain;
use crate::error::AgentError;

/// Mean distances of the fovea's edges from its middle that the first and the last unit of size prefer,
/// in blocks of the image.
pub(super) const SIZE_BLOCKS: [f64; 2] = [1.5, 7.5];
/// Neurons of the arm's maps beyond each joint limit.
const MARGIN: f64 = 2.0;

/// Mean distance of the fovea's edges from its middle, weighted with their activity, in blocks; 0 without
/// edges. It grows with the object.
#[must_use]
pub fn size(fovea: &[f32]) -> f64 {
    let side = FOVEA_NEURONS.isqrt();
    let middle = (side - 1) as f64 / 2.0;
    let (mut sum, mut moment) = (0.0, 0.0);
    for (i, &edge) in fovea.iter().enumerate() {
        let distance = libm::hypot((i % side) as f64 - middle, (i / side) as f64 - middle);
        sum += f64::from(edge);
        moment += f64::from(edge) * distance;
    }
    if sum > 0.0 { moment / sum } else { 0.0 }
}

/// The input map, whose activity sums to one.
#[derive(Debug, Clone)]
pub enum Input {
    /// Where the object is.
    Eye(PopulationMap),
    /// Where it is, paired with its size.
    EyeAndSize(ConjunctiveMap),
}

impl Input {
    /// The map of a brain.
    ///
    /// # Errors
    /// [`AgentError::Brain`] names the number out of bounds.
    pub fn new(brain: &ChainBrain) -> Result<Self, AgentError> {
        let config = MapConfig::square(brain.eye_neurons, 0.0, 1.0, brain.sigma);
        let eye = PopulationMap::new(&config)?;
        if brain.sizes == 1 {
            return Ok(Self::Eye(eye));
        }
        let [low, high] = SIZE_BLOCKS;
        let size = PopulationMap::new(&MapConfig {
            neurons: vec![brain.sizes],
            low: vec![low],
            high: vec![high],
            sigma: brain.sigma,
        })?;
        Ok(Self::EyeAndSize(ConjunctiveMap::new(eye, size)))
    }

    /// Number of neurons.
    #[must_use]
    pub fn neurons(&self) -> usize {
        match self {
            Self::Eye(eye) => eye.len(),
            Self::EyeAndSize(pairs) => pairs.len(),
        }
    }

    /// Activity for what is seen: pan and tilt over their ranges, and the [`size`].
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as any sight is encoded.
    pub fn encode(&self, eye: [f32; 2], size: f64) -> Result<Vec<f32>, AgentError> {
        let mut g = vec![0.0; self.neurons()];
        let eye = eye.map(f64::from);
        match self {
            Self::Eye(map) => {
                map.encode(&eye, &mut g)?;
                let sum: f32 = g.iter().sum();
                if sum > 0.0 {
                    for g in &mut g {
                        *g /= sum;
                    }
                }
            }
            Self::EyeAndSize(pairs) => pairs.encode(&eye, &[size], &mut g)?,
        }
        Ok(g)
    }
}

/// What the first and the last neuron of the arm's maps prefer, as shares of the joint ranges.
pub(super) fn arm_range(brain: &ChainBrain) -> [f64; 2] {
    let margin = MARGIN / ((brain.neurons - 1) as f64 - 2.0 * MARGIN);
    [-margin, 1.0 + margin]
}

/// The map of the arm's postures, as shares of the joint ranges.
///
/// # Errors
/// [`AgentError::Brain`] names the number out of bounds.
pub fn arm(brain: &ChainBrain) -> Result<PopulationMap, AgentError> {
    let [low, high] = arm_range(brain);
    let mut config = MapConfig::square(brain.neurons, low, high, brain.sigma);
    config.sigma = brain.sigma;
    Ok(PopulationMap::new(&config)?)
}

/// The map of the hand's equilibrium points, EP = 90° − flexion.
///
/// # Errors
/// [`AgentError::Brain`] names the number out of bounds.
pub fn hand(brain: &ChainBrain) -> Result<PopulationMap, AgentError> {
    let config = MapConfig::square(brain.neurons, 0.0, 90.0, brain.sigma);
    Ok(PopulationMap::new(&config)?)
}
