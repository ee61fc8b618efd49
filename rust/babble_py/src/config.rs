//! Configs as JSON, and names.

use std::path::PathBuf;

use babble_env::{Config, Outcome, config};
use pyo3::prelude::*;

use crate::errors;

/// Names of the body profiles.
#[pyfunction]
pub(crate) fn profiles() -> Vec<&'static str> {
    config::PROFILES.to_vec()
}

/// The config of a profile, as JSON.
#[pyfunction]
pub(crate) fn profile_config(name: &str) -> PyResult<String> {
    Config::profile(name)
        .and_then(|config| config.to_json())
        .map_err(errors::env)
}

/// The config in a TOML or JSON file, completed and checked, as JSON.
#[pyfunction]
pub(crate) fn load_config(path: PathBuf) -> PyResult<String> {
    Config::from_file(&path)
        .and_then(|config| config.to_json())
        .map_err(errors::env)
}

/// A JSON config, completed from its profile and checked.
#[pyfunction]
pub(crate) fn complete_config(text: &str) -> PyResult<String> {
    Config::from_json(text)
        .and_then(|config| config.to_json())
        .map_err(errors::env)
}

/// Names of the outcomes of all tasks, in the order of their codes.
#[pyfunction]
pub(crate) fn outcomes() -> Vec<&'static str> {
    Outcome::ALL.iter().map(|outcome| outcome.name()).collect()
}

/// Processors that this process may use: by its affinity, and by a container's quota.
#[pyfunction]
pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
