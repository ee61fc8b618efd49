//! Between Python's and Rust's values.

use babble_env::case::CasePart;
use babble_env::{CaseValue, CaseValues, EnvError};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyTuple};

use crate::errors;

/// A case as the dict that `reset(options=...)` takes.
pub(crate) fn case_dict<'py>(py: Python<'py>, case: &CaseValues) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in case.iter() {
        match value {
            CaseValue::Absent => dict.set_item(name, py.None())?,
            CaseValue::Flag(flag) => dict.set_item(name, flag)?,
            CaseValue::Number(number) => dict.set_item(name, number)?,
            CaseValue::Numbers(numbers) => dict.set_item(name, PyTuple::new(py, numbers)?)?,
        }
    }
    Ok(dict)
}

/// What a dict asks of the cases to come.
pub(crate) fn case_values(
    parts: &'static [CasePart],
    asked: &Bound<'_, PyDict>,
) -> PyResult<CaseValues> {
    let values: Vec<(String, CaseValue)> = asked
        .iter()
        .map(|(name, value)| {
            let value = if value.is_none() {
                CaseValue::Absent
            } else if let Ok(flag) = value.cast::<PyBool>() {
                // Before numbers, as Python's truth values are numbers too.
                CaseValue::Flag(flag.is_true())
            } else if let Ok(number) = value.extract() {
                CaseValue::Number(number)
            } else {
                CaseValue::Numbers(value.extract()?)
            };
            Ok((name.extract()?, value))
        })
        .collect::<PyResult<_>>()?;
    let named = values
        .iter()
        .map(|(name, value)| (name.as_str(), value.clone()));
    CaseValues::read(parts, named).map_err(errors::env)
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
    check_width(array.shape(), N, what)?;
    Ok(array
        .rows()
        .into_iter()
        .map(|row| std::array::from_fn(|i| row[i]))
        .collect())
}

/// Rows of `width` numbers in a (n, width) array.
pub(crate) fn wide_rows<T: numpy::Element + Copy>(
    array: &PyReadonlyArray2<'_, T>,
    width: usize,
    what: &'static str,
) -> PyResult<Vec<Vec<T>>> {
    let array = array.as_array();
    check_width(array.shape(), width, what)?;
    Ok(array.rows().into_iter().map(|row| row.to_vec()).collect())
}

pub(crate) fn check_width(shape: &[usize], width: usize, what: &'static str) -> PyResult<()> {
    if shape.last() == Some(&width) {
        return Ok(());
    }
    Err(errors::env(EnvError::OutOfBounds {
        option: what,
        value: format!("an array of shape {shape:?}"),
        bound: format!("of shape (n, {width})"),
    }))
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
