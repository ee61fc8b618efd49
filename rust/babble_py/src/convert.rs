//! Between Python's and Rust's values.

use babble_env::task::{Request, State};
use babble_env::{EnvError, Task};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// What each task says in dicts and arrays of its own.
pub(crate) trait PyTask: Task {
    /// What a dict asks of the cases to come; what it does not have is drawn.
    fn request(asked: &Bound<'_, PyDict>) -> PyResult<Request<Self>>;

    /// The case as the dict that `reset(options=...)` takes.
    fn case<'py>(py: Python<'py>, state: &State<Self>) -> PyResult<Bound<'py, PyDict>>;

    /// The recorded way of the hand, one row a control step \[m\].
    fn trail<'py>(
        &self,
        py: Python<'py>,
        state: &State<Self>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>>;
}

/// A value as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(value)
        .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))
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

/// A (n, width) array of n rows.
pub(crate) fn table<'py, 'a, T: numpy::Element + Copy + 'a>(
    py: Python<'py>,
    width: usize,
    rows: impl ExactSizeIterator<Item = &'a [T]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let n = rows.len();
    let mut all = Vec::with_capacity(n * width);
    rows.for_each(|row| all.extend_from_slice(row));
    PyArray1::from_vec(py, all).reshape([n, width])
}
