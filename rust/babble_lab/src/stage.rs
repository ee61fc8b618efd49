//! The stage: an episode of the same case for each agent, seen step by step.

use std::sync::Arc;

use babble_agent::Plan;
use babble_env::batch::Record;
use babble_env::{AnyBatch, AnyTask, Autoreset, CaseValues, Executor, Outcome, seeding};

use crate::agent::Agent;
use crate::command::Case;
use crate::cost::Cost;
use crate::fault::Fault;
use crate::hash::Hash;
use crate::palm;
use crate::state::EpisodeState;

/// The stage.
#[derive(Debug)]
pub(crate) struct Stage {
    task: Arc<dyn AnyTask>,
    /// Draws the cases of the seed, one after the other.
    drawer: Box<dyn AnyBatch>,
    /// The first case of the seed, to be seen until an episode begins; none if it cannot be drawn.
    first: Option<Box<dyn AnyBatch>>,
    players: Vec<Player>,
    case: Option<Case>,
    seed: u64,
}

/// An agent's episode.
#[derive(Debug)]
struct Player {
    batch: Box<dyn AnyBatch>,
    progress: Progress,
}

/// How far an agent has come.
#[derive(Debug, Clone, Default)]
struct Progress {
    plans: Vec<Plan>,
    running: bool,
    steps: u64,
    reward: f64,
}

/// A stage that can be gone back to.
#[derive(Debug, Clone)]
pub(crate) struct StageSnapshot {
    task: Arc<dyn AnyTask>,
    drawer: Vec<u8>,
    players: Vec<(Vec<u8>, Progress)>,
    case: Option<Case>,
    seed: u64,
}

impl Stage {
    /// A stage on which nothing has begun.
    pub(crate) fn new(task: &Arc<dyn AnyTask>, agents: usize, seed: u64) -> Result<Self, Fault> {
        let player = |_| -> Result<Player, Fault> {
            Ok(Player {
                batch: one(task)?,
                progress: Progress::default(),
            })
        };
        Ok(Self {
            task: Arc::clone(task),
            drawer: seeded(task, seed)?,
            first: first(task, seed).ok(),
            players: (0..agents).map(player).collect::<Result<_, _>>()?,
            case: None,
            seed,
        })
    }

    /// What there is to see of an agent: its episode, or the first case of the seed before any began.
    pub(crate) fn seen(&self, agent: usize) -> &dyn AnyBatch {
        match &self.first {
            Some(first) if self.case.is_none() => &**first,
            _ => &*self.players[agent].batch,
        }
    }

    /// What the environment of an agent shows.
    pub(crate) fn record(&self, agent: usize) -> Result<&Record, Fault> {
        let nothing = || Fault::new("ConfigError", None, "an environment shows nothing");
        self.seen(agent).record(0).ok_or_else(nothing)
    }

    /// The task that is played.
    pub(crate) const fn task(&self) -> &Arc<dyn AnyTask> {
        &self.task
    }

    /// Begins an episode of the same case for each agent; none for the next case of the seed.
    pub(crate) fn begin(&mut self, case: Option<&Case>) -> Result<Case, Fault> {
        let mut asked;
        let drawn = match case {
            None => &mut self.drawer,
            Some(case) => {
                let values = case
                    .iter()
                    .map(|(name, value)| (name.as_str(), value.clone()));
                let values = CaseValues::read(self.task.case_parts(), values)?;
                asked = seeded(&self.task, self.seed)?;
                asked.request(0, &values)?;
                &mut asked
            }
        };
        drawn.reset(&[true])?;
        let bytes = drawn.save(0)?;
        let values = drawn.case(0)?;
        for player in &mut self.players {
            player.batch.load(0, &bytes)?;
            player.progress = Progress {
                running: true,
                ..Progress::default()
            };
        }
        let named = |(name, value): (&'static str, &_)| {
            (name.to_owned(), babble_env::CaseValue::clone(value))
        };
        let case: Case = values.iter().map(named).collect();
        self.case = Some(case.clone());
        Ok(case)
    }

    /// The case of the episode.
    pub(crate) const fn case(&self) -> Option<&Case> {
        self.case.as_ref()
    }

    /// As [`EpisodeState::palm`].
    pub(crate) fn palm(&self) -> Option<f64> {
        let values = self.players.first()?.batch.case(0).ok()?;
        palm::place(&self.task, &values)
    }

