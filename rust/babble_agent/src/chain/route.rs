//! Straight to the object, or around it: which way is worth most from where the arm is.

use babble_brain::{Association, MapConfig, PopulationMap};
use babble_env::Stream;

use crate::error::AgentError;

/// How far beyond the posture before the grasp the shoulder turns first, clockwise \[deg\].
const TURN_DEG: [f64; 5] = [15.0, 35.0, 55.0, 80.0, 110.0];
/// How far the elbow folds, as shares of its range.
const FOLD: [f64; 3] = [0.45, 0.7, 1.0];
/// How far it extends again, likewise.
const EXTEND: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// Neurons for the turn of the shoulder ahead, the elbow, and the elbow before the grasp.
const NEURONS: [usize; 3] = [21, 6, 6];
/// Width of the tuning curves in spacings of neurons.
const SIGMA: f64 = 0.7;
/// Trials that an untried route counts for, with no reward.
const DOUBT: f64 = 1.0;
/// Spread of the rewards of one route, which says how far a route that was tried n times may be better
/// than it seems: the spread / √n.
const SPREAD: f64 = 0.4;
/// Reward that an untried route is imagined to bring while practising.
const HOPE: f64 = 0.5;

/// A way around an object: fold the elbow, turn the shoulder, extend the elbow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detour {
    /// Elbow to fold to, as a share of its range.
    pub fold: f64,
    /// How far the shoulder turns beyond the posture before the grasp, clockwise \[deg\].
    pub turn_deg: f64,
    /// Elbow to extend to, as a share of its range.
    pub extend: f64,
}

/// A route and what it was chosen for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteChoice {
    /// Its number; 0 goes straight.
    pub number: usize,
    /// The turn of the shoulder ahead, the elbow, and the elbow before the grasp, as shares of their
    /// ranges.
    pub state: [f64; 3],
}

/// The values of the routes, learnt by reward.
#[derive(Debug, Clone)]
pub struct Routes {
    map: PopulationMap,
    /// Mean reward of each route at each input neuron.
    pub(super) value: Association,
    /// How often each was tried there.
    pub(super) tried: Association,
}

impl Routes {
    /// Nothing tried.
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as the numbers are constants.
    pub fn new() -> Result<Self, AgentError> {
        let map = PopulationMap::new(&MapConfig {
            neurons: NEURONS.into(),
            low: vec![-1.0, 0.0, 0.0],
            high: vec![1.0, 1.0, 1.0],
            sigma: SIGMA,
        })?;
        let connections = || Association::new(map.len(), Self::count());
        Ok(Self {
            value: connections()?,
            tried: connections()?,
            map,
        })
    }

    /// How many routes there are.
    #[must_use]
    pub const fn count() -> usize {
        1 + TURN_DEG.len() * FOLD.len() * EXTEND.len()
    }

    /// The route of a number; None goes straight.
    #[must_use]
    pub fn detour(number: usize) -> Option<Detour> {
        let rest = number.checked_sub(1)?;
        Some(Detour {
            turn_deg: TURN_DEG[rest % TURN_DEG.len()],
            fold: FOLD[rest / TURN_DEG.len() % FOLD.len()],
            extend: EXTEND[rest / (TURN_DEG.len() * FOLD.len()) % EXTEND.len()],
        })
    }

    /// Neurons along the axes of the input map, the last axis fastest.
    #[must_use]
    pub fn shape(&self) -> Vec<usize> {
        NEURONS.iter().rev().copied().collect()
    }

    /// Rewards that the routes have brought in states like this one, summed, and trials they count for.
    fn evidence(&self, state: [f64; 3]) -> Vec<[f64; 2]> {
        let g = self.encode(state);
        let square: f64 = g.iter().map(|&(_, g)| g * g).sum();
        let (value, tried) = (self.value.weights(), self.tried.weights());
        (0..Self::count())
            .map(|j| {
                let (mut reward, mut trials) = (0.0, 0.0);
                for &(i, g) in &g {
                    let at = j * self.map.len() + i;
                    let used = g * f64::from(tried[at]) / square;
                    trials += used;
                    reward += used * f64::from(value[at]);
                }
                [reward, trials]
            })
            .collect()
    }

    /// The active neurons.
    fn encode(&self, state: [f64; 3]) -> Vec<(usize, f64)> {
        let mut g = vec![0.0; self.map.len()];
        // The lengths fit.
        let encoded = self.map.encode(&state, &mut g);
        debug_assert!(encoded.is_ok());
        let active = g.iter().enumerate().filter(|&(_, &g)| g > 1e-3);
        active.map(|(i, &g)| (i, f64::from(g))).collect()
    }

    /// The route that promises most.
    #[must_use]
    pub fn best(&self, state: [f64; 3]) -> RouteChoice {
        let worth = |[reward, trials]: [f64; 2]| reward / (trials + DOUBT);
        let number = strongest(self.evidence(state).into_iter().map(worth));
        RouteChoice { number, state }
    }

    /// A route to try: the best of what each may be worth, sampled from what is known of it (Thompson
    /// 1933).
    #[must_use]
    pub fn sample(&self, state: [f64; 3], stream: &mut Stream) -> RouteChoice {
        let sampled = self.evidence(state).into_iter().map(|[reward, trials]| {
            let mean = (reward + HOPE * DOUBT) / (trials + DOUBT);
            mean + SPREAD * gaussian(stream) / libm::sqrt(trials + DOUBT)
        });
        let number = strongest(sampled);
        RouteChoice { number, state }
    }

    /// Learns from the reward R of a trial: Δw = η g a (R − w), where a is 1 for the route taken and 0
    /// for the others, and η = 1 / use of the synapse.
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as the weights stay finite.
    pub fn learn(&mut self, choice: &RouteChoice, reward: f64) -> Result<(), AgentError> {
        let (mut value, mut tried) = (self.value.weights().to_vec(), self.tried.weights().to_vec());
        for (i, g) in self.encode(choice.state) {
            let at = choice.number * self.map.len() + i;
            tried[at] += g as f32;
            value[at] += g as f32 / tried[at] * (reward as f32 - value[at]);
        }
        self.value.set_weights(&value)?;
        Ok(self.tried.set_weights(&tried)?)
    }

    /// Sets the values (0) or the trials (1).
    ///
    /// # Errors
    /// [`AgentError::Config`] for a value outside of \[0, 1\], or trials below zero.
    pub(super) fn set(&mut self, which: usize, weights: &[f32]) -> Result<(), AgentError> {
        let (name, most) = if which == 0 {
            ("route", 1.0)
        } else {
            ("tried", f32::MAX)
        };
        if let Some(w) = weights.iter().find(|w| !(0.0..=most).contains(*w)) {
            return Err(AgentError::Config {
                field: "weights",
                problem: format!("{name}: {w} is not in [0, {most}]"),
            });
        }
        let association = if which == 0 {
            &mut self.value
        } else {
            &mut self.tried
        };
        Ok(association.set_weights(weights)?)
    }
}

/// The first of the greatest.
fn strongest(values: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, value) in values.enumerate() {
        if value > best.1 {
            best = (i, value);
        }
    }
    best.0
}

/// A number of the standard normal distribution (Box & Muller 1958).
fn gaussian(stream: &mut Stream) -> f64 {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - stream.uniform(0.0, 1.0)));
    radius * libm::cos(stream.uniform(0.0, std::f64::consts::TAU))
}
