//! What is made for reaching alone: movements, and the reference agents of reaching.

use babble_agent::reference;
use babble_body::Obstacle;
use babble_env::tasks::reach::SENSES;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::{EnvError, ReachCase, ReachTask};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::task::Task;
use crate::{convert, errors, signals};

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

/// The b (n, 2) of a bulge towards the shoulder, for senses (n, 11).
#[pyfunction]
pub(crate) fn scripted<'py>(
    task: &Task,
    py: Python<'py>,
    senses: PyReadonlyArray2<'py, f32>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    choose(task, py, &senses, 1, |_, case| {
        Ok(reference::scripted(case))
    })
}

/// The b (n, 2) of a movement that succeeds, found by trying, for senses (n, 11).
#[pyfunction]
pub(crate) fn oracle<'py>(
    task: &Task,
    py: Python<'py>,
    senses: PyReadonlyArray2<'py, f32>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    choose(task, py, &senses, threads, reference::oracle)
}

/// Equilibrium points of whole movements (n, steps, 2), as shares of the joint ranges.
#[pyfunction]
pub(crate) fn plan<'py>(
    task: &Task,
    py: Python<'py>,
    senses: PyReadonlyArray2<'py, f32>,
    b: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, numpy::PyArray3<f32>>> {
    use numpy::PyArrayMethods;
    let (senses, b) = (rows_of_senses(&senses)?, convert::rows::<f64, 2>(&b, "b")?);
    let task = &*task.downcast::<ReachTask>()?;
    let steps = task.config.reach.movement_steps();
    let plans = || {
        let mut all = Vec::with_capacity(senses.len() * steps);
        signals::executor(1)?.in_turn(senses.iter().zip(&b), |_, (senses, b)| {
            let case = reference::case_from_senses(task, senses)?;
            all.extend(reference::plan(task, &case, *b)?);
            Ok(())
        })?;
        Ok(all)
    };
    let all: Vec<[f32; 2]> = py.detach(plans).map_err(errors::env)?;
    PyArray1::from_slice(py, all.as_flattened()).reshape([senses.len(), steps, 2])
}

fn choose<'py>(
    task: &Task,
    py: Python<'py>,
    senses: &PyReadonlyArray2<'py, f32>,
    threads: usize,
    choose: impl Fn(&ReachTask, &ReachCase) -> Result<[f64; 2], EnvError> + Sync,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let senses = rows_of_senses(senses)?;
    let task = &*task.downcast::<ReachTask>()?;
    let one = |senses: &[f32; SENSES]| choose(task, &reference::case_from_senses(task, senses)?);
    let chosen: Vec<[f64; 2]> = py
        .detach(|| {
            signals::executor(threads)?.run_until(|stop| {
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
