//! What is made for grasping alone: postures, gazes, and how well the reflex holds.

use babble_agent::grasp::holding;
use babble_env::GraspTask;
use pyo3::prelude::*;

use crate::task::Task;
use crate::{errors, signals};

/// Shoulder and elbow \[rad\] that bring the palm to an object (x, y) of a radius \[m\]; None if
/// the arm cannot.
#[pyfunction]
pub(crate) fn grasp_posture(
    task: &Task,
    object: [f64; 2],
    radius: f64,
) -> PyResult<Option<[f64; 2]>> {
    let task = task.downcast::<GraspTask>()?;
    Ok(task.grasp_posture(object, radius))
}

/// Point (x, y) \[m\] of the arm's plane that an eye posture (pan and tilt over their ranges) looks
/// at; None if it does not look down.
#[pyfunction]
pub(crate) fn looked_at(task: &Task, eye: [f64; 2]) -> PyResult<Option<[f64; 2]>> {
    let task = task.downcast::<GraspTask>()?;
    let gaze = task.eye.from_normalised(eye);
    Ok(task.eye.target_in_plane(gaze, 0.0))
}

/// How many of `n` objects of a diameter \[m\] the reflex holds through 10 s of arm motion without
/// support; how deep it was pressed in at most \[m\]; mean flexions of thumb and finger \[rad\].
#[pyfunction]
pub(crate) fn hold(
    task: &Task,
    py: Python<'_>,
    diameter: f64,
    n: usize,
    threads: usize,
) -> PyResult<(usize, f64, [f64; 2])> {
    let task = task.downcast::<GraspTask>()?;
    let trials = py
        .detach(|| holding::trials(&task, diameter, n, &mut signals::executor(threads)?))
        .map_err(errors::env)?;
    let mean = |i: usize| trials.iter().map(|t| t.flexion[i]).sum::<f64>() / n as f64;
    Ok((
        trials.iter().filter(|trial| trial.held).count(),
        trials.iter().map(|t| t.penetration).fold(0.0, f64::max),
        [mean(0), mean(1)],
    ))
}