    /// At most `n` control steps of the running episodes; how those that ended in them ended.
    pub(crate) fn step(
        &mut self,
        agents: &mut [Agent],
        n: u64,
        cost: &mut Cost,
        executor: &mut Executor,
    ) -> Result<Vec<Option<String>>, Fault> {
        if !self.players.iter().any(|player| player.progress.running) {
            let problem = "no episode runs: begin one with `recall`";
            return Err(Fault::new("ResetNeeded", None, problem));
        }
        let mut ended = vec![None; agents.len()];
        for (i, (player, agent)) in self.players.iter_mut().zip(agents).enumerate() {
            let before = player.progress.steps;
            while player.progress.running && player.progress.steps < before + n {
                executor.check()?;
                player.step(agent, self.seed, &self.task, executor)?;
            }
            let steps = player.progress.steps;
            cost.add_steps(&*self.task, steps - before);
            cost.check()?;
            if steps > before && !player.progress.running {
                let outcome = player.outcome().name().to_owned();
                *agent.recalls.entry(outcome.clone()).or_default() += 1;
                ended[i] = Some(outcome);
            }
        }
        Ok(ended)
    }

    /// The episode; none before the first one. A control step lasts `period` seconds.
    pub(crate) fn state(&self, period: f64) -> Option<EpisodeState> {
        let steps = self.players.iter().map(|player| player.progress.steps);
        let step = steps.max().unwrap_or(0);
        let each = || self.players.iter();
        Some(EpisodeState {
            case: self.case.clone()?,
            palm: self.palm(),
            step,
            seconds: step as f64 * period,
            running: each().map(|player| player.progress.running).collect(),
            outcome: each()
                .map(|player| player.outcome().name().to_owned())
                .collect(),
            reward: each().map(|player| player.progress.reward).collect(),
        })
    }

    /// Adds the states of all episodes to a hash.
    pub(crate) fn hash(&self, hash: &mut Hash) -> Result<(), Fault> {
        hash.add(&self.drawer.state_hash(0)?.to_le_bytes());
        for player in &self.players {
            hash.add(&player.batch.state_hash(0)?.to_le_bytes());
            hash.add(&player.progress.reward.to_le_bytes());
        }
        Ok(())
    }

    /// The stage as it is.
    pub(crate) fn snapshot(&self) -> Result<StageSnapshot, Fault> {
        let each = self.players.iter();
        let player = |player: &Player| Ok((player.batch.save(0)?, player.progress.clone()));
        Ok(StageSnapshot {
            task: Arc::clone(&self.task),
            drawer: self.drawer.save(0)?,
            players: each.map(player).collect::<Result<_, Fault>>()?,
            case: self.case.clone(),
            seed: self.seed,
        })
    }

    /// The stage as it was.
    pub(crate) fn restored(from: &StageSnapshot) -> Result<Self, Fault> {
        let mut stage = Self::new(&from.task, from.players.len(), from.seed)?;
        stage.drawer.load(0, &from.drawer)?;
        for (player, (bytes, progress)) in stage.players.iter_mut().zip(&from.players) {
            player.batch.load(0, bytes)?;
            player.progress = progress.clone();
        }
        stage.case.clone_from(&from.case);
        Ok(stage)
    }
}

impl Player {
    fn outcome(&self) -> Outcome {
        let record = self.batch.record(0);
        record.map_or(Outcome::Running, |record| record.info.outcome)
    }

    fn step(
        &mut self,
        agent: &mut Agent,
        seed: u64,
        task: &Arc<dyn AnyTask>,
        executor: &mut Executor,
    ) -> Result<(), Fault> {
        let record = self.batch.record(0);
        let record = record.ok_or_else(|| Fault::new("ConfigError", None, "nothing to see"))?;
        let plan = (&mut self.progress.plans, self.progress.steps == 0);
        let action = agent.act(seed, task, record, plan, executor)?;
        self.batch.step(&action)?;
        self.progress.steps += 1;
        if let Some(record) = self.batch.record(0) {
            self.progress.reward += record.step.reward;
            self.progress.running = !(record.step.terminated || record.step.truncated);
        }
        Ok(())
    }
}

impl StageSnapshot {
    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        let players = self.players.iter().map(|(bytes, _)| bytes.len());
        self.drawer.len() + players.sum::<usize>()
    }
}

/// One environment that never begins anew by itself.
pub(crate) fn one(task: &Arc<dyn AnyTask>) -> Result<Box<dyn AnyBatch>, Fault> {
    Ok(Arc::clone(task).batch(1, Autoreset::Disabled, Executor::new(1)?)?)
}

/// The first case of a seed.
fn first(task: &Arc<dyn AnyTask>, seed: u64) -> Result<Box<dyn AnyBatch>, Fault> {
    let mut batch = seeded(task, seed)?;
    batch.reset(&[true])?;
    Ok(batch)
}

/// The same with the cases that `reset(seed=seed)` begins in Python.
fn seeded(task: &Arc<dyn AnyTask>, seed: u64) -> Result<Box<dyn AnyBatch>, Fault> {
    let mut batch = one(task)?;
    batch.seed(0, seeding::stream_seed(seed))?;
    Ok(batch)
}
