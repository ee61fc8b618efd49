//! Networks that learn by babbling, and what babbles leave behind.

use babble_agent::AgentError;
use babble_agent::babbling::ColumnKind;
use babble_agent::erased::{self, AnyLearner};
use babble_brain::Association;
use babble_env::Executor;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::Value;

use crate::guarded::Guarded;
use crate::policy::{Plans, act};
use crate::task::Task;
use crate::{convert, errors, signals};

/// Weights, and running averages of output and input.
type Parts<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
);
/// The same, as a rule of one's own returns them.
type Learnt<'py> = (
    PyReadonlyArray2<'py, f32>,
    PyReadonlyArray1<'py, f32>,
    PyReadonlyArray1<'py, f32>,
);

/// A network that learns by babbling. In `with learner:` no other thread can use it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Learner {
    inner: Guarded<Inner>,
}

/// What learning changes.
#[derive(Debug)]
struct Inner {
    learner: Box<dyn AnyLearner>,
    executor: Executor,
}

#[pymethods]
impl Learner {
    /// A network that has learnt nothing, for a task; `brain` (complete) and `babbling` are JSON.
    #[new]
    fn new(
        task: &Task,
        brain: &str,
        seed: u64,
        babbling: &str,
        shuffled: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let (brain, babbling) = (value("brain", brain)?, value("babbling", babbling)?);
        let learner = erased::learner(&task.task, brain, seed, babbling);
        let mut learner = learner.map_err(errors::agent)?;
        if shuffled {
            learner.shuffle();
        }
        Self::of(learner, threads)
    }

    /// The learner in the bytes of a safetensors file.
    #[staticmethod]
    fn load(bytes: &[u8], threads: usize) -> PyResult<Self> {
        Self::of(erased::load(bytes).map_err(errors::agent)?, threads)
    }

    fn __enter__(&self) -> PyResult<()> {
        self.inner.enter()
    }

    fn __exit__(
        &self,
        _type: &Bound<'_, PyAny>,
        _raised: &Bound<'_, PyAny>,
        _at: &Bound<'_, PyAny>,
    ) {
        self.inner.leave();
    }

