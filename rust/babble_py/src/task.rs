//! A task of any kind as a Python object, and the registry.

use std::sync::Arc;

use babble_env::{AnyTask, Config, EnvError, Options, Purpose, registry};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{self, case_dict};
use crate::{errors, signals};

/// A task: a config and the options chosen with it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) task: Arc<dyn AnyTask>,
}

impl Task {
    /// The task as one of its own type, for what is made for one task alone.
    pub(crate) fn downcast<T: babble_env::Task>(&self) -> PyResult<Arc<T>> {
        babble_env::downcast(&self.task).ok_or_else(|| {
            errors::env(EnvError::OptionKind {
                option: "task",
                value: "this one".to_owned(),
                expected: format!("a task of {}", T::NAME),
            })
        })
    }
}

#[pymethods]
impl Task {
    /// A task of the registry by its name, from a config and options by name, both as JSON.
    #[new]
    fn new(name: &str, config: &str, options: &str) -> PyResult<Self> {
        let options = read_options(options)?;
        let make = || registry::task(name)?.make(Config::from_json(config)?, &options);
        Ok(Self {
            task: make().map_err(errors::env)?,
        })
    }

    /// The complete config, as JSON.
    fn config(&self) -> PyResult<String> {
        self.task.config().to_json().map_err(errors::env)
    }

    /// Observations, actions, reward terms, facts and outcomes, as JSON.
    fn spec(&self) -> PyResult<String> {
        convert::json(&self.task.spec())
    }

    /// Numbers that agents and exports need, in SI units, as JSON.
    fn quantities(&self) -> PyResult<String> {
        convert::json(&self.task.quantities())
    }

    /// Links of arm and hand, as JSON.
    fn robot(&self) -> PyResult<String> {
        convert::json(&self.task.robot())
    }

    /// Physics steps in which the solver of contacts did not converge, in all environments of this task
    /// together; None where no solver tells.
    fn unconverged_steps(&self) -> Option<u64> {
        self.task.unconverged_steps()
    }

    /// The cases of a protocol; None at places of a fixed list that have no case.
    fn cases<'py>(
        &self,
        py: Python<'py>,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: &str,
        threads: usize,
    ) -> PyResult<Vec<Option<Bound<'py, PyDict>>>> {
        let draw = || {
            let purpose = purpose.parse::<Purpose>()?;
            let mut executor = signals::executor(threads)?;
            self.task.cases(protocol, n, seed, purpose, &mut executor)
        };
        let cases = py.detach(draw).map_err(errors::env)?;
        let dict = |case: &Option<_>| case.as_ref().map(|case| case_dict(py, case)).transpose();
        cases.iter().map(dict).collect()
    }

    /// Reward of the goal form for rows of achieved and desired goals (n, k).
    fn goal_reward<'py>(
        &self,
        py: Python<'py>,
        achieved: PyReadonlyArray2<'py, f32>,
        desired: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let width = self.task.spec().goal_len();
        let achieved = convert::wide_rows(&achieved, width, "achieved_goal")?;
        let desired = convert::wide_rows(&desired, width, "desired_goal")?;
        let pairs = achieved.iter().zip(&desired);
        let rewards = pairs.map(|(achieved, desired)| self.task.goal_reward(achieved, desired));
        Ok(PyArray1::from_iter(py, rewards.collect::<Vec<_>>()))
    }
}

/// Checks that options (JSON) leave an environment what its id stands for.
#[pyfunction]
pub(crate) fn check_fixed(env_id: &str, options: &str) -> PyResult<()> {
    registry::check_fixed(env_id, &read_options(options)?).map_err(errors::env)
}

fn read_options(json: &str) -> PyResult<Options> {
    serde_json::from_str(json)
        .map_err(|error| errors::ConfigError::new_err(format!("options: {error}")))
}

/// All tasks with their environments, options, parts of a case and protocols, as JSON.
#[pyfunction]
pub(crate) fn registry_json() -> PyResult<String> {
    convert::json(&registry::TASKS)
}
