//! The one table of tasks and environments: their ids, options, cases and specs. Every face reads it.
//!
//! A task is added by one folder in `tasks` and one line in [`TASKS`].

use std::sync::Arc;

use serde::Serialize;
use serde_json::Value;

use crate::case::CasePart;
use crate::config::Config;
use crate::erased::AnyTask;
use crate::error::EnvError;
use crate::near;
use crate::option_spec::{OptionSpec, OptionValues, Options};
use crate::tasks;

/// All tasks.
pub const TASKS: &[&TaskEntry] = &[
    &tasks::reach::ENTRY,
    &tasks::grasp::ENTRY,
    #[cfg(feature = "toy")]
    &tasks::toy::ENTRY,
];

/// A task, and what its environments can be made with.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TaskEntry {
    /// Name of the task, as in its part of a config.
    pub name: &'static str,
    /// What its environments do, as in "reaching".
    pub title: &'static str,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// The registered environments of the task.
    pub environments: &'static [EnvironmentEntry],
    /// What a user may choose.
    pub options: &'static [OptionSpec],
    /// What a case consists of, and a user may ask of one.
    pub case_parts: &'static [CasePart],
    /// The test cases of the task, by name; the first are those that results are reported on.
    pub protocols: &'static [ProtocolEntry],
    /// Minimum environments per thread for threads to pay off.
    pub envs_per_thread: usize,
    /// Makes a task from a config and options.
    #[serde(skip)]
    pub make: MakeTask,
}

/// Makes a task from a config and checked options.
pub type MakeTask = fn(Config, &OptionValues) -> Result<Arc<dyn AnyTask>, EnvError>;

/// A registered environment: a task with some options preset.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct EnvironmentEntry {
    /// Its id.
    pub id: &'static str,
    /// Options that differ from the task's defaults; those that are not fixed can still be given.
    pub presets: &'static [(&'static str, &'static str)],
    /// Options that cannot be given another value, because they decide the time limit.
    pub fixed: &'static [&'static str],
    /// Time limit in control steps.
    pub max_episode_steps: u32,
    /// Mean return at which the task counts as solved: success in nine cases of ten; none where no
    /// agent of ours solves it.
    pub reward_threshold: Option<f64>,
}

/// Test cases by name: the same for every agent.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ProtocolEntry {
    /// Name of the protocol.
    pub name: &'static str,
    /// What the cases are.
    pub doc: &'static str,
    /// What a table calls the cases.
    pub cases: &'static str,
    /// Options that the task is made with, so that it plays these cases.
    pub presets: &'static [(&'static str, &'static str)],
    /// Whether cases are drawn by seed, as many as asked for; else there is a fixed list.
    pub random: bool,
    /// How an episode of such a case can end.
    pub outcomes: &'static [&'static str],
}

impl TaskEntry {
    /// A task of this kind.
    ///
    /// # Errors
    /// [`EnvError`] naming the unknown option, the value of the wrong kind or out of bounds, or the
    /// field of the config that this task cannot have.
    pub fn make(&self, config: Config, options: &Options) -> Result<Arc<dyn AnyTask>, EnvError> {
        (self.make)(config, &OptionValues::read(self.options, options)?)
    }

    /// The protocol of that name.
    ///
    /// # Errors
    /// [`EnvError::UnknownName`].
    pub fn protocol(&self, name: &str) -> Result<&'static ProtocolEntry, EnvError> {
        let known = || self.protocols.iter().map(|protocol| protocol.name);
        let found = self.protocols.iter().find(|protocol| protocol.name == name);
        found.ok_or_else(|| near::unknown("protocol", name, known()))
    }
}

/// The task of that name.
///
/// # Errors
/// [`EnvError::UnknownName`].
pub fn task(name: &str) -> Result<&'static TaskEntry, EnvError> {
    let found = TASKS.iter().find(|task| task.name == name);
    let known = || TASKS.iter().map(|task| task.name);
    found
        .copied()
        .ok_or_else(|| near::unknown("task", name, known()))
}

/// The environment of that id, and its task.
///
/// # Errors
/// [`EnvError::UnknownName`].
pub fn environment(id: &str) -> Result<(&'static TaskEntry, &'static EnvironmentEntry), EnvError> {
    let mut all = TASKS
        .iter()
        .flat_map(|task| task.environments.iter().map(move |row| (*task, row)));
    let known = || {
        let ids = |task: &&'static TaskEntry| task.environments.iter().map(|row| row.id);
        TASKS.iter().flat_map(ids)
    };
    all.find(|(_, row)| row.id == id)
        .ok_or_else(|| near::unknown("environment", id, known()))
}

/// The task of a registered environment, with a given config and options.
///
/// ```
/// use babble_env::{Autoreset, Config, Executor};
///
/// let task = babble_env::make("BabbleReach-v0", Config::profile("paper")?, &Default::default())?;
/// let mut envs = task.batch(2, Autoreset::NextStep, Executor::new(1)?)?;
/// envs.reset(&[true, true])?;
/// envs.step(&[0.5, 0.0, -0.5, 0.0])?;
/// # Ok::<(), babble_env::EnvError>(())
/// ```
///
/// # Errors
/// As [`check_fixed`] and [`TaskEntry::make`].
pub fn make(id: &str, config: Config, options: &Options) -> Result<Arc<dyn AnyTask>, EnvError> {
    check_fixed(id, options)?;
    let (task, row) = environment(id)?;
    let mut all = presets(row.presets);
    all.extend(options.clone());
    task.make(config, &all)
}

/// Checks that options leave an environment what its id stands for.
///
/// # Errors
/// [`EnvError::UnknownName`] for an unknown id, [`EnvError::Fixed`] for a fixed option with another
/// value; it names the environments that have this value.
pub fn check_fixed(id: &str, options: &Options) -> Result<(), EnvError> {
    let (task, row) = environment(id)?;
    let own = |row: &EnvironmentEntry| OptionValues::read(task.options, &presets(row.presets));
    let values = own(row)?;
    for &option in row.fixed {
        let given = options.get(option).and_then(Value::as_str);
        let Some(given) = given.filter(|&given| given != values.name(option)) else {
            continue;
        };
        let mut others = Vec::new();
        for other in task.environments {
            if !other.fixed.contains(&option) || own(other)?.name(option) == given {
                others.push(other.id);
            }
        }
        return Err(EnvError::Fixed {
            option,
            value: given.to_owned(),
            id: row.id,
            own: values.name(option).to_owned(),
            others: others.join(", "),
        });
    }
    Ok(())
}

/// Preset options as values.
#[must_use]
pub fn presets(presets: &[(&str, &str)]) -> Options {
    let value = |&(name, value): &(&str, &str)| (name.to_owned(), Value::from(value));
    presets.iter().map(value).collect()
}
