//! A learned agent of grasping as a safetensors file.

use babble_env::Config;
use serde::{Deserialize, Serialize};

use super::babbling::GraspBabbling;
use super::network::{GraspHebb, GraspHebbConfig};
use crate::error::AgentError;
use crate::tensors::{self, check_version};

const KEY: &str = "gym_babble.grasp";
const VERSION: u32 = 1;
const PREFIXES: [&str; 2] = ["reach.", "grasp."];

/// What is known of an agent beside its weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metadata {
    /// Version of this format.
    version: u32,
    /// Numbers of maps and rule.
    pub agent: GraspHebbConfig,
    /// Body and task that it was babbled on.
    pub config: Config,
    /// Seed of its babbling.
    pub seed: u64,
    /// Babbles made.
    pub babbles: u64,
    /// In how many of them the hand kept the object.
    pub kept: u64,
}

/// The file's bytes.
///
/// # Errors
/// [`AgentError::File`] if the agent cannot be written.
pub fn save(
    hebb: &GraspHebb,
    babbling: &GraspBabbling,
    config: Config,
) -> Result<Vec<u8>, AgentError> {
    let metadata = Metadata {
        version: VERSION,
        agent: hebb.config().clone(),
        config,
        seed: babbling.seed(),
        babbles: babbling.babbles(),
        kept: babbling.kept(),
    };
    let [reach, grasp] = PREFIXES;
    let parts = [
        tensors::of(reach, hebb.reach()),
        tensors::of(grasp, hebb.grasp()),
    ];
    tensors::write(KEY, &metadata, parts.as_flattened())
}

/// The agent in a file's bytes.
///
/// # Errors
/// [`AgentError::File`] for bytes that are cut short, altered, not such an agent, or of another
/// version; [`AgentError`] for weights that do not fit their maps.
pub fn load(bytes: &[u8]) -> Result<(GraspHebb, GraspBabbling, Config), AgentError> {
    let names = PREFIXES.map(tensors::names).concat();
    let (metadata, values): (Metadata, _) = tensors::read(KEY, bytes, &names)?;
    check_version(metadata.version, VERSION)?;
    metadata.config.validate()?;
    let mut values = values.into_iter();
    let mut three = || std::array::from_fn(|_| values.next().unwrap_or_default());
    let hebb = GraspHebb::from_parts(metadata.agent, three(), three())?;
    let babbling = GraspBabbling::resume(metadata.seed, metadata.babbles, metadata.kept);
    Ok((hebb, babbling, metadata.config))
}
