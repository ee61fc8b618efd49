//! Agents' files: named arrays and JSON.

use babble_agent::tensors::{self, Tensor};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors;

/// The bytes of a safetensors file with arrays by name, and a JSON object `json` under `key`.
#[pyfunction]
pub(crate) fn write_tensors<'py>(
    py: Python<'py>,
    key: &str,
    json: &str,
    arrays: Vec<(String, PyReadonlyArrayDyn<'py, f32>)>,
) -> PyResult<Bound<'py, PyBytes>> {
    let value: serde_json::Value = serde_json::from_str(json)
        .map_err(|error| errors::ConfigError::new_err(format!("json: {error}")))?;
    let owned: Vec<_> = arrays
        .iter()
        .map(|(name, array)| {
            let array = array.as_array();
            let values: Vec<f32> = array.iter().copied().collect();
            (name.clone(), array.shape().to_vec(), values)
        })
        .collect();
    let parts: Vec<_> = owned
        .iter()
        .map(|(name, shape, values)| Tensor {
            name: name.clone(),
            shape: shape.clone(),
            values,
        })
        .collect();
    let bytes = tensors::write(key, &value, &parts).map_err(errors::agent)?;
    Ok(PyBytes::new(py, &bytes))
}

/// The JSON under `key` and the arrays of that `names` in a file's bytes.
#[pyfunction]
pub(crate) fn read_tensors<'py>(
    py: Python<'py>,
    key: &str,
    bytes: &[u8],
    names: Vec<String>,
) -> PyResult<(String, Bound<'py, PyDict>)> {
    let (json, values) = tensors::read(key, bytes, &names).map_err(errors::agent)?;
    let dict = PyDict::new(py);
    for (name, (shape, values)) in names.iter().zip(values) {
        let array: Bound<'_, PyArrayDyn<f32>> = PyArray1::from_vec(py, values).reshape(shape)?;
        dict.set_item(name, array)?;
    }
    Ok((json, dict))
}

/// What the texts in a file's header are called.
#[pyfunction]
pub(crate) fn tensor_keys(bytes: &[u8]) -> PyResult<Vec<String>> {
    tensors::keys(bytes).map_err(errors::agent)
}
