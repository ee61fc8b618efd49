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

/// Neurons for the turn of the shoulder ahead, the elbow, and the elbow before the grasp: what decides
/// whether the arm gets there straight.
const STRAIGHT: [usize; 3] = [21, 6, 6];
/// Neurons for the turn of the shoulder ahead, and shoulder and elbow before the grasp: what decides which
/// detour leads there.
const AROUND: [usize; 3] = [7, 9, 6];
/// Neurons for the flexion of the fingers around the object.
const SIZES: usize = 7;
/// Width of the tuning curves in spacings of neurons.
const SIGMA: f64 = 0.7;
/// Trials that count for a detour in a state where it was not tried: what it brought elsewhere for objects
/// of this size.
const DOUBT: f64 = 3.0;
/// Spread of the rewards of one route, which says how far a route that was tried n times may be better
/// than it seems: the spread / √n.
const SPREAD: f64 = 0.4;
/// Reward that a route tried nowhere is imagined to bring, in one trial.
const HOPE: f64 = 0.5;
/// Share of practice in which the arm goes straight whatever it promises: its worth in a state is not that
/// elsewhere, so that it has to be tried everywhere.
const STRAIGHT_SHARE: f64 = 0.3;

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

/// What a route is chosen for: where the arm is, and where it has to go. All are shares of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// The turn of the shoulder ahead: the difference vector of Bullock & Grossberg (1988).
    pub turn: f64,
    /// The elbow as it is.
    pub elbow: f64,
    /// Shoulder and elbow before the grasp.
    pub pregrasp: [f64; 2],
    /// Recalled flexion of the fingers around the object.
    pub grip: f64,
}

/// A route and what it was chosen for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteChoice {
    /// Its number; 0 goes straight.
    pub number: usize,
    /// What it was chosen for.
    pub state: State,
}

impl RouteChoice {
    pub(super) fn new(number: usize, state: &State) -> Self {
        let state = *state;
        Self { number, state }
    }
}

/// The values of the routes, learnt by reward.
#[derive(Debug, Clone)]
pub struct Routes {
    straight: PopulationMap,
    around: PopulationMap,
    size: PopulationMap,
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
        let state = |neurons: [usize; 3]| {
            PopulationMap::new(&MapConfig {
                neurons: neurons.into(),
                low: vec![-1.0, 0.0, 0.0],
                high: vec![1.0, 1.0, 1.0],
                sigma: SIGMA,
            })
        };
        let (straight, around) = (state(STRAIGHT)?, state(AROUND)?);
        let size = PopulationMap::new(&MapConfig {
            neurons: vec![SIZES],
            low: vec![0.0],
            high: vec![1.0],
            sigma: SIGMA,
        })?;
        let connections =
            || Association::new(straight.len() + around.len() + size.len(), Self::count());
        Ok(Self {
            value: connections()?,
            tried: connections()?,
            straight,
            around,
            size,
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

    /// Input neurons of the three maps.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.straight.len() + self.around.len() + self.size.len()
    }

    /// Rewards that the routes have brought in states like this one, summed, and trials they count for.
    /// What they brought elsewhere for objects of this size counts for a few trials.
    fn evidence(&self, state: &State) -> Vec<[f64; 2]> {
        let [straight, around, size] = self.encode(state);
        (0..Self::count())
            .map(|route| {
                if route == 0 {
                    let [reward, trials] = self.brought(route, &straight);
                    return [reward + HOPE, trials + 1.0];
                }
                let [reward, trials] = self.brought(route, &size);
                let elsewhere = (reward + HOPE) / (trials + 1.0);
                let [reward, trials] = self.brought(route, &around);
                [reward + DOUBT * elsewhere, trials + DOUBT]
            })
            .collect()
    }

    /// Rewards of a route at active neurons, summed, and its trials there.
    fn brought(&self, route: usize, active: &[(usize, f64)]) -> [f64; 2] {
        let square: f64 = active.iter().map(|&(_, g)| g * g).sum();
        let (value, tried) = (self.value.weights(), self.tried.weights());
        let mut sum = [0.0; 2];
        for &(i, g) in active {
            let at = route * self.inputs() + i;
            let trials = g * f64::from(tried[at]) / square;
            sum[0] += trials * f64::from(value[at]);
            sum[1] += trials;
        }
        sum
    }

    /// The active neurons of the three maps.
    fn encode(&self, state: &State) -> [Vec<(usize, f64)>; 3] {
        let active = |map: &PopulationMap, x: &[f64], first: usize| {
            let mut g = vec![0.0; map.len()];
            // The lengths fit.
            let encoded = map.encode(x, &mut g);
            debug_assert!(encoded.is_ok());
            let active = g.iter().enumerate().filter(|&(_, &g)| g > 1e-3);
            active.map(|(i, &g)| (first + i, f64::from(g))).collect()
        };
        let State {
            turn,
            elbow,
            pregrasp: [shoulder, before],
            grip,
        } = *state;
        let (straight, around) = (self.straight.len(), self.around.len());
        [
            active(&self.straight, &[turn, elbow, before], 0),
            active(&self.around, &[turn, shoulder, before], straight),
            active(&self.size, &[grip], straight + around),
        ]
    }

    /// The route that promises most.
    #[must_use]
    pub fn best(&self, state: &State) -> RouteChoice {
        let worth = |[reward, trials]: [f64; 2]| reward / trials;
        let number = strongest(self.evidence(state).into_iter().map(worth));
        RouteChoice::new(number, state)
    }

    /// A route to try: the best of what each may be worth, sampled from what is known of it (Thompson
    /// 1933).
    #[must_use]
    pub fn sample(&self, state: &State, stream: &mut Stream) -> RouteChoice {
        if stream.uniform(0.0, 1.0) < STRAIGHT_SHARE {
            return RouteChoice::new(0, state);
        }
        let sampled = self.evidence(state).into_iter().map(|[reward, trials]| {
            reward / trials + SPREAD * gaussian(stream) / libm::sqrt(trials)
        });
        let number = strongest(sampled);
        RouteChoice::new(number, state)
    }

    /// Learns from the rewards R of trials: Δw = η g a (R − w), where a is 1 for the route taken and 0
    /// for the others, and η = 1 / use of the synapse.
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as the weights stay finite.
    pub fn learn(&mut self, trials: &[(RouteChoice, f64)]) -> Result<(), AgentError> {
        let (mut value, mut tried) = (self.value.weights().to_vec(), self.tried.weights().to_vec());
        for (choice, reward) in trials {
            for (i, g) in self.encode(&choice.state).concat() {
                let (at, g) = (choice.number * self.inputs() + i, g as f32);
                tried[at] += g;
                value[at] += g / tried[at] * (*reward as f32 - value[at]);
            }
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
