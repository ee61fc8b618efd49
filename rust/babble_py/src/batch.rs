//! n environments of any task as one Python object.

use std::sync::Arc;

use babble_env::batch::Record;
use babble_env::case::CasePart;
use babble_env::picture::View;
use babble_env::task::MAX_MEASURES;
use babble_env::{AnyBatch, EnvError, seeding};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString, PyTuple};

use crate::convert::{array2, case_dict, case_values, table};
use crate::guarded::Guarded;
use crate::task::Task;
use crate::{errors, signals};

/// Indices of the environments whose episode ended, and what those episodes showed last.
type Ended<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyDict>);

/// A batch of n episodes, stepped together.
///
/// In `with batch:` no other thread can use it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Batch {
    envs: Guarded<Box<dyn AnyBatch>>,
    /// What may be asked of a case.
    parts: &'static [CasePart],
    /// Whether one step takes longer than handing it to a thread.
    long_steps: bool,
    senses: usize,
    /// Numbers in a goal; 0 without goals.
    goals: usize,
    facts: Vec<InfoKey>,
    terms: Vec<InfoKey>,
    outcomes: Vec<InfoKey>,
    /// The outcomes, in the same order.
    outcome_names: Vec<&'static str>,
    /// Names of the measures, and how many numbers each has.
    measures: Vec<(InfoKey, usize)>,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (task, num_envs=1, *, autoreset="Disabled", threads=1))]
    fn new(
        py: Python<'_>,
        task: &Task,
        num_envs: usize,
        autoreset: &str,
        threads: usize,
    ) -> PyResult<Self> {
        let make = || {
            let (autoreset, executor) = (autoreset.parse()?, signals::executor(threads)?);
            Arc::clone(&task.task).batch(num_envs, autoreset, executor)
        };
        let envs = py.detach(make).map_err(errors::env)?;
        let spec = task.task.spec();
        let senses = spec.senses.iter().map(|entry| entry.labels.len()).sum();
        let names = |names: &[&str]| names.iter().map(|name| InfoKey::new(py, name)).collect();
        Ok(Self {
            envs: Guarded::new("environment", envs),
            parts: task.task.case_parts(),
            long_steps: task.task.has_long_steps(),
            senses,
            goals: spec.goal_len(),
            facts: names(spec.facts),
            terms: names(spec.reward_terms),
            outcomes: names(&spec.outcomes),
            outcome_names: spec.outcomes,
            measures: spec
                .measures
                .iter()
                .map(|one| (InfoKey::new(py, one.name), one.labels.len()))
                .collect(),
        })
    }

    fn __enter__(&self) -> PyResult<()> {
        self.envs.enter()
    }

    fn __exit__(
        &self,
        _type: &Bound<'_, PyAny>,
        _raised: &Bound<'_, PyAny>,
        _at: &Bound<'_, PyAny>,
    ) {
        self.envs.leave();
    }

    /// Starts the stream of cases of environment `i` anew, with a seed of Gymnasium's `reset`.
    fn seed(&self, i: usize, seed: u64) -> PyResult<()> {
        let stream = seeding::stream_seed(seed);
        self.envs.write()?.seed(i, stream).map_err(errors::env)
    }

    /// What the following resets of environment `i` ask of their cases, in the task's own words.
    fn request(&self, i: usize, asked: &Bound<'_, PyDict>) -> PyResult<()> {
        let asked = case_values(self.parts, asked)?;
        self.envs.write()?.request(i, &asked).map_err(errors::env)
    }

    /// Begins new episodes where `mask` is true; in all environments without one.
    #[pyo3(signature = (mask=None))]
    fn reset(&self, py: Python<'_>, mask: Option<Vec<bool>>) -> PyResult<()> {
        let envs = &mut *self.envs.write()?;
        let n = envs.envs();
        let mask = mask.unwrap_or_else(|| vec![true; n]);
        if mask.len() != n {
            return Err(errors::env(EnvError::OutOfBounds {
                option: "reset_mask",
                value: format!("{} numbers", mask.len()),
                bound: format!("of length {n}"),
            }));
        }
        py.detach(|| envs.reset(&mask)).map_err(errors::env)
    }

    /// One step of all environments; `actions` (n, k).
    fn step(&self, py: Python<'_>, actions: PyReadonlyArrayDyn<'_, f32>) -> PyResult<()> {
        let envs = &mut *self.envs.write()?;
        // A copy, as other threads may write to the array meanwhile.
        let actions = copied(&actions);
        py.detach(|| envs.step(&actions)).map_err(errors::env)
    }

    /// One step of a batch of one, and what it shows, as [`Self::one`]; without letting go of the
    /// interpreter if it takes microseconds.
    fn step_one<'py>(
        &self,
        py: Python<'py>,
        actions: PyReadonlyArrayDyn<'py, f32>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let envs = &mut *self.envs.write()?;
        if self.long_steps {
            let actions = copied(&actions);
            py.detach(|| envs.step(&actions))
        } else if let Ok(actions) = actions.as_slice() {
            envs.step(actions)
        } else {
            envs.step(&copied(&actions))
        }
        .map_err(errors::env)?;
        self.show_one(py, &**envs)
    }

    /// What environment 0 showed last: (senses, reward, terminated, truncated, info).
    fn one<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.show_one(py, &**self.envs.read()?)
    }

    /// Achieved and desired goal of environment 0; none where the task has no goals.
    fn one_goals<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray1<f32>>>> {
        if self.goals == 0 {
            return Ok(Vec::new());
        }
        Ok(self.envs.read()?.record(0).map_or_else(Vec::new, |record| {
            [&record.achieved, &record.desired]
                .map(|x| PyArray1::from_slice(py, x))
                .into()
        }))
    }

    /// What all environments showed last, in new arrays of length n: senses, achieved goals and desired
    /// goals where the task has them, rewards, terminated, truncated, and infos in the layout of
    /// Gymnasium's `VectorEnv`, each key beside its mask. With `mask`, infos are only of the environments
    /// for which it is true.
    #[pyo3(signature = (mask=None))]
    fn all<'py>(&self, py: Python<'py>, mask: Option<Vec<bool>>) -> PyResult<Bound<'py, PyDict>> {
        let envs = &*self.envs.read()?;
        let records: Vec<&Record> = (0..envs.envs()).filter_map(|i| envs.record(i)).collect();
        let mask = mask.unwrap_or_else(|| vec![true; records.len()]);
        let shown = self.arrays(py, &records)?;
        let each = || records.iter().map(|r| r.step);
        shown.set_item(intern!(py, "reward"), array(py, each().map(|s| s.reward)))?;
        let terminated = array(py, each().map(|s| s.terminated));
        shown.set_item(intern!(py, "terminated"), terminated)?;
        let truncated = array(py, each().map(|s| s.truncated));
        shown.set_item(intern!(py, "truncated"), truncated)?;
        shown.set_item(intern!(py, "infos"), self.infos(py, &records, &mask)?)?;
        Ok(shown)
    }

    /// Senses, goals, outcome codes, facts, reward terms and measures of the ended episodes of
    /// environments that began anew by themselves within the last step, and the indices of these; None if
    /// there are none.
    fn ended<'py>(&self, py: Python<'py>) -> PyResult<Option<Ended<'py>>> {
        let envs = &*self.envs.read()?;
        let ended: Vec<(usize, &Record)> = (0..envs.envs())
            .filter_map(|i| Some((i, envs.final_record(i)?)))
            .collect();
        if ended.is_empty() {
            return Ok(None);
        }
        let (indices, records): (Vec<usize>, Vec<&Record>) = ended.into_iter().unzip();
        let shown = self.arrays(py, &records)?;
        let each = || records.iter();
        let outcome = array(py, each().map(|r| r.info.outcome as usize));
        shown.set_item("outcome", outcome)?;
        let n = self.facts.len();
        let facts = table(py, n, each().map(|r| &r.info.facts[..n]))?;
        shown.set_item("facts", facts)?;
        let n = self.terms.len();
        let terms = table(py, n, each().map(|r| &r.step.terms[..n]))?;
        shown.set_item("terms", terms)?;
        let n = self.measures.iter().map(|(_, n)| n).sum();
        if n > 0 {
            let measures = table(py, n, each().map(|r| &r.info.measures[..n]))?;
            shown.set_item("measures", measures)?;
        }
        Ok(Some((PyArray1::from_vec(py, indices), shown)))
    }

    /// Bytes from which environment `i` continues bit for bit.
    fn save<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.envs.read()?.save(i).map_err(errors::env)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The ended episode of environment `i` as such bytes; None if it did not begin anew by itself
    /// within the last step.
    fn save_ended<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let bytes = self.envs.read()?.save_final(i).map_err(errors::env)?;
        Ok(bytes.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// Continues environment `i` from bytes.
    fn load(&self, i: usize, bytes: &[u8]) -> PyResult<()> {
        self.envs.write()?.load(i, bytes).map_err(errors::env)
    }

    /// A number that two states share only if they are the same to the bit.
    fn state_hash(&self, i: usize) -> PyResult<u64> {
        self.envs.read()?.state_hash(i).map_err(errors::env)
    }

    /// The case of environment `i`, in the task's own words.
    fn case<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyDict>> {
        let case = self.envs.read()?.case(i).map_err(errors::env)?;
        case_dict(py, &case)
    }

    /// The recorded way of the hand of environment `i`, one row a control step \[m\].
    fn trail<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let trail = self.envs.read()?.trail(i).map_err(errors::env)?;
        array2(py, &trail)
    }

    /// How many moments of environment `i` were recorded since its reset.
    fn moments(&self, i: usize) -> PyResult<usize> {
        self.envs.read()?.moments(i).map_err(errors::env)
    }

    /// A picture (height, width, 3) of environment `i`, now or at a recorded moment.
    #[pyo3(signature = (i, camera, width, height, frame=None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        i: usize,
        camera: &str,
        width: u32,
        height: u32,
        frame: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let envs = &*self.envs.read()?;
        let draw = || envs.picture(i, camera.parse::<View>()?, [width, height], frame);
        let image = py.detach(draw).map_err(errors::env)?;
        PyArray1::from_vec(py, image.into_raw()).reshape([height as usize, width as usize, 3])
    }

    /// The eye's image (size, size, 3) of environment `i`.
    fn retina<'py>(
        &self,
        py: Python<'py>,
        i: usize,
        size: u32,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.render(py, i, View::Eye.name(), size, size, None)
    }

    /// The eye's last image (size, size, 3) of the ended episode of environment `i`; None if it did not
    /// begin anew by itself within the last step.
    fn retina_ended<'py>(
        &self,
        py: Python<'py>,
        i: usize,
        size: u32,
    ) -> PyResult<Option<Bound<'py, PyArray3<u8>>>> {
        let envs = &*self.envs.read()?;
        let draw = || envs.final_picture(i, View::Eye, [size; 2]);
        let Some(image) = py.detach(draw).map_err(errors::env)? else {
            return Ok(None);
        };
        let shape = [size as usize, size as usize, 3];
        PyArray1::from_vec(py, image.into_raw())
            .reshape(shape)
            .map(Some)
    }

    /// Threads that step the batch.
    #[getter]
    fn threads(&self) -> PyResult<usize> {
        Ok(self.envs.read()?.threads())
    }
}

