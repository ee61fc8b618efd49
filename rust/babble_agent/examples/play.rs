//! Every agent in both tasks, in Rust alone: `cargo run --release --example play`.
//!
//! You learn to make environments and agents by name, to let the Hebb agent babble, and to play.

use std::sync::Arc;

use babble_agent::erased::{brain_of, learner};
use babble_agent::{AgentError, Policy, REFERENCES, Random, predict, reference};
use babble_env::{AnyTask, Autoreset, Config, EnvError, Executor, Options, Outcome, make};
use serde_json::Value;

pub(crate) const EPISODES: usize = 20;
/// The environments, and how many babbles the Hebb agent learns from.
const TASKS: [(&str, &str, usize); 2] = [
    ("reach", "BabbleReachPattern-v0", 1_000),
    ("grasp", "BabbleGrasp-v0", 50),
];

pub(crate) fn main() -> Result<(), AgentError> {
    let executor = &mut Executor::new(2)?;
    for (name, id, babbles) in TASKS {
        let task = make(id, Config::profile("paper")?, &Options::default())?;
        let mut hebb = learner(&task, brain_of(name, "paper")?, 0, Value::Null)?;
        hebb.learn(&task, babbles, executor)?;
        println!(
            "{id}: hebb learnt from {} of {} babbles",
            hebb.learnt(),
            hebb.babbled()
        );
        let random = Random::new(0, 0);
        for agent in REFERENCES {
            let policy = reference(agent, &task, &random)?;
            println!(
                "  {agent}: {} of {EPISODES} succeed",
                play(&task, &*policy, executor)?
            );
        }
        let policy = hebb.policy(&task)?;
        println!(
            "  hebb: {} of {EPISODES} succeed",
            play(&task, &*policy, executor)?
        );
    }
    Ok(())
}

/// How many episodes of an agent succeed, one in each environment of a batch.
pub(crate) fn play(
    task: &Arc<dyn AnyTask>,
    policy: &dyn Policy,
    executor: &mut Executor,
) -> Result<usize, AgentError> {
    let mut envs = Arc::clone(task).batch(EPISODES, Autoreset::NextStep, Executor::new(2)?)?;
    envs.reset(&[true; EPISODES])?;
    let (mut plans, mut starts) = (Vec::new(), [true; EPISODES]);
    let mut outcomes = [None; EPISODES];
    while outcomes.contains(&None) {
        let shown = (0..EPISODES).map(|env| envs.record(env).map(|record| &record.senses[..]));
        let senses: Vec<f32> = shown.flatten().flatten().copied().collect();
        let actions = predict(policy, &senses, &starts, &mut plans, executor)?;
        envs.step(&actions)?;
        for env in 0..EPISODES {
            let Some(record) = envs.record(env) else {
                return Err(EnvError::NeedsReset { env }.into());
            };
            starts[env] = record.step.terminated || record.step.truncated;
            if starts[env] {
                outcomes[env].get_or_insert(record.info.outcome);
            }
        }
    }
    Ok(outcomes
        .iter()
        .filter(|&&outcome| outcome == Some(Outcome::Success))
        .count())
}
