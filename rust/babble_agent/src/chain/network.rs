//! What is seen recalls the posture before the grasp, the posture at contact, and the hand's.

use std::sync::Arc;

use babble_brain::{Association, PopulationMap};
use babble_env::tasks::grasp::{FOVEA_NEURONS, SENSES, at};
use babble_env::{Executor, GraspTask, Purpose, Stream, Task};

use super::acting::ChainPolicy;
use super::brain::ChainBrain;
use super::code::{Input, SIZE_BLOCKS, arm, arm_range, hand, size};
use super::plan::Targets;
use super::practice;
use super::route::{RouteChoice, Routes, State};
use super::targets::ChooseTargets;
use crate::error::AgentError;
use crate::grasp::{Experience, GraspBabbling};
use crate::learner::ROUND;
use crate::network::{Activities, Axis, Network, Percept, Recall};
use crate::policy::{Policy, observation};
use crate::rule::Rule;

/// Associations that learn from babbles.
const BABBLED: usize = 3;

/// What the sight of an object recalls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recalled {
    /// Shoulder and elbow before the grasp, as shares of their ranges.
    pub pregrasp: [f64; 2],
    /// Shoulder and elbow when the palm touches, likewise.
    pub contact: [f64; 2],
    /// Thumb and finger around the object, EP = 90° − flexion \[deg\].
    pub hand: [f64; 2],
}

/// A network that learns from chains of babbles, and by reward when to go around an object.
#[derive(Debug, Clone)]
pub struct ChainNetwork {
    config: ChainBrain,
    input: Input,
    arm: PopulationMap,
    hand: PopulationMap,
    /// Input to the posture before the grasp, at contact, and to the hand.
    recall: [Association; BABBLED],
    routes: Routes,
}

impl Network for ChainNetwork {
    type Task = GraspTask;
    type Config = ChainBrain;

