//! The reaching task: everything that needs no episode.

use std::sync::Arc;

use babble_agent::reference;
use babble_body::{Obstacle, description};
use babble_env::tasks::reach::case::{CaseRequest, ObstacleRequest};
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::{ReachState, SENSES, goal_reward, protocol};
use babble_env::{Config, Control, EnvError, Options, Purpose, ReachCase, Reward, Task as _};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::convert::{self, PyTask};
use crate::{errors, signals};

/// The reaching task: a config and the choices made with it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct ReachTask {
    pub(crate) task: Arc<babble_env::ReachTask>,
}

#[pymethods]
impl ReachTask {
    #[new]
    #[pyo3(signature = (config, *, control="delta_posture", reward="progress", goal=false, settled=false, max_episode_steps=240, record=false))]
    fn new(
        config: &str,
        control: &str,
        reward: &str,
        goal: bool,
        settled: bool,
        max_episode_steps: u32,
        record: bool,
    ) -> PyResult<Self> {
        let make = || {
            let options = Options {
                control: control.parse::<Control>()?,
                reward: reward.parse::<Reward>()?,
                goal,
                settled,
                max_episode_steps,
                record,
            };
            babble_env::ReachTask::new(Config::from_json(config)?, options)
        };
        Ok(Self {
            task: Arc::new(make().map_err(errors::env)?),
        })
    }

    /// The complete config, as JSON.
    fn config(&self) -> PyResult<String> {
        self.task.config.to_json().map_err(errors::env)
    }

    /// Radius of the config's obstacle \[m\].
    #[getter]
    fn obstacle_radius(&self) -> f64 {
        self.task.config.body.obstacle.radius_m
    }

    /// Widths of the joint ranges \[rad\].
    #[getter]
    fn joint_range(&self) -> [f64; 2] {
        let arm = &self.task.arm;
        [0, 1].map(|i| arm.upper_limit[i] - arm.lower[i])
    }

    /// Change of an equilibrium point by an action of 1 in `delta_posture` control \[rad\].
    #[getter]
    fn delta_posture(&self) -> f64 {
        self.task.config.reach.delta_posture_deg.to_radians()
    }

    /// Lowest and highest b1 and b2.
    #[getter]
    fn b_range(&self) -> [f64; 2] {
        self.task.config.reach.b_range
    }

    /// Observations, actions, reward terms and outcomes, as JSON.
    fn spec(&self) -> PyResult<String> {
        convert::json(&self.task.spec())
    }

    /// Links of arm and hand, as JSON.
    fn robot(&self) -> PyResult<String> {
        convert::json(&description::reaching(&self.task.config.body))
    }

    /// Posture \[rad\] that puts the fingertip at a point \[m\]; None if it is out of reach.
    fn posture_at(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        self.task.arm.posture_at(point.into())
    }

