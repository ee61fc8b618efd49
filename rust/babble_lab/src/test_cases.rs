//! Tests: the cases that results are reported on, played to their ends.

use std::sync::Arc;

use babble_env::{AnyTask, CaseValues, Executor, Purpose};

use crate::agent::Agent;
use crate::cost::Cost;
use crate::fault::Fault;
use crate::stage::one;
use crate::state::Outcomes;

/// Seed of the test cases, which is that of the published results.
const CASES_SEED: u64 = 0;

/// The first `n` test cases of a task.
pub(crate) fn cases(
    task: &Arc<dyn AnyTask>,
    protocol: &str,
    n: u64,
    executor: &mut Executor,
) -> Result<Vec<CaseValues>, Fault> {
    let cases = task.cases(protocol, n as usize, CASES_SEED, Purpose::Test, executor)?;
    Ok(cases.into_iter().flatten().take(n as usize).collect())
}

/// Plays cases with an agent, which does not change: how they ended.
pub(crate) fn play(
    agent: &Agent,
    seed: u64,
    task: &Arc<dyn AnyTask>,
    cases: &[CaseValues],
    cost: &mut Cost,
    executor: &mut Executor,
) -> Result<Outcomes, Fault> {
    let mut agent = agent.clone();
    let mut outcomes = Outcomes::new();
    let mut batch = one(task)?;
    for case in cases {
        batch.request(0, case)?;
        batch.reset(&[true])?;
        let mut plans = Vec::new();
        let mut steps = 0;
        let outcome = loop {
            executor.check()?;
            let Some(record) = batch.record(0) else {
                return Err(Fault::new("ConfigError", None, "nothing to see"));
            };
            if record.step.terminated || record.step.truncated {
                break record.info.outcome;
            }
            let plan = (&mut plans, steps == 0);
            let action = agent.act(seed, task, record, plan, executor)?;
            batch.step(&action)?;
            steps += 1;
        };
        cost.add_steps(&**task, steps);
        cost.check()?;
        *outcomes.entry(outcome.name().to_owned()).or_default() += 1;
    }
    Ok(outcomes)
}
