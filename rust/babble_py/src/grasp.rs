//! The grasping task: everything that needs no episode.

use std::sync::Arc;

use babble_agent::grasp::holding;
use babble_body::Obstacle;
use babble_env::tasks::grasp;
use babble_env::tasks::grasp::{GraspState, Region, goal_reward, protocol};
use babble_env::{Config, Control, GraspCase, GraspOptions, Reward, Task as _};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{self, PyTask};
use crate::{errors, reach, signals};

/// The grasping task: a config and the choices made with it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct GraspTask {
    pub(crate) task: Arc<babble_env::GraspTask>,
}

#[pymethods]
impl GraspTask {
    #[new]
    #[expect(
        clippy::too_many_arguments,
        reason = "keyword arguments, as Python has them"
    )]
    #[pyo3(signature = (config, *, control="delta_posture", reward="progress", goal=false, region="palm_side", enclosure_reflex=false, max_episode_steps=None, record=false))]
    fn new(
        config: &str,
        control: &str,
        reward: &str,
        goal: bool,
        region: &str,
        enclosure_reflex: bool,
        max_episode_steps: Option<u32>,
        record: bool,
    ) -> PyResult<Self> {
        let make = || {
            let region = region.parse::<Region>()?;
            let options = GraspOptions {
                control: control.parse::<Control>()?,
                reward: reward.parse::<Reward>()?,
                goal,
                region,
                enclosure_reflex,
                max_episode_steps: max_episode_steps.unwrap_or(region.max_episode_steps()),
                record,
            };
            babble_env::GraspTask::new(Config::from_json(config)?, options)
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

    /// Lowest and highest equilibrium points of shoulder, elbow, thumb and finger (4, 2) \[rad\].
    #[getter]
    fn ranges(&self) -> [[f64; 2]; 4] {
        *self.task.robot.ranges()
    }

    /// Flexions that the enclosure reflex asks of thumb and fingers \[rad\].
    #[getter]
    fn reflex(&self) -> [f64; 2] {
        self.task.reflex()
    }

    /// Change of an equilibrium point by an action of 1 in `delta_posture` control \[rad\].
    #[getter]
    fn delta_posture(&self) -> f64 {
        self.task.config.grasp.delta_posture_deg.to_radians()
    }

    /// Observations, actions, reward terms, facts and outcomes, as JSON.
    fn spec(&self) -> PyResult<String> {
        convert::json(&self.task.spec())
    }

    /// Links of arm and hand, as JSON.
    fn robot(&self) -> PyResult<String> {
        convert::json(&self.task.robot.description())
    }

    /// Cases of a protocol: `table2`, `fig7` (None where the arm would begin in the object), or
    /// `random` ones of the task's region.
    fn cases<'py>(
        &self,
        py: Python<'py>,
        protocol: &str,
        n: usize,
        seed: u64,
        purpose: &str,
        threads: usize,
    ) -> PyResult<Vec<Option<Bound<'py, PyDict>>>> {
        let cases = match protocol {
            "table2" => py.detach(|| protocol::table2(&self.task)),
            "fig7" => py.detach(|| protocol::fig7(&self.task)),
            _ => {
                let purpose = reach::parse_purpose(purpose).map_err(errors::env)?;
                let draw =
                    || protocol::random(&self.task, n, seed, purpose, &mut signals::pool(threads)?);
                let drawn = py.detach(draw).map_err(errors::env)?;
                drawn.into_iter().map(Some).collect()
            }
        };
        let dict = |found: &Option<GraspCase>| found.as_ref().map(|c| case(py, c)).transpose();
        cases.iter().map(dict).collect()
    }

    /// Shoulder and elbow \[rad\] that bring the palm to an object (x, y) of a radius \[m\]; None if
    /// the arm cannot.
    fn grasp_posture(&self, object: [f64; 2], radius: f64) -> Option<[f64; 2]> {
        self.task.grasp_posture(object, radius)
    }

    /// Point (x, y) \[m\] of the arm's plane that an eye posture (pan and tilt over their ranges) looks
    /// at; None if it does not look down.
    fn looked_at(&self, eye: [f64; 2]) -> Option<[f64; 2]> {
        let gaze = self.task.eye.from_normalised(eye);
        self.task.eye.target_in_plane(gaze, 0.0)
    }

    /// How many of `n` objects of a diameter \[m\] the reflex holds through 10 s of arm motion without
    /// support; how deep it was pressed in at most \[m\]; mean flexions of thumb and finger \[rad\].
    fn hold(
        &self,
        py: Python<'_>,
        diameter: f64,
        n: usize,
        threads: usize,
    ) -> PyResult<(usize, f64, [f64; 2])> {
        let trials = py
            .detach(|| holding::trials(&self.task, diameter, n, &mut signals::pool(threads)?))
            .map_err(errors::env)?;
        let mean = |i: usize| trials.iter().map(|t| t.flexion[i]).sum::<f64>() / n as f64;
        Ok((
            trials.iter().filter(|trial| trial.held).count(),
            trials.iter().map(|t| t.penetration).fold(0.0, f64::max),
            [mean(0), mean(1)],
        ))
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

impl PyTask for babble_env::GraspTask {
    fn request(asked: &Bound<'_, PyDict>) -> PyResult<grasp::GraspRequest> {
        let pair = |name| -> PyResult<Option<[f64; 2]>> {
            asked.get_item(name)?.map_or(Ok(None), |x| x.extract())
        };
        let obstacle = asked.get_item("obstacle")?;
        let obstacle = obstacle.map_or(Ok(None), |x| x.extract::<Option<[f64; 3]>>())?;
        let diameter = asked.get_item("diameter")?;
        Ok(grasp::GraspRequest {
            start: pair("start")?,
            object: pair("object")?,
            diameter: diameter.map_or(Ok(None), |x| x.extract())?,
            goal: pair("goal")?,
            obstacle: obstacle.map(|[x, y, radius]| Obstacle {
                centre: [x, y].into(),
                radius,
            }),
        })
    }

    fn case<'py>(py: Python<'py>, state: &GraspState) -> PyResult<Bound<'py, PyDict>> {
        case(py, &state.case)
    }

    fn trail<'py>(
        &self,
        py: Python<'py>,
        state: &GraspState,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let palms: Vec<[f64; 2]> = state.trail.iter().map(|m| m.palm).collect();
        convert::array2(py, &palms)
    }
}

/// A case as the dict that `reset(options=...)` takes.
fn case<'py>(py: Python<'py>, case: &GraspCase) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("start", (case.start[0], case.start[1]))?;
    dict.set_item("object", (case.object[0], case.object[1]))?;
    dict.set_item("diameter", case.diameter)?;
    if let Some([x, y]) = case.goal {
        dict.set_item("goal", (x, y))?;
    }
    let obstacle = case.obstacle.map(|o| (o.centre.x, o.centre.y, o.radius));
    dict.set_item("obstacle", obstacle)?;
    Ok(dict)
}