    /// Name of its task.
    fn task(&self) -> PyResult<&'static str> {
        Ok(self.inner.read()?.learner.task())
    }

    /// The config that it babbles with, as JSON.
    fn config(&self) -> PyResult<String> {
        self.inner
            .read()?
            .learner
            .config()
            .to_json()
            .map_err(errors::env)
    }

    /// Numbers of maps and rule, as JSON.
    fn brain(&self) -> PyResult<String> {
        let brain = self.inner.read()?.learner.brain();
        convert::json(&brain.map_err(errors::agent)?)
    }

    /// How it babbles, as JSON.
    fn babbling(&self) -> PyResult<String> {
        let options = self.inner.read()?.learner.options();
        convert::json(&options.map_err(errors::agent)?)
    }

    /// Seed of the babbling, babbles made, and how many of them were learnt from.
    fn counts(&self) -> PyResult<(u64, u64, u64)> {
        let learner = &self.inner.read()?.learner;
        Ok((learner.seed(), learner.babbled(), learner.learnt()))
    }

    /// Whether percepts are paired with the action of the babble before.
    fn shuffled(&self) -> PyResult<bool> {
        Ok(self.inner.read()?.learner.shuffled())
    }

    /// Babbles and learns in another task of the same kind from now on.
    fn move_to(&self, task: &Task) -> PyResult<()> {
        let learner = &mut self.inner.write()?.learner;
        learner.move_to(&task.task).map_err(errors::agent)
    }

    /// Babbles on `task` until `n` more babbles can be learnt from, and learns from them; interrupted,
    /// it has done neither. `rule(w, a_mean, g_mean, g, a)` returns the first three after g and a.
    #[pyo3(signature = (task, n, rule=None))]
    fn learn(
        &self,
        py: Python<'_>,
        task: &Task,
        n: usize,
        rule: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let Inner { learner, executor } = &mut *self.inner.write()?;
        let Some(rule) = rule else {
            return py
                .detach(|| learner.learn(&task.task, n, executor))
                .map_err(errors::agent);
        };
        let mut raised = None;
        let mut teach = |association: &mut Association, g: &[f32], a: &[f32]| {
            let taught = Python::attach(|py| apply(rule.bind(py), association, g, a));
            taught.map_err(|error| {
                raised = Some(error);
                AgentError::Rule {
                    problem: "it raised an exception".to_owned(),
                }
            })
        };
        let learnt = py.detach(|| learner.learn_by(&mut teach, &task.task, n, executor));
        learnt.map_err(|error| raised.unwrap_or_else(|| errors::agent(error)))
    }

    /// Makes `n` more trials on `task` and learns from their reward; interrupted, it has done neither.
    fn practise(&self, py: Python<'_>, task: &Task, n: usize) -> PyResult<()> {
        let Inner { learner, executor } = &mut *self.inner.write()?;
        py.detach(|| learner.practise(&task.task, n, executor))
            .map_err(errors::agent)
    }

    /// Trials that it has learnt from by their reward, and control steps that they took.
    fn practice(&self) -> PyResult<(u64, u64)> {
        let practice = self.inner.read()?.learner.practice();
        Ok((practice.trials, practice.steps))
    }

    /// Control steps that one of its babbles takes in a task.
    fn babble_steps(&self, task: &Task) -> PyResult<usize> {
        let steps = self.inner.read()?.learner.babble_steps(&task.task);
        steps.map_err(errors::agent)
    }

    /// Actions (n, k) for flat senses (n, m) of a task, and the plans for the next call.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        task: &Task,
        senses: PyReadonlyArray2<'py, f32>,
        starts: Vec<bool>,
        plans: Option<&Plans>,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Plans)> {
        let inner = self.inner.read()?;
        let policy = inner.learner.policy(&task.task).map_err(errors::agent)?;
        act(py, &*policy, &senses, &starts, plans, 1)
    }

    /// Checks that it can act in a task.
    fn check(&self, task: &Task) -> PyResult<()> {
        let inner = self.inner.read()?;
        let policy = inner.learner.policy(&task.task);
        policy.map(|_| ()).map_err(errors::agent)
    }

    /// What its maps are read out as (n, k), for flat senses (n, m).
    fn decide<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let senses: Vec<Vec<f32>> = senses
            .as_array()
            .rows()
            .into_iter()
            .map(|row| row.to_vec())
            .collect();
        let learner = &self.inner.read()?.learner;
        let decided = py
            .detach(|| {
                let each = senses.iter().map(|senses| learner.decide(senses));
                each.collect::<Result<Vec<_>, _>>()
            })
            .map_err(errors::agent)?;
        let width = decided.first().map_or(0, Vec::len);
        convert::table(py, width, decided.iter().map(Vec::as_slice))
    }

    /// Activities of the input maps by name, with the axes of `input_shapes`, for flat senses (m,).
    fn perceive<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray1<'py, f32>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let senses = senses.as_array().to_vec();
        let learner = &self.inner.read()?.learner;
        let percepts = learner.perceive(&senses).map_err(errors::agent)?;
        let dict = PyDict::new(py);
        for (percept, shape) in percepts.into_iter().zip(learner.input_shapes()) {
            let activity = PyArray1::from_vec(py, percept.activity);
            dict.set_item(percept.name, activity.reshape(shape)?)?;
        }
        Ok(dict)
    }

    /// Activities (side, side) of the output maps by name, rows the second value, for flat senses (m,).
    fn recall<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray1<'py, f32>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let senses = senses.as_array().to_vec();
        let learner = &self.inner.read()?.learner;
        let dict = PyDict::new(py);
        for recall in learner.recall(&senses).map_err(errors::agent)? {
            let activity = PyArray1::from_vec(py, recall.activity);
            dict.set_item(recall.name, activity.reshape([recall.side; 2])?)?;
        }
        Ok(dict)
    }

    /// The weights `w_ji` (outputs, inputs) and the running averages by name, as copies.
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let learner = &self.inner.read()?.learner;
        let dict = PyDict::new(py);
        for (prefix, association) in learner.associations() {
            let (weights, a_mean, g_mean) = parts(py, association)?;
            dict.set_item(format!("{prefix}weights"), weights)?;
            dict.set_item(format!("{prefix}a_mean"), a_mean)?;
            dict.set_item(format!("{prefix}g_mean"), g_mean)?;
        }
        Ok(dict)
    }

    /// Sets weights and running averages of all associations, in their order.
    fn set(&self, parts: Vec<Learnt<'_>>) -> PyResult<()> {
        let learner = &mut self.inner.write()?.learner;
        let parts = parts.into_iter().map(|(weights, a_mean, g_mean)| {
            let [a_mean, g_mean] = [a_mean, g_mean].map(|mean| mean.as_array().to_vec());
            convert::check_width(weights.as_array().shape(), g_mean.len(), "weights")?;
            Ok([weights.as_array().iter().copied().collect(), a_mean, g_mean])
        });
        let parts = parts.collect::<PyResult<Vec<_>>>()?;
        learner.set(&parts).map_err(errors::agent)
    }

    /// What the names of each association's weights begin with, in their order.
    fn prefixes(&self) -> PyResult<Vec<&'static str>> {
        let learner = &self.inner.read()?.learner;
        Ok(learner
            .associations()
            .iter()
            .map(|(name, _)| *name)
            .collect())
    }

    /// Neurons along the axes of the input map of each association.
    fn input_shapes(&self) -> PyResult<Vec<Vec<usize>>> {
        Ok(self.inner.read()?.learner.input_shapes())
    }

    /// The learner as the bytes of a safetensors file.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.inner.read()?.learner.save();
        Ok(PyBytes::new(py, &bytes.map_err(errors::agent)?))
    }
}

