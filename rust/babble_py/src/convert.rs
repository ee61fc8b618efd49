//! Between numpy arrays and Rust values.

use babble_body::Obstacle;
use babble_env::reach::SENSES;
use babble_env::{EnvError, ReachCase};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// Rows of flat observations in a (n, 11) array.
pub(crate) fn senses(array: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<[f32; SENSES]>> {
    let senses = rows(array, "senses")?;
    match senses.iter().flatten().find(|x| !x.is_finite()) {
        Some(x) => Err(errors::env(EnvError::OutOfBounds {
            option: "senses",
            value: x.to_string(),
            bound: "finite".to_owned(),
        })),
        None => Ok(senses),
    }
}

/// Rows of N numbers in a (n, N) array.
pub(crate) fn rows<T: numpy::Element + Copy, const N: usize>(
    array: &PyReadonlyArray2<'_, T>,
    what: &'static str,
) -> PyResult<Vec<[T; N]>> {
    let array = array.as_array();
    if array.ncols() != N {
        let error = EnvError::OutOfBounds {
            option: what,
            value: format!("an array of shape {:?}", array.shape()),
            bound: format!("of shape (n, {N})"),
        };
        return Err(errors::env(error));
    }
    Ok(array
        .rows()
        .into_iter()
        .map(|row| std::array::from_fn(|i| row[i]))
        .collect())
}

/// A (n, N) array of rows.
pub(crate) fn array2<'py, T: numpy::Element + Copy, const N: usize>(
    py: Python<'py>,
    rows: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), N])
}

/// A case as the dict that `reset(options=...)` takes: `start`, `target` (x, y) \[m\] and
/// `obstacle` (x, y, radius) \[m\] or None.
pub(crate) fn case<'py>(py: Python<'py>, case: &ReachCase) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("start", (case.hand[0], case.hand[1]))?;
    dict.set_item("target", (case.target[0], case.target[1]))?;
    let obstacle = case.obstacle.map(|o| (o.centre.x, o.centre.y, o.radius));
    dict.set_item("obstacle", obstacle)?;
    Ok(dict)
}

/// An obstacle from (x, y, radius) \[m\].
pub(crate) fn obstacle([x, y, radius]: [f64; 3]) -> Obstacle {
    Obstacle {
        centre: [x, y].into(),
        radius,
    }
}