impl Batch {
    fn show_one<'py>(&self, py: Python<'py>, envs: &dyn AnyBatch) -> PyResult<Bound<'py, PyTuple>> {
        let Some(Record {
            senses, info, step, ..
        }) = envs.record(0)
        else {
            return Ok(PyTuple::empty(py));
        };
        let shown = named(py, &self.facts, &info.facts)?;
        let now = info.outcome.name();
        let outcome: Vec<bool> = self.outcome_names.iter().map(|&name| name == now).collect();
        let outcome = named(py, &self.outcomes, &outcome)?;
        shown.set_item(intern!(py, "outcome"), outcome)?;
        let terms = named(py, &self.terms, &step.terms)?;
        shown.set_item(intern!(py, "reward_terms"), terms)?;
        let mut from = 0;
        for (key, n) in &self.measures {
            let numbers = PyArray1::from_slice(py, &info.measures[from..from + n]);
            shown.set_item(&key.name, numbers)?;
            from += n;
        }
        (
            PyArray1::from_slice(py, senses),
            step.reward,
            step.terminated,
            step.truncated,
            shown,
        )
            .into_pyobject(py)
    }

    /// Senses and goals.
    fn arrays<'py>(&self, py: Python<'py>, records: &[&Record]) -> PyResult<Bound<'py, PyDict>> {
        let each = || records.iter();
        let dict = PyDict::new(py);
        let senses = table(py, self.senses, each().map(|r| &r.senses[..]))?;
        dict.set_item(intern!(py, "senses"), senses)?;
        if self.goals > 0 {
            let achieved = table(py, self.goals, each().map(|r| &r.achieved[..]))?;
            dict.set_item(intern!(py, "achieved_goal"), achieved)?;
            let desired = table(py, self.goals, each().map(|r| &r.desired[..]))?;
            dict.set_item(intern!(py, "desired_goal"), desired)?;
        }
        Ok(dict)
    }

    /// Facts, outcomes, reward terms and measures of the environments in `mask`; false and 0 for the
    /// others.
    fn infos<'py>(
        &self,
        py: Python<'py>,
        records: &[&Record],
        mask: &[bool],
    ) -> PyResult<Bound<'py, PyDict>> {
        let masked = || records.iter().zip(mask);
        let add = |dict: &Bound<'py, PyDict>, key: &InfoKey, values: Bound<'py, PyAny>| {
            dict.set_item(&key.name, values)?;
            dict.set_item(&key.mask, PyArray1::from_slice(py, mask))
        };
        let infos = PyDict::new(py);
        for (k, key) in self.facts.iter().enumerate() {
            let facts = array(py, masked().map(|(r, &shown)| shown && r.info.facts[k]));
            add(&infos, key, facts.into_any())?;
        }
        let outcomes = PyDict::new(py);
        for (key, &name) in self.outcomes.iter().zip(&self.outcome_names) {
            let is = masked().map(|(r, &shown)| shown && r.info.outcome.name() == name);
            add(&outcomes, key, array(py, is).into_any())?;
        }
        let terms = PyDict::new(py);
        for (k, key) in self.terms.iter().enumerate() {
            let term = masked().map(|(r, &shown)| if shown { r.step.terms[k] } else { 0.0 });
            add(&terms, key, array(py, term).into_any())?;
        }
        for (name, of_name, part) in [
            (intern!(py, "outcome"), intern!(py, "_outcome"), outcomes),
            (
                intern!(py, "reward_terms"),
                intern!(py, "_reward_terms"),
                terms,
            ),
        ] {
            infos.set_item(name, part)?;
            infos.set_item(of_name, PyArray1::from_slice(py, mask))?;
        }
        let mut from = 0;
        for (key, n) in &self.measures {
            let numbers = masked().map(|(r, &shown)| {
                let measures = if shown {
                    &r.info.measures
                } else {
                    &NO_MEASURES
                };
                &measures[from..from + n]
            });
            add(&infos, key, table(py, *n, numbers)?.into_any())?;
            from += n;
        }
        Ok(infos)
    }
}