impl Learner {
    fn of(learner: Box<dyn AnyLearner>, threads: usize) -> PyResult<Self> {
        let executor = signals::executor(threads).map_err(errors::env)?;
        Ok(Self {
            inner: Guarded::new("agent", Inner { learner, executor }),
        })
    }
}

/// The numbers of a variant of a task's network, as JSON.
#[pyfunction]
pub(crate) fn brain_json(task: &str, variant: &str) -> PyResult<String> {
    convert::json(&erased::brain_of(task, variant).map_err(errors::agent)?)
}

/// Control steps that a babble takes; `babbling` says how it is simulated, as JSON.
#[pyfunction]
pub(crate) fn babble_steps(task: &Task, babbling: &str) -> PyResult<usize> {
    let options = value("babbling", babbling)?;
    erased::babble_steps(&task.task, options).map_err(errors::agent)
}

/// The first `n` babbles of a seed, with an experience at the end of each or every `period_s` seconds:
/// percepts, actions and parts of the case by name, which babble each experience is of, whether it can
/// be learnt from, and the code of the babble's outcome.
#[pyfunction]
pub(crate) fn babble<'py>(
    py: Python<'py>,
    task: &Task,
    n: usize,
    seed: u64,
    babbling: &str,
    period_s: Option<f64>,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let options = value("babbling", babbling)?;
    let found = py
        .detach(|| {
            let executor = &mut signals::executor(threads)?;
            erased::babble_any(&task.task, n, seed, options, period_s, executor)
        })
        .map_err(errors::agent)?;
    columns(py, found)
}

/// The babbles after `babbled` ones of a seed until `n` more can be learnt from: what these leave behind
/// as from `babble`, and babbles made and learnt from after them.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "two more than allowed, for Python's lock and two counts"
)]
pub(crate) fn learnable_babbles<'py>(
    py: Python<'py>,
    task: &Task,
    n: usize,
    seed: u64,
    babbled: u64,
    learnt: u64,
    babbling: &str,
    period_s: Option<f64>,
    threads: usize,
) -> PyResult<(Bound<'py, PyDict>, u64, u64)> {
    let (options, counts) = (value("babbling", babbling)?, [babbled, learnt]);
    let (found, [babbled, learnt]) = py
        .detach(|| {
            let executor = &mut signals::executor(threads)?;
            erased::learnable_any(&task.task, n, seed, counts, options, period_s, executor)
        })
        .map_err(errors::agent)?;
    Ok((columns(py, found)?, babbled, learnt))
}