    /// Cases of Table I: `n` legal movements of the full simulation.
    #[pyo3(signature = (n, seed, purpose, threads))]
    fn table1<'py>(
        &self,
        py: Python<'py>,
        n: usize,
        seed: u64,
        purpose: &str,
        threads: usize,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let purpose = parse_purpose(purpose).map_err(errors::env)?;
        let cases = py
            .detach(|| protocol::table1(&self.task, n, seed, purpose, &mut signals::pool(threads)?))
            .map_err(errors::env)?;
        cases.iter().map(|case| case_dict(py, case)).collect()
    }

    /// Cases of Fig. 4: 4 targets × 36 starts, None where there is no case.
    fn fig4<'py>(&self, py: Python<'py>) -> PyResult<Vec<Option<Bound<'py, PyDict>>>> {
        let cases = py.detach(|| protocol::fig4(&self.task));
        cases
            .iter()
            .map(|case| case.as_ref().map(|case| case_dict(py, case)).transpose())
            .collect()
    }

    /// One whole movement with parameters `b` from `start` to `target`.
    ///
    /// Returns outcome, time \[s\], the way of the fingertip (k, 2) \[m\], the postures (k, 2) \[rad\]
    /// and the desired way (T/dt, 2) \[m\].
    #[pyo3(signature = (start, target, obstacle, b, *, quasi_static=false))]
    fn movement<'py>(
        &self,
        py: Python<'py>,
        start: [f64; 2],
        target: [f64; 2],
        obstacle: Option<[f64; 3]>,
        b: [f64; 2],
        quasi_static: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let task = &self.task;
        let placed = obstacle.map(obstacle_from);
        let mut postures = Vec::new();
        let mut play = || {
            let case = ReachCase::chosen(task, start, target, placed)?;
            postures.push(case.start);
            let fidelity = fidelity(quasi_static);
            let movement = MovementPath::new(task, &case, b)?
                .play(task, &case, fidelity, |arm| postures.push(arm.q));
            Ok((movement, MovementPath::desired(task, &case, b)?))
        };
        let (movement, desired) = py.detach(&mut play).map_err(errors::env)?;
        let tips: Vec<[f64; 2]> = postures
            .iter()
            .map(|&q| task.arm.fingertip(q).into())
            .collect();
        let desired: Vec<[f64; 2]> = desired.into_iter().map(Into::into).collect();
        let dict = PyDict::new(py);
        dict.set_item("outcome", movement.outcome.name())?;
        dict.set_item("time", movement.time_s)?;
        dict.set_item("fingertip", convert::array2(py, &tips)?)?;
        dict.set_item("postures", convert::array2(py, &postures)?)?;
        dict.set_item("desired", convert::array2(py, &desired)?)?;
        Ok(dict)
    }

    /// Elbow and fingertip (2, 2) \[m\] for a posture \[rad\].
    fn place<'py>(
        &self,
        py: Python<'py>,
        posture: [f64; 2],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let placement = self.task.arm.place(posture);
        convert::array2(py, &[placement.elbow.into(), placement.tip.into()])
    }

    /// The b (n, 2) of a bulge towards the shoulder, for senses (n, 11).
    fn scripted<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.choose(py, &senses, 1, |_, case| Ok(reference::scripted(case)))
    }

    /// The b (n, 2) of a movement that succeeds, found by trying, for senses (n, 11).
    fn oracle<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.choose(py, &senses, threads, reference::oracle)
    }

    /// Equilibrium points of whole movements (n, steps, 2), as shares of the joint ranges.
    fn plan<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
        b: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, numpy::PyArray3<f32>>> {
        use numpy::PyArrayMethods;
        let (senses, b) = (rows_of_senses(&senses)?, convert::rows::<f64, 2>(&b, "b")?);
        let task = &self.task;
        let steps = task.config.reach.movement_steps();
        let plans = || {
            let mut all = Vec::with_capacity(senses.len() * steps);
            signals::pool(1)?.in_turn(senses.iter().zip(&b), |_, (senses, b)| {
                let case = reference::case_from_senses(task, senses)?;
                all.extend(reference::plan(task, &case, *b)?);
                Ok(())
            })?;
            Ok(all)
        };
        let all: Vec<[f32; 2]> = py.detach(plans).map_err(errors::env)?;
        PyArray1::from_slice(py, all.as_flattened()).reshape([senses.len(), steps, 2])
    }

    /// Reward of the goal form for rows of achieved and desired goals (n, 2) \[m\].
    fn goal_reward<'py>(
        &self,
        py: Python<'py>,
        achieved: PyReadonlyArray2<'py, f32>,
        desired: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let achieved = convert::rows::<f32, 2>(&achieved, "achieved_goal")?;
        let desired = convert::rows::<f32, 2>(&desired, "desired_goal")?;
        let rewards = achieved.iter().zip(&desired);
        Ok(PyArray1::from_iter(
            py,
            rewards.map(|(&a, &d)| goal_reward(&self.task.config, a, d)),
        ))
    }
}

