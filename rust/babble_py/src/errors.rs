//! The one place where Rust errors become Python exceptions.

use babble_agent::AgentError;
use babble_brain::BrainError;
use babble_env::EnvError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyErr, import_exception};

use crate::signals;

import_exception!(gym_babble.errors, ActionError);
import_exception!(gym_babble.errors, AgentFileError);
import_exception!(gym_babble.errors, BusyError);
import_exception!(gym_babble.errors, ConfigError);
import_exception!(gym_babble.errors, ScenarioError);
import_exception!(gym_babble.errors, SnapshotError);
import_exception!(gymnasium.error, ResetNeeded);

/// The Python exception for an error of the environment.
pub(crate) fn env(error: EnvError) -> PyErr {
    let text = error.to_string();
    match error {
        EnvError::ActionNotFinite { .. } | EnvError::ActionShape { .. } => {
            ActionError::new_err(text)
        }
        EnvError::NeedsReset { .. } => ResetNeeded::new_err(text),
        EnvError::Case { .. }
        | EnvError::CaseValue { .. }
        | EnvError::NoLegalCase { .. }
        | EnvError::NoGraspCase { .. } => ScenarioError::new_err(text),
        EnvError::Snapshot { .. } => SnapshotError::new_err(text),
        EnvError::Interrupted => signals::raised(),
        EnvError::Threads { .. } => PyRuntimeError::new_err(text),
        _ => ConfigError::new_err(text),
    }
}

/// The Python exception for an error of an agent.
pub(crate) fn agent(error: AgentError) -> PyErr {
    match error {
        AgentError::Env(error) => env(error),
        AgentError::File { .. } => AgentFileError::new_err(error.to_string()),
        AgentError::NothingToLearn { .. } => ScenarioError::new_err(error.to_string()),
        _ => ConfigError::new_err(error.to_string()),
    }
}

/// The Python exception for an error of maps, rule or generators.
pub(crate) fn brain(error: BrainError) -> PyErr {
    ConfigError::new_err(error.to_string())
}