    const TASK: &'static str = "grasp";
    const KEY: &'static str = "gym_babble.chain";
    const PREFIXES: &'static [&'static str] =
        &["pregrasp.", "contact.", "hand.", "route.", "tried."];

    fn variant(name: &str) -> Result<ChainBrain, AgentError> {
        if name == "chain" {
            return Ok(ChainBrain::default());
        }
        Err(AgentError::Config {
            field: "variant",
            problem: format!("{name:?} is not chain"),
        })
    }

    fn new(config: ChainBrain) -> Result<Self, AgentError> {
        config.validate()?;
        let (input, arm, hand) = (Input::new(&config)?, arm(&config)?, hand(&config)?);
        let to = |map: &PopulationMap| Association::new(input.neurons(), map.len());
        Ok(Self {
            recall: [to(&arm)?, to(&arm)?, to(&hand)?],
            routes: Routes::new()?,
            input,
            arm,
            hand,
            config,
        })
    }

    fn config(&self) -> &ChainBrain {
        &self.config
    }

    fn rule(&self) -> &Rule {
        &self.config.rule
    }

    fn babbling(&self, _asked: GraspBabbling) -> GraspBabbling {
        GraspBabbling::Chain(self.config.babble)
    }

    fn associations(&self) -> Vec<&Association> {
        let routes = [&self.routes.value, &self.routes.tried];
        self.recall.iter().chain(routes).collect()
    }

    fn associations_mut(&mut self) -> Vec<&mut Association> {
        let routes = [&mut self.routes.value, &mut self.routes.tried];
        self.recall.iter_mut().chain(routes).collect()
    }

    fn encode(&self, experiences: &[Experience]) -> Result<Vec<Activities>, AgentError> {
        let mut g = Vec::with_capacity(experiences.len() * self.input.neurons());
        for experience in experiences {
            babble_brain::error::check_activity("fovea", &*experience.fovea)?;
            g.extend(
                self.input
                    .encode(experience.eye, size(&*experience.fovea))?,
            );
        }
        let encode = |map: &PopulationMap,
                      pair: fn(&Experience) -> [f32; 2]|
         -> Result<Activities, AgentError> {
            let pairs = experiences.iter().flat_map(|one| pair(one).map(f64::from));
            let mut a = vec![0.0; experiences.len() * map.len()];
            map.encode(&pairs.collect::<Vec<_>>(), &mut a)?;
            Ok(Activities { g: g.clone(), a })
        };
        Ok(vec![
            encode(&self.arm, |e| e.pregrasp.unwrap_or(e.arm))?,
            encode(&self.arm, |e| e.arm)?,
            encode(&self.hand, |e| e.hand)?,
        ])
    }

    /// (size, tilt, pan) three times, or (tilt, pan); then the neurons of the routes' three maps, one after
    /// the other, twice.
    fn input_shapes(&self) -> Vec<Vec<usize>> {
        let eye = self.config.eye_neurons;
        let seen = match self.config.sizes {
            1 => vec![eye, eye],
            sizes => vec![sizes, eye, eye],
        };
        let routes = vec![self.routes.inputs()];
        vec![seen.clone(), seen.clone(), seen, routes.clone(), routes]
    }

    fn axes(&self) -> Vec<[Vec<Axis>; 2]> {
        let eye = Axis::shares(["tilt", "pan"]).to_vec();
        let size = Axis::new("size in the fovea", "blocks", SIZE_BLOCKS);
        let sizes = (self.config.sizes > 1).then_some(size);
        let input: Vec<Axis> = sizes.into_iter().chain(eye).collect();
        let range = arm_range(&self.config);
        let arm = ["elbow", "shoulder"].map(|name| Axis::new(name, "share of range", range));
        [arm, arm, Axis::hand()]
            .map(|output| [input.clone(), output.to_vec()])
            .into()
    }

    fn perceive_maps(&self, senses: &[f32]) -> Result<Vec<Percept>, AgentError> {
        let activity = self.see(senses)?;
        let names = ["pregrasp", "contact", "hand"];
        Ok(names
            .map(|name| Percept {
                name,
                activity: activity.clone(),
            })
            .into())
    }

    fn recall_maps(&self, senses: &[f32]) -> Result<Vec<Recall>, AgentError> {
        let g = self.see(senses)?;
        let names = ["pregrasp", "contact", "hand"];
        let mut all = Vec::new();
        for ((association, map), name) in self.recall.iter().zip(self.maps()).zip(names) {
            let mut activity = vec![0.0; map.len()];
            association.recall(&g, &mut activity)?;
            all.push(Recall {
                name,
                activity,
                side: self.config.neurons,
            });
        }
        Ok(all)
    }

    fn decide_from(&self, senses: &[f32]) -> Result<Vec<f64>, AgentError> {
        let Recalled {
            pregrasp,
            contact,
            hand,
        } = self.recalled(senses)?;
        Ok([pregrasp, contact, hand].concat())
    }

    fn policy(&self, task: Arc<GraspTask>) -> Result<Box<dyn Policy + '_>, AgentError> {
        Ok(Box::new(ChainPolicy::new(task, self)?))
    }

    fn set(
        &mut self,
        association: usize,
        weights: &[f32],
        a_mean: &[f32],
        g_mean: &[f32],
    ) -> Result<(), AgentError> {
        if association >= BABBLED {
            return self.routes.set(association - BABBLED, weights);
        }
        let rule = self.config.rule;
        rule.check_weights(weights)?;
        let mut changed = self.recall[association].clone();
        changed.set_weights(weights)?;
        rule.set_means(&mut changed, a_mean, g_mean)?;
        self.recall[association] = changed;
        Ok(())
    }

    fn practise(
        &mut self,
        task: &GraspTask,
        seed: u64,
        first: u64,
        executor: &mut Executor,
    ) -> Result<u64, AgentError> {
        let trials = practice::trials(self, task, seed, first, ROUND, executor)?;
        let rewards = trials.iter().map(|trial| (trial.choice, trial.reward()));
        self.routes.learn(&rewards.collect::<Vec<_>>())?;
        Ok(trials.iter().map(|trial| u64::from(trial.steps)).sum())
    }
}

impl ChainNetwork {
    /// When it goes around the object, and how.
    #[must_use]
    pub const fn routes(&self) -> &Routes {
        &self.routes
    }