impl ReachTask {
    fn choose<'py>(
        &self,
        py: Python<'py>,
        senses: &PyReadonlyArray2<'py, f32>,
        threads: usize,
        choose: impl Fn(&babble_env::ReachTask, &ReachCase) -> Result<[f64; 2], EnvError> + Sync,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let senses = rows_of_senses(senses)?;
        let task = &self.task;
        let one =
            |senses: &[f32; SENSES]| choose(task, &reference::case_from_senses(task, senses)?);
        let chosen: Vec<[f64; 2]> = py
            .detach(|| {
                signals::pool(threads)?.run_until(|stop| {
                    let unless_stopped = |senses| stop.check().and_then(|()| one(senses));
                    senses
                        .par_iter()
                        .map(unless_stopped)
                        .collect::<Result<_, _>>()
                })?
            })
            .map_err(errors::env)?;
        convert::array2(py, &chosen)
    }
}

impl PyTask for babble_env::ReachTask {
    /// From `start`, `target` (x, y) and `obstacle` (x, y, radius) or None \[m\]. Without the key
    /// `obstacle` it stands halfway, with None there is none.
    fn request(asked: &Bound<'_, PyDict>) -> PyResult<CaseRequest> {
        let point = |name| match asked.get_item(name)? {
            None => Ok(None),
            Some(x) => x.extract::<Option<[f64; 2]>>(),
        };
        let obstacle = match asked.get_item("obstacle")? {
            None => ObstacleRequest::Halfway,
            Some(x) => x
                .extract::<Option<[f64; 3]>>()?
                .map(obstacle_from)
                .map_or(ObstacleRequest::Absent, ObstacleRequest::At),
        };
        Ok(CaseRequest {
            start: point("start")?,
            target: point("target")?,
            obstacle,
        })
    }

    fn case<'py>(py: Python<'py>, state: &ReachState) -> PyResult<Bound<'py, PyDict>> {
        case_dict(py, &state.case)
    }

    fn trail<'py>(
        &self,
        py: Python<'py>,
        state: &ReachState,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let tip = |&q| self.arm.fingertip(q).into();
        convert::array2(py, &state.trail.iter().map(tip).collect::<Vec<[f64; 2]>>())
    }
}

/// A case as the dict that `reset(options=...)` takes: `start`, `target` (x, y) \[m\] and
/// `obstacle` (x, y, radius) \[m\] or None.
fn case_dict<'py>(py: Python<'py>, case: &ReachCase) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("start", (case.hand[0], case.hand[1]))?;
    dict.set_item("target", (case.target[0], case.target[1]))?;
    let obstacle = case.obstacle.map(|o| (o.centre.x, o.centre.y, o.radius));
    dict.set_item("obstacle", obstacle)?;
    Ok(dict)
}

/// An obstacle from (x, y, radius) \[m\].
fn obstacle_from([x, y, radius]: [f64; 3]) -> Obstacle {
    Obstacle {
        centre: [x, y].into(),
        radius,
    }
}

/// Rows of flat observations in a (n, 11) array.
pub(crate) fn rows_of_senses(array: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<[f32; SENSES]>> {
    let senses = convert::rows(array, "senses")?;
    match senses.iter().flatten().find(|x| !x.is_finite()) {
        Some(x) => Err(errors::env(EnvError::OutOfBounds {
            option: "senses",
            value: x.to_string(),
            bound: "finite".to_owned(),
        })),
        None => Ok(senses),
    }
}

/// How a movement is simulated.
pub(crate) const fn fidelity(quasi_static: bool) -> Fidelity {
    if quasi_static {
        Fidelity::QuasiStatic
    } else {
        Fidelity::Full
    }
}

pub(crate) fn parse_purpose(name: &str) -> Result<Purpose, EnvError> {
    match name {
        "learning" => Ok(Purpose::Learning),
        "validation" => Ok(Purpose::Validation),
        "test" => Ok(Purpose::Test),
        _ => Err(EnvError::Option {
            option: "split",
            value: name.to_owned(),
            known: "learning, validation, test".to_owned(),
        }),
    }
}
