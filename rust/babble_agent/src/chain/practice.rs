//! Trials that teach by reward which route to take.

use std::sync::Arc;

use babble_env::tasks::grasp::{FACTS, GraspRequest, Region, SENSES};
use babble_env::{
    Control, Episode, Executor, GraspOptions, GraspTask, Purpose, Reward, Stop, Stream,
};

use super::acting::ChainPolicy;
use super::network::ChainNetwork;
use super::route::{RouteChoice, State};
use crate::error::AgentError;
use crate::policy::{Plan, Policy};

/// Control steps in which a reward loses 63 % of its worth: of two ways that hold, the shorter is
/// better.
const PATIENCE: f64 = 1_500.0;

/// A trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// The route taken, and where.
    pub choice: RouteChoice,
    /// Whether the hand held the object.
    pub held: bool,
    /// Control steps that it took.
    pub steps: u32,
}

impl Trial {
    /// Its reward R: 1 for a held object, less the longer it took.
    #[must_use]
    pub fn reward(&self) -> f64 {
        if self.held {
            libm::exp(-f64::from(self.steps) / PATIENCE)
        } else {
            0.0
        }
    }
}

/// Trials `first` to `first + n` of a seed, on random cases of region `full`; trial k depends on the
/// network, the seed and k.
///
/// # Errors
/// An error of the task or the executor.
pub fn trials(
    network: &ChainNetwork,
    task: &GraspTask,
    seed: u64,
    first: u64,
    n: usize,
    executor: &mut Executor,
) -> Result<Vec<Trial>, AgentError> {
    let options = GraspOptions {
        control: Control::DeltaPosture,
        reward: Reward::Sparse,
        region: Region::Full,
        max_episode_steps: Region::Full.max_episode_steps(),
        ..GraspOptions::default()
    };
    let task = Arc::new(GraspTask::new(task.config.clone(), options)?);
    let policy = ChainPolicy::new(task.clone(), network)?;
    executor.map(0..n, |i, stop| {
        let k = first + i as u64;
        let [cases, choices] = [2 * k, 2 * k + 1].map(|i| Stream::new(Purpose::Practice, seed, i));
        trial(network, &task, &policy, [cases, choices], stop)
    })
}

fn trial(
    network: &ChainNetwork,
    task: &GraspTask,
    policy: &ChainPolicy<&ChainNetwork>,
    [cases, mut choices]: [Stream; 2],
    stop: &Stop<'_>,
) -> Result<Trial, AgentError> {
    let mut episode = Episode::new(task, cases);
    episode.request(GraspRequest::default());
    let next = episode.draw(task, stop)?;
    episode.begin(task, next);
    let mut senses = vec![0.0; SENSES];
    episode.observe(task, &mut senses);
    let choose = |state: &State| network.routes().sample(state, &mut choices);
    let begun = policy.begin(&senses, choose)?;
    let (choice, mut plan) = (begun.choice, Plan::Chain(begun));
    let mut action = [0.0; 4];
    for steps in 1.. {
        stop.check()?;
        policy.act(&mut plan, &senses, &mut action)?;
        let step = episode.step(task, &action)?;
        if step.terminated || step.truncated {
            let held = FACTS.iter().position(|&fact| fact == "held");
            let facts = episode.info(task).facts;
            return Ok(Trial {
                choice,
                held: held.is_some_and(|i| facts[i]),
                steps,
            });
        }
        episode.observe(task, &mut senses);
    }
    unreachable!("an episode ends")
}
