//! n environments as one Python object.

use babble_env::batch::Record;
use babble_env::picture::View;
use babble_env::reach::case::{CaseRequest, ObstacleRequest};
use babble_env::reach::{EVER_SUCCESS, IS_SUCCESS};
use babble_env::{Autoreset, EnvError, ReachTask, Task as _, snapshot};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::task::Task;
use crate::{convert, errors};

/// Indices of the environments whose episode ended, and what those episodes showed last.
type Ended<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyDict>);

/// A batch of n episodes, stepped together.
#[pyclass(module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Batch {
    batch: babble_env::Batch<ReachTask>,
    terms: usize,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (task, num_envs=1, *, autoreset="Disabled", threads=1))]
    fn new(task: &Task, num_envs: usize, autoreset: &str, threads: usize) -> PyResult<Self> {
        let make = || {
            let autoreset = autoreset.parse::<Autoreset>()?;
            babble_env::Batch::new(task.task.clone(), num_envs, autoreset, threads)
        };
        let terms = task.task.spec().reward_terms.len();
        Ok(Self {
            batch: make().map_err(errors::env)?,
            terms,
        })
    }

    /// Starts the stream of cases of environment `i` anew.
    fn seed(&mut self, i: usize, seed: u64) -> PyResult<()> {
        self.batch.seed(i, seed).map_err(errors::env)
    }

    /// What the following resets of environment `i` ask of their cases; None is drawn.
    ///
    /// `obstacle` is (x, y, radius) \[m\]; `no_obstacle` asks that there is none.
    #[pyo3(signature = (i, start=None, target=None, obstacle=None, no_obstacle=false))]
    fn request(
        &mut self,
        i: usize,
        start: Option<[f64; 2]>,
        target: Option<[f64; 2]>,
        obstacle: Option<[f64; 3]>,
        no_obstacle: bool,
    ) -> PyResult<()> {
        let obstacle = match obstacle {
            _ if no_obstacle => ObstacleRequest::Absent,
            Some(obstacle) => ObstacleRequest::At(convert::obstacle(obstacle)),
            None => ObstacleRequest::Halfway,
        };
        self.batch
            .request(
                i,
                CaseRequest {
                    start,
                    target,
                    obstacle,
                },
            )
            .map_err(errors::env)
    }

    /// Begins new episodes where `mask` is true; in all environments without one.
    #[pyo3(signature = (mask=None))]
    fn reset(&mut self, py: Python<'_>, mask: Option<Vec<bool>>) -> PyResult<()> {
        let mask = mask.unwrap_or_else(|| vec![true; self.batch.len()]);
        if mask.len() != self.batch.len() {
            return Err(errors::env(EnvError::OutOfBounds {
                option: "reset_mask",
                value: format!("{} numbers", mask.len()),
                bound: format!("of length {}", self.batch.len()),
            }));
        }
        py.detach(|| self.batch.reset(&mask)).map_err(errors::env)
    }

    /// One step of all environments; `actions` holds two numbers for each.
    fn step(&mut self, py: Python<'_>, actions: PyReadonlyArrayDyn<'_, f32>) -> PyResult<()> {
        let actions: Vec<f32> = actions.as_array().iter().copied().collect();
        py.detach(|| self.batch.step(&actions)).map_err(errors::env)
    }

    /// One step of a batch of one, without letting go of the interpreter, as it takes microseconds.
    fn step_one(&mut self, actions: PyReadonlyArrayDyn<'_, f32>) -> PyResult<()> {
        match actions.as_slice() {
            Ok(actions) => self.batch.step(actions),
            Err(_) => self
                .batch
                .step(&actions.as_array().iter().copied().collect::<Vec<_>>()),
        }
        .map_err(errors::env)
    }

    /// What environment 0 showed last: (senses (11,), reward, terminated, truncated, outcome code,
    /// `is_success`, `ever_success`, reward terms).
    fn one<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let Some(record) = self.batch.records().next() else {
            return Ok(PyTuple::empty(py));
        };
        let step = &record.step;
        (
            PyArray1::from_slice(py, &record.senses),
            step.reward,
            step.terminated,
            step.truncated,
            record.standing.outcome as usize,
            record.standing.facts[IS_SUCCESS],
            record.standing.facts[EVER_SUCCESS],
            PyTuple::new(py, &step.terms[..self.terms])?,
        )
            .into_pyobject(py)
    }

    /// Achieved and desired goal of environment 0 (2,) \[m\].
    fn one_goals<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f32>>> {
        let record = self.batch.records().next();
        record.map_or_else(Vec::new, |r| {
            [r.standing.achieved, r.standing.desired]
                .map(|x| PyArray1::from_slice(py, &x))
                .into()
        })
    }

    /// What all environments showed last, in new arrays of length n: senses, achieved goals, desired
    /// goals, rewards, terminated, truncated, outcome codes, `is_success`, `ever_success`, terms.
    fn all<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let records: Vec<&Record> = self.batch.records().collect();
        self.arrays(py, &records)
    }

    /// The same for the episodes that ended within the last step and were begun anew, and their
    /// indices; None if there are none.
    fn ended<'py>(&self, py: Python<'py>) -> PyResult<Option<Ended<'py>>> {
        let ended: Vec<(usize, &Record)> = self
            .batch
            .last()
            .enumerate()
            .filter_map(|(i, last)| Some((i, &last?.record)))
            .collect();
        if ended.is_empty() {
            return Ok(None);
        }
        let (indices, records): (Vec<usize>, Vec<&Record>) = ended.into_iter().unzip();
        Ok(Some((
            PyArray1::from_vec(py, indices),
            self.arrays(py, &records)?,
        )))
    }

    /// Bytes from which environment `i` continues bit for bit.
    fn save<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.batch.save(i).map_err(errors::env)?))
    }

    /// Continues environment `i` from bytes.
    fn load(&mut self, i: usize, bytes: &[u8]) -> PyResult<()> {
        self.batch.load(i, bytes).map_err(errors::env)
    }

    /// A number that two states share only if they are the same to the bit.
    fn state_hash(&self, i: usize) -> PyResult<u64> {
        let hash = |state| snapshot::hash(&**self.batch.task(), state);
        self.batch.state(i).and_then(hash).map_err(errors::env)
    }

    /// Start, target and obstacle of environment `i`.
    fn case<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyDict>> {
        convert::case(py, &self.batch.state(i).map_err(errors::env)?.case)
    }

    /// Joint angles (2,) \[rad\] of environment `i`.
    fn posture(&self, i: usize) -> PyResult<[f64; 2]> {
        Ok(self.batch.state(i).map_err(errors::env)?.arm.q)
    }

    /// Recorded ways of the fingertip of environment `i` (k, 2) \[m\].
    fn trail<'py>(&self, py: Python<'py>, i: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.batch.state(i).map_err(errors::env)?;
        let arm = &self.batch.task().arm;
        let tips: Vec<[f64; 2]> = state
            .trail
            .iter()
            .map(|&q| arm.fingertip(q).into())
            .collect();
        convert::array2(py, &tips)
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
        let draw = || {
            let state = self.batch.state(i)?;
            self.batch
                .task()
                .picture(state, camera.parse::<View>()?, [width, height], frame)
        };
        let image = py.detach(draw).map_err(errors::env)?;
        PyArray1::from_vec(py, image.into_raw()).reshape([height as usize, width as usize, 3])
    }

    /// The eye's last image (size, size, 3) of the episode that environment `i` ended within the last
    /// step, if it was begun anew.
    fn retina_ended<'py>(
        &self,
        py: Python<'py>,
        i: usize,
        size: u32,
    ) -> PyResult<Option<Bound<'py, PyArray3<u8>>>> {
        let Some(last) = self.batch.last().nth(i).flatten() else {
            return Ok(None);
        };
        let task = self.batch.task();
        let draw = || task.picture(&last.state, View::Eye, [size; 2], None);
        let image = py.detach(draw).map_err(errors::env)?;
        let shape = [size as usize, size as usize, 3];
        PyArray1::from_vec(py, image.into_raw())
            .reshape(shape)
            .map(Some)
    }

    /// Threads that step the batch.
    #[getter]
    fn threads(&self) -> usize {
        self.batch.threads()
    }
}