    fn maps(&self) -> [&PopulationMap; BABBLED] {
        [&self.arm, &self.arm, &self.hand]
    }

    /// Activity of the input map for a flat observation.
    fn see(&self, senses: &[f32]) -> Result<Vec<f32>, AgentError> {
        // The senses that an option adds come last.
        let senses = observation::<SENSES>(&senses[..senses.len().min(SENSES)])?;
        let eye = [senses[at::EYE], senses[at::EYE + 1]];
        self.input
            .encode(eye, size(&senses[at::FOVEA..][..FOVEA_NEURONS]))
    }

    /// What a flat observation recalls, Eq. 4.
    ///
    /// # Errors
    /// [`AgentError`] for senses of another length.
    pub fn recalled(&self, senses: &[f32]) -> Result<Recalled, AgentError> {
        let g = self.see(senses)?;
        let mut pairs = [[0.0; 2]; BABBLED];
        for ((association, map), pair) in self.recall.iter().zip(self.maps()).zip(&mut pairs) {
            let mut a = vec![0.0; map.len()];
            association.recall(&g, &mut a)?;
            map.read_out(&a, pair)?;
        }
        let [pregrasp, contact, hand] = pairs;
        Ok(Recalled {
            pregrasp,
            contact,
            hand,
        })
    }

    /// Shoulder and elbow at contact, as shares of their ranges, with an object of a
    /// [`size`](super::code::size) where the eye looks: pan and tilt over their ranges.
    ///
    /// # Errors
    /// [`AgentError::Brain`] never, as any sight is encoded.
    pub fn contact(&self, eye: [f32; 2], size: f64) -> Result<[f64; 2], AgentError> {
        let g = self.input.encode(eye, size)?;
        let mut a = vec![0.0; self.arm.len()];
        self.recall[1].recall(&g, &mut a)?;
        let mut posture = [0.0; 2];
        self.arm.read_out(&a, &mut posture)?;
        Ok(posture)
    }
}

impl ChooseTargets for &ChainNetwork {
    /// What is recalled; the hand closes further by the squeeze, up to the reflex's flexion.
    fn targets(&self, task: &GraspTask, senses: &[f32; SENSES]) -> Result<Targets, AgentError> {
        let mut recalled = self.recalled(senses)?;
        if !self.config.targets {
            randomise(&mut recalled, senses);
        }
        let reflex = task.reflex();
        Ok(Targets {
            pregrasp: task.arm.denormalised(recalled.pregrasp),
            contact: task.arm.denormalised(recalled.contact),
            grip: 1.0 - recalled.hand[1] / 90.0,
            hand: [0, 1].map(|i| {
                let flexion = 90.0 - recalled.hand[i] + self.config.squeeze_deg;
                flexion.to_radians().min(reflex[i])
            }),
        })
    }

    /// The route that promises most.
    fn route(&self, state: &State) -> RouteChoice {
        self.routes.best(state)
    }

    fn senses_len(&self, task: &GraspTask) -> usize {
        // The goal comes after the senses.
        task.senses_len() + if task.options.goal { 2 } else { 0 }
    }

    fn at_goal(&self, task: &GraspTask, senses: &[f32]) -> Result<Option<[f64; 2]>, AgentError> {
        self.imagine(task, senses)
    }

    fn reflex(&self) -> bool {
        self.config.reflex
    }

    fn advance(&self) -> bool {
        self.config.advance
    }
}

/// Random postures of the arm in place of the recalled ones, the same for the same senses.
fn randomise(recalled: &mut Recalled, senses: &[f32]) {
    let seed = senses[..at::FOVEA].iter().fold(0, |seed: u64, x| {
        seed.rotate_left(16) ^ u64::from(x.to_bits())
    });
    let mut stream = Stream::new(Purpose::Policy, seed, 0);
    recalled.pregrasp = [0, 1].map(|_| stream.uniform(0.0, 1.0));
    recalled.contact = [0, 1].map(|_| stream.uniform(0.0, 1.0));
}
