//! A learned agent as a safetensors file: weights and averages as tensors, all else as JSON.

use babble_env::Config;
use babble_env::tasks::reach::movement::Fidelity;
use serde::{Deserialize, Serialize};

use crate::error::AgentError;
use crate::hebb::{Hebb, HebbConfig};
use crate::tensors;

const KEY: &str = "gym_babble";
const VERSION: u32 = 1;
/// What is known of an agent beside its weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metadata {
    /// Version of this format.
    version: u32,
    /// Numbers of maps and rule.
    pub agent: HebbConfig,
    /// Body and task that it was babbled on.
    pub config: Config,
    /// Seed of its babbling.
    pub seed: u64,
    /// Whether movements were simulated without the muscles' lag.
    pub quasi_static: bool,
    /// Movements babbled.
    pub movements: u64,
    /// How many of them were legal.
    pub legal: u64,
}

impl Metadata {
    /// Metadata in the format's current version.
    #[must_use]
    pub fn new(
        agent: HebbConfig,
        config: Config,
        seed: u64,
        fidelity: Fidelity,
        movements: u64,
        legal: u64,
    ) -> Self {
        let quasi_static = matches!(fidelity, Fidelity::QuasiStatic);
        Self {
            version: VERSION,
            agent,
            config,
            seed,
            quasi_static,
            movements,
            legal,
        }
    }
}

/// The file's bytes.
///
/// # Errors
/// [`AgentError::File`] if the agent cannot be written.
pub fn save(hebb: &Hebb, metadata: &Metadata) -> Result<Vec<u8>, AgentError> {
    tensors::write(KEY, metadata, &tensors::of("", hebb.weights()))
}

/// The agent in a file's bytes.
///
/// # Errors
/// [`AgentError::File`] for bytes that are cut short, not an agent, or of another version;
/// [`AgentError`] for weights that do not fit their maps.
pub fn load(bytes: &[u8]) -> Result<(Hebb, Metadata), AgentError> {
    let (metadata, values): (Metadata, _) = tensors::read(KEY, bytes, &tensors::names(""))?;
    tensors::check_version(metadata.version, VERSION)?;
    metadata.config.validate()?;
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let hebb = Hebb::from_parts(metadata.agent.clone(), next(), next(), next())?;
    Ok((hebb, metadata))
}
