//! The state of an episode as bytes: magic, version, fingerprint of the task, state.

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::episode;
use crate::error::EnvError;
use crate::task::Task;

const VERSION: u16 = 3;

#[derive(Serialize, Deserialize)]
struct Header {
    magic: [u8; 4],
    version: u16,
    /// Hash of the task's fingerprint.
    task: u64,
    /// Hash of the state's bytes.
    body: u64,
}

/// Bytes of `state`.
///
/// # Errors
/// Never for a state of this crate; the serializer's signature has it.
pub fn save<T: Task>(task: &T, state: &T::State) -> Result<Vec<u8>, EnvError> {
    let body = postcard::to_stdvec(state).map_err(|error| problem(&error))?;
    let header = Header {
        magic: T::MAGIC,
        version: VERSION,
        task: fingerprint(task)?,
        body: xxh3_64(&body),
    };
    let mut bytes = postcard::to_stdvec(&header).map_err(|error| problem(&error))?;
    bytes.extend_from_slice(&body);
    Ok(bytes)
}

/// The state in `bytes`.
///
/// # Errors
/// [`EnvError::Snapshot`] for bytes that are cut short, altered, of another version, of an environment
/// with another config or other options, or a state that no episode can be in.
pub fn load<T: Task>(task: &T, bytes: &[u8]) -> Result<T::State, EnvError> {
    let (header, body): (Header, &[u8]) =
        postcard::take_from_bytes(bytes).map_err(|error| problem(&error))?;
    if header.magic != T::MAGIC {
        return Err(refused(&format!(
            "these bytes are not a snapshot of a {} environment",
            T::NAME
        )));
    }
    if header.version != VERSION {
        return Err(refused(&format!(
            "version {} is not {VERSION}",
            header.version
        )));
    }
    if header.task != fingerprint(task)? {
        return Err(refused("taken under another config or other options"));
    }
    if header.body != xxh3_64(body) {
        return Err(refused("the bytes are cut short or altered"));
    }
    let (mut state, rest): (T::State, &[u8]) =
        postcard::take_from_bytes(body).map_err(|error| problem(&error))?;
    if !rest.is_empty() {
        return Err(refused("bytes are left over"));
    }
    episode::check(task, &mut state)?;
    Ok(state)
}

/// A number that two states share only if they are the same to the bit.
///
/// # Errors
/// As [`save`].
pub fn hash<T: Task>(task: &T, state: &T::State) -> Result<u64, EnvError> {
    Ok(xxh3_64(&save(task, state)?))
}

fn fingerprint(task: &impl Task) -> Result<u64, EnvError> {
    let text =
        serde_json::to_string(&task.fingerprint()).map_err(|error| refused(&error.to_string()))?;
    Ok(xxh3_64(text.as_bytes()))
}

fn problem(error: &postcard::Error) -> EnvError {
    refused(&error.to_string())
}

fn refused(problem: &str) -> EnvError {
    EnvError::Snapshot {
        problem: problem.to_owned(),
    }
}