/// Babbles in grasping from number `first` of a seed on, to postures (n, 6) of the arm: shoulder and
/// elbow of three postures, as shares of their ranges. Three experiences of each babble, as from `babble`.
#[pyfunction]
pub(crate) fn babble_to<'py>(
    py: Python<'py>,
    task: &Task,
    seed: u64,
    first: u64,
    postures: PyReadonlyArray2<'py, f64>,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let postures: Vec<[f64; 6]> = convert::rows(&postures, "postures")?;
    let postures: Vec<_> = postures
        .into_iter()
        .map(|[a, b, c, d, e, f]| [[a, b], [c, d], [e, f]])
        .collect();
    let found = py
        .detach(|| {
            let executor = &mut signals::executor(threads)?;
            erased::babble_to(&task.task, seed, first, &postures, executor)
        })
        .map_err(errors::agent)?;
    columns(py, found)
}

/// Experiences as arrays by name.
fn columns(py: Python<'_>, found: erased::Experiences) -> PyResult<Bound<'_, PyDict>> {
    let rows = found.learnable.len();
    let kinds = ["percepts", "actions", "case"].map(|name| (name, PyDict::new(py)));
    for column in found.columns {
        let kind = match column.kind {
            ColumnKind::Percept => 0,
            ColumnKind::Action => 1,
            ColumnKind::Case => 2,
        };
        let values = PyArray1::from_vec(py, column.values).reshape([rows, column.width])?;
        kinds[kind].1.set_item(column.name, values)?;
    }
    let dict = PyDict::new(py);
    for (name, columns) in kinds {
        dict.set_item(name, columns)?;
    }
    dict.set_item("babble", PyArray1::from_vec(py, found.babbles))?;
    dict.set_item("learnable", PyArray1::from_vec(py, found.learnable))?;
    let outcomes = found.outcomes.iter().map(|&outcome| outcome as usize);
    dict.set_item("outcome", PyArray1::from_vec(py, outcomes.collect()))?;
    Ok(dict)
}

fn value(what: &str, json: &str) -> PyResult<Value> {
    serde_json::from_str(json)
        .map_err(|error| errors::ConfigError::new_err(format!("{what}: {error}")))
}

fn parts<'py>(py: Python<'py>, association: &Association) -> PyResult<Parts<'py>> {
    let weights = PyArray1::from_slice(py, association.weights());
    Ok((
        weights.reshape([association.n_out(), association.n_in()])?,
        PyArray1::from_slice(py, association.a_mean()),
        PyArray1::from_slice(py, association.g_mean()),
    ))
}

/// Lets a rule of the user's own change an association.
fn apply(
    rule: &Bound<'_, PyAny>,
    association: &mut Association,
    g: &[f32],
    a: &[f32],
) -> PyResult<()> {
    let py = rule.py();
    let (n_in, n_out) = (association.n_in(), association.n_out());
    let g = PyArray1::from_slice(py, g).reshape([g.len() / n_in, n_in])?;
    let a = PyArray1::from_slice(py, a).reshape([a.len() / n_out, n_out])?;
    let (weights, a_mean, g_mean) = parts(py, association)?;
    let learnt = rule.call1((weights, a_mean, g_mean, g, a))?;
    let (weights, a_mean, g_mean): Learnt<'_> = learnt.extract()?;
    let weights: Vec<f32> = weights.as_array().iter().copied().collect();
    let [a_mean, g_mean] = [a_mean, g_mean].map(|mean| mean.as_array().to_vec());
    association.set_weights(&weights).map_err(errors::brain)?;
    association
        .set_means(&a_mean, &g_mean)
        .map_err(errors::brain)
}
