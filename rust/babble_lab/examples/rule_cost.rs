//! What learning by an expression costs beside the rule that is built in: 20,000 legal movements of reaching.
//!
//! ```text
//! cargo run --release -p babble_lab --example rule_cost
//! ```

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use babble_agent::erased::{brain_of, learner};
use babble_agent::rule::OwnRule;
use babble_env::{AnyTask, Config, Executor, Options, make};
use babble_lab::expression::RuleExpression;
use serde_json::{Value, json};

const MOVEMENTS: usize = 20_000;
const RULES: [&str; 3] = [
    "eta * (a - a_mean) * (g - g_mean) * (w_max - abs(w))",
    "eta * a * (g - a * w)",
    "eta * (a - a_mean) * (g - g_mean) * (w_max^2 - w^2) - 0.001 * w",
];

fn main() -> Result<(), Box<dyn Error>> {
    let task = make(
        "BabbleReachPattern-v0",
        Config::profile("paper")?,
        &Options::default(),
    )?;
    for variant in ["paper", "conjunctive"] {
        let (built_in, sum) = learnt(&task, variant, None)?;
        println!("{variant}, built in: {built_in:.2} s, sum of |w| {sum}");
        for rule in RULES {
            let (seconds, sum) = learnt(&task, variant, Some(rule))?;
            println!(
                "{variant}, {rule}: {seconds:.2} s, {:.2} times, sum of |w| {sum}",
                seconds / built_in
            );
        }
    }
    Ok(())
}

/// Seconds that learning took, and the sum of the absolute weights, by a rule or the variant's own.
fn learnt(
    task: &Arc<dyn AnyTask>,
    variant: &str,
    rule: Option<&str>,
) -> Result<(f64, f64), Box<dyn Error>> {
    let numbers = OwnRule::default();
    let mut brain = brain_of("reach", variant)?;
    let executor = &mut Executor::new(1)?;
    let started = Instant::now();
    let learner = if let Some(rule) = rule {
        brain["rule"] =
            json!({"name": "own", "eta": numbers.eta, "w_max": numbers.w_max, "xi": numbers.xi});
        let rule: RuleExpression = rule.parse()?;
        let mut learner = learner(task, brain, 0, Value::Null)?;
        let mut by =
            |association: &mut _, g: &[f32], a: &[f32]| rule.learn(numbers, association, g, a);
        learner.learn_by(&mut by, task, MOVEMENTS, executor)?;
        learner
    } else {
        let mut learner = learner(task, brain, 0, Value::Null)?;
        learner.learn(task, MOVEMENTS, executor)?;
        learner
    };
    let seconds = started.elapsed().as_secs_f64();
    let weights = learner.associations()[0].1.weights();
    Ok((seconds, weights.iter().map(|&w| f64::from(w).abs()).sum()))
}
