//! Agents that act: plans under way, and those that need no learning.

use std::sync::OnceLock;

use babble_agent::erased::{chaining, deciding};
use babble_agent::{AgentError, Decisions, Plan, Policy, Random, predict, reference};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::task::Task;
use crate::{convert, errors, signals};

/// What an agent is doing in each of n environments.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Plans {
    plans: Vec<Plan>,
}

#[pymethods]
impl Plans {
    /// In how many environments.
    fn __len__(&self) -> usize {
        self.plans.len()
    }

    /// Steps made of each plan that is a movement (n,); 0 for others.
    fn steps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<usize>> {
        let steps = self.plans.iter().map(|plan| match plan {
            Plan::Trajectory { step, .. } => *step,
            _ => 0,
        });
        PyArray1::from_vec(py, steps.collect())
    }

    /// Whether the hand has touched the object, in each grasp (n,); False for other plans.
    fn touched<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let touched = self.plans.iter().map(|plan| match plan {
            Plan::Grasp(grasp) => grasp.touched,
            _ => false,
        });
        PyArray1::from_vec(py, touched.collect())
    }

    /// Name of the chain's phase that is played in each environment; empty for other plans.
    fn phases(&self) -> Vec<&'static str> {
        let name = |plan: &Plan| match plan {
            Plan::Chain(chain) => chain.phase.name(),
            _ => "",
        };
        self.plans.iter().map(name).collect()
    }
}

/// Actions (n, k) of a policy for flat senses (n, m), and the plans for the next call.
pub(crate) fn act<'py>(
    py: Python<'py>,
    policy: &dyn Policy,
    senses: &PyReadonlyArray2<'py, f32>,
    starts: &[bool],
    plans: Option<&Plans>,
    threads: usize,
) -> PyResult<(Bound<'py, PyArray2<f32>>, Plans)> {
    convert::check_width(senses.as_array().shape(), policy.senses_len(), "senses")?;
    let senses: Vec<f32> = senses.as_array().iter().copied().collect();
    let mut plans = plans.map_or_else(Vec::new, |plans| plans.plans.clone());
    let actions = py
        .detach(|| {
            let executor = &mut signals::executor(threads)?;
            predict(policy, &senses, starts, &mut plans, executor)
        })
        .map_err(errors::agent)?;
    let actions = PyArray1::from_vec(py, actions).reshape([plans.len(), policy.action_len()])?;
    Ok((actions, Plans { plans }))
}

/// What a policy decides (n, k) for flat senses (n, m).
pub(crate) fn decide<'py>(
    py: Python<'py>,
    policy: &dyn Policy,
    senses: &PyReadonlyArray2<'py, f32>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    convert::check_width(senses.as_array().shape(), policy.senses_len(), "senses")?;
    let senses: Vec<f32> = senses.as_array().iter().copied().collect();
    let decided = py
        .detach(|| policy.decide(&senses, &mut signals::executor(threads)?))
        .map_err(errors::agent)?;
    let width = decided.first().map_or(0, Vec::len);
    convert::table(py, width, decided.iter().map(Vec::as_slice))
}

/// Actions (n, k) on decisions that `decide` makes for the flat senses (m, k) of environments that begin
/// an episode, and the plans for the next call. In a `chain` it decides again when the agent looks again.
#[pyfunction]
pub(crate) fn act_on<'py>(
    py: Python<'py>,
    task: &Task,
    decide: Py<PyAny>,
    senses: PyReadonlyArray2<'py, f32>,
    starts: Vec<bool>,
    plans: Option<&Plans>,
    chain: bool,
) -> PyResult<(Bound<'py, PyArray2<f32>>, Plans)> {
    let raised = OnceLock::new();
    let width = senses.as_array().shape()[1];
    let asked = |senses: &[f32]| {
        Python::attach(|py| ask(decide.bind(py), senses, width)).map_err(|error| {
            let problem = "it raised an exception".to_owned();
            raised.get_or_init(|| error);
            AgentError::Config {
                field: "decide",
                problem,
            }
        })
    };
    let policy = policy_on(task, chain, Decisions(&asked))?;
    let acted = act(py, &*policy, &senses, &starts, plans, 1);
    drop(policy);
    acted.map_err(|error| raised.into_inner().unwrap_or(error))
}