impl Batch {
    fn arrays<'py>(&self, py: Python<'py>, records: &[&Record]) -> PyResult<Bound<'py, PyDict>> {
        let each = || records.iter();
        let terms: Vec<f64> = each()
            .flat_map(|r| r.step.terms[..self.terms].iter().copied())
            .collect();
        let dict = PyDict::new(py);
        let senses: Vec<&[f32]> = each().map(|r| &r.senses[..]).collect();
        let senses = PyArray1::from_vec(py, senses.concat());
        dict.set_item(
            "senses",
            senses.reshape([records.len(), self.batch.task().senses_len()])?,
        )?;
        dict.set_item(
            "achieved_goal",
            convert::array2(py, &each().map(|r| r.standing.achieved).collect::<Vec<_>>())?,
        )?;
        dict.set_item(
            "desired_goal",
            convert::array2(py, &each().map(|r| r.standing.desired).collect::<Vec<_>>())?,
        )?;
        dict.set_item(
            "reward",
            PyArray1::from_iter(py, each().map(|r| r.step.reward)),
        )?;
        dict.set_item(
            "terminated",
            PyArray1::from_iter(py, each().map(|r| r.step.terminated)),
        )?;
        dict.set_item(
            "truncated",
            PyArray1::from_iter(py, each().map(|r| r.step.truncated)),
        )?;
        dict.set_item(
            "outcome",
            PyArray1::from_iter(py, each().map(|r| r.standing.outcome as usize)),
        )?;
        dict.set_item(
            "is_success",
            PyArray1::from_iter(py, each().map(|r| r.standing.facts[IS_SUCCESS])),
        )?;
        dict.set_item(
            "ever_success",
            PyArray1::from_iter(py, each().map(|r| r.standing.facts[EVER_SUCCESS])),
        )?;
        dict.set_item(
            "terms",
            PyArray1::from_vec(py, terms).reshape([records.len(), self.terms])?,
        )?;
        Ok(dict)
    }
}
