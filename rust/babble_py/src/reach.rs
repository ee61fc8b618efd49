//! What is made for reaching alone: postures and movements.

use babble_body::Obstacle;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::{ReachCase, ReachTask};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::task::Task;
use crate::{convert, errors};

/// Posture \[rad\] that puts the fingertip at a point \[m\]; None if it is out of reach.
#[pyfunction]
pub(crate) fn posture_at(task: &Task, point: [f64; 2]) -> PyResult<Option<[f64; 2]>> {
    Ok(task.downcast::<ReachTask>()?.arm.posture_at(point.into()))
}

/// One whole movement with parameters `b` from `start` to `target`.
///
/// Returns outcome, time \[s\], the way of the fingertip (k, 2) \[m\], the postures (k, 2) \[rad\]
/// and the desired way (T/dt, 2) \[m\].
#[pyfunction]
#[pyo3(signature = (task, start, target, obstacle, b, *, quasi_static=false))]
pub(crate) fn movement<'py>(
    task: &Task,
    py: Python<'py>,
    start: [f64; 2],
    target: [f64; 2],
    obstacle: Option<[f64; 3]>,
    b: [f64; 2],
    quasi_static: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let task = &*task.downcast::<ReachTask>()?;
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
#[pyfunction]
pub(crate) fn place<'py>(
    task: &Task,
    py: Python<'py>,
    posture: [f64; 2],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let placement = task.downcast::<ReachTask>()?.arm.place(posture);
    convert::array2(py, &[placement.elbow.into(), placement.tip.into()])
}

/// An obstacle from (x, y, radius) \[m\].
fn obstacle_from([x, y, radius]: [f64; 3]) -> Obstacle {
    Obstacle {
        centre: [x, y].into(),
        radius,
    }
}

/// How a movement is simulated.
const fn fidelity(quasi_static: bool) -> Fidelity {
    if quasi_static {
        Fidelity::QuasiStatic
    } else {
        Fidelity::Full
    }
}