/// Checks that decisions can be acted on in a task, by the chain or otherwise.
#[pyfunction]
pub(crate) fn check_deciding(task: &Task, chain: bool) -> PyResult<()> {
    let none = |_: &[f32]| Ok(Vec::new());
    policy_on(task, chain, Decisions(&none)).map(|_| ())
}

fn policy_on<'a>(
    task: &Task,
    chain: bool,
    decisions: Decisions<'a>,
) -> PyResult<Box<dyn Policy + 'a>> {
    let policy = if chain { chaining } else { deciding };
    policy(&task.task, decisions).map_err(errors::agent)
}

/// What a function of Python decides for flat senses of that width.
fn ask(decide: &Bound<'_, PyAny>, senses: &[f32], width: usize) -> PyResult<Vec<f64>> {
    let rows = PyArray1::from_slice(decide.py(), senses).reshape([senses.len() / width, width])?;
    let decided: PyReadonlyArray2<'_, f64> = decide.call1((rows,))?.extract()?;
    Ok(decided.as_array().iter().copied().collect())
}

/// An agent that needs no learning, by name: "random", "scripted", "oracle" or "reflex".
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Reference {
    name: String,
    random: Random,
    threads: usize,
}

#[pymethods]
impl Reference {
    /// `choices` of the random agent have been made already.
    #[new]
    fn new(name: String, seed: u64, choices: u64, threads: usize) -> PyResult<Self> {
        signals::executor(threads).map_err(errors::env)?;
        Ok(Self {
            name,
            random: Random::new(seed, choices),
            threads,
        })
    }

    /// Checks that it can act in a task.
    fn check(&self, task: &Task) -> PyResult<()> {
        self.policy(task).map(|_| ())
    }

    /// Random choices made so far.
    fn choices(&self) -> u64 {
        self.random.choices()
    }

    /// Actions (n, k) for flat senses (n, m), and the plans for the next call.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        task: &Task,
        senses: PyReadonlyArray2<'py, f32>,
        starts: Vec<bool>,
        plans: Option<&Plans>,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Plans)> {
        act(
            py,
            &*self.policy(task)?,
            &senses,
            &starts,
            plans,
            self.threads,
        )
    }

    /// What it decides (n, k) for flat senses (n, m).
    fn decide<'py>(
        &self,
        py: Python<'py>,
        task: &Task,
        senses: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        decide(py, &*self.policy(task)?, &senses, self.threads)
    }
}

impl Reference {
    fn policy(&self, task: &Task) -> PyResult<Box<dyn Policy + '_>> {
        reference(&self.name, &task.task, &self.random).map_err(errors::agent)
    }
}

/// A network that was trained elsewhere and acts step by step.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct PolicyNetwork {
    network: babble_agent::PolicyNetwork,
}

#[pymethods]
impl PolicyNetwork {
    /// The network in the bytes of a safetensors file.
    #[staticmethod]
    fn load(bytes: &[u8]) -> PyResult<Self> {
        let network = babble_agent::PolicyNetwork::load(bytes).map_err(errors::agent)?;
        Ok(Self { network })
    }

    /// What is known of it beside its weights, as JSON.
    fn about(&self) -> PyResult<String> {
        convert::json(self.network.about())
    }

    /// The network as the bytes of a safetensors file.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(
            py,
            &self.network.save().map_err(errors::agent)?,
        ))
    }

    /// Actions (n, k) for flat senses (n, m), and the plans for the next call.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
        starts: Vec<bool>,
        plans: Option<&Plans>,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Plans)> {
        act(py, &self.network, &senses, &starts, plans, 1)
    }
}
