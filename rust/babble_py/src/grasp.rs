//! What is made for grasping alone: postures, and how well the reflex holds.

use babble_agent::grasp::holding::{self, Holding};
use babble_env::{GraspTask, snapshot};
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

/// Whether the hand of an episode's state keeps its object without support while the arm moves for so
/// many seconds to random postures.
#[pyfunction]
pub(crate) fn keeps(task: &Task, state: &[u8], seconds: f64, seed: u64) -> PyResult<bool> {
    let task = task.downcast::<GraspTask>()?;
    let kept = snapshot::load(&*task, state)
        .and_then(|state| holding::keeps(&task, &state, seconds, seed));
    kept.map_err(errors::env)
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
    let Holding {
        held,
        penetration,
        flexion,
    } = Holding::of(&trials);
    Ok((held, penetration, flexion))
}