/// What is shown of an environment that is not in the mask.
const NO_MEASURES: [f64; MAX_MEASURES] = [0.0; MAX_MEASURES];

/// Seed of the stream of cases for a seed of Gymnasium's `reset`.
#[pyfunction]
pub(crate) fn stream_seed(seed: u64) -> u64 {
    seeding::stream_seed(seed)
}

/// A key of the infos.
#[derive(Debug)]
struct InfoKey {
    name: Py<PyString>,
    /// The key, after an underscore, of the mask of environments that have a value.
    mask: Py<PyString>,
}

impl InfoKey {
    fn new(py: Python<'_>, name: &str) -> Self {
        Self {
            name: PyString::intern(py, name).unbind(),
            mask: PyString::intern(py, &format!("_{name}")).unbind(),
        }
    }
}

/// A new array of some values.
fn array<T: numpy::Element>(
    py: Python<'_>,
    values: impl Iterator<Item = T>,
) -> Bound<'_, PyArray1<T>> {
    // A copy is quicker than an array that owns memory of Rust, if it is short.
    PyArray1::from_slice(py, &values.collect::<Vec<T>>())
}

/// Values by name.
fn named<'py, T: IntoPyObject<'py> + Copy>(
    py: Python<'py>,
    names: &[InfoKey],
    values: &[T],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, &value) in names.iter().zip(values) {
        dict.set_item(&key.name, value)?;
    }
    Ok(dict)
}

/// The numbers of an array, in the order of C.
fn copied(array: &PyReadonlyArrayDyn<'_, f32>) -> Vec<f32> {
    array.as_array().iter().copied().collect()
}
