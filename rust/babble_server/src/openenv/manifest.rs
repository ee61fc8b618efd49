//! `openenv.yaml`, with which OpenEnv's tools find the environment and check it.

use crate::fault::Fault;
use crate::limits::Limits;
use crate::session::Session;

use super::Served;

/// Times that an episode may take beyond simulated time, for a client that thinks about its actions.
const PATIENCE: f64 = 10.0;

/// The manifest of what is served.
///
/// # Errors
/// [`Fault`] for options that the environment does not have.
pub fn manifest(served: &Served) -> Result<String, Fault> {
    let session = Session::make(&served.make(), &Limits::default(), 1)?;
    let spec = &session.spec;
    let [low, high] = spec.reward_bounds;
    let episode_s = f64::from(spec.max_episode_steps) / spec.control_hz;
    Ok(format!(
        "\
# Made by `gym-babble-server openenv-yaml`.
spec_version: 1
name: {name}
version: {version}
type: space
runtime: docker
port: 8000
validation:
  reward:
    # Bounds of the reward of one step.
    range: [{low:?}, {high:?}]
    floor_margin: 0.1
  resources:
    cpu: 1.0
    memory_mb: 256
    disk_mb: 64
    episode_timeout_s: {timeout:?}
  capabilities:
    verifier:
      kind: reward_channel
  types:
    tags: [robotics, {task}]
",
        name = session.env,
        version = env!("CARGO_PKG_VERSION"),
        task = session.entry.name,
        timeout = PATIENCE * episode_s,
    ))
}
