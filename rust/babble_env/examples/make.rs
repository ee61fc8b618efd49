//! An environment in Rust alone: made by its id and options, and played with random actions.
//!
//! You learn to make any task of the registry, to step a batch, and to read how an episode ended.
//!
//! ```console
//! cargo run --release -p babble_env --example make -- BabbleGrasp-v0 '{"control": "posture"}'
//! ```

use babble_env::{Autoreset, Config, EnvError, Executor, Options, Purpose, Stream};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let id = arguments
        .next()
        .unwrap_or_else(|| "BabbleReach-v0".to_owned());
    let options: Options =
        serde_json::from_str(&arguments.next().unwrap_or_else(|| "{}".to_owned()))?;
    let (outcome, steps, total) = play(&id, &options)?;
    println!("{id}: {outcome} after {steps} steps, return {total:.3}");
    Ok(())
}

/// An episode's outcome, its control steps and its return.
pub(crate) fn play(id: &str, options: &Options) -> Result<(&'static str, u32, f64), EnvError> {
    let task = babble_env::make(id, Config::profile("paper")?, options)?;
    let actions = task.spec().action.labels.len();
    let mut env = task.batch(1, Autoreset::Disabled, Executor::new(1)?)?;
    env.seed(0, 7)?;
    env.reset(&[true])?;
    let mut stream = Stream::new(Purpose::Policy, 7, 0);
    let (mut steps, mut total) = (0, 0.0);
    loop {
        let action: Vec<f32> = (0..actions)
            .map(|_| stream.uniform(-1.0, 1.0) as f32)
            .collect();
        env.step(&action)?;
        steps += 1;
        let Some(record) = env.record(0) else {
            continue;
        };
        total += record.step.reward;
        if record.step.terminated || record.step.truncated {
            return Ok((record.info.outcome.name(), steps, total));
        }
    }
}
