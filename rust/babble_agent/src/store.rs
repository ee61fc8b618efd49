//! A learned agent as a safetensors file: weights and averages as tensors, all else as JSON in the
//! header's metadata, which begins with a checksum of the rest. Nothing in such a file is code.

use std::collections::HashMap;

use babble_env::Config;
use babble_env::reach::movement::Fidelity;
use safetensors::tensor::{Dtype, TensorView};
use safetensors::{SafeTensors, serialize};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::Xxh3;

use crate::error::AgentError;
use crate::hebb::{Hebb, HebbConfig};

const KEY: &str = "gym_babble";
const VERSION: u32 = 1;
/// What the metadata begins with; the checksum of 16 hexadecimal digits and `",` follow.
const CHECKSUM: &str = "{\"checksum\":\"";
/// Names of the tensors.
const TENSORS: [&str; 3] = ["weights", "a_bar", "g_bar"];

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
    let w = hebb.weights();
    let bytes = |values: &[f32]| {
        values
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let data = [bytes(w.weights()), bytes(w.a_bar()), bytes(w.g_bar())];
    let shapes = [vec![w.n_out(), w.n_in()], vec![w.n_out()], vec![w.n_in()]];
    let mut views = Vec::new();
    for ((name, shape), data) in TENSORS.into_iter().zip(shapes).zip(&data) {
        views.push((
            name,
            TensorView::new(Dtype::F32, shape, data).map_err(|e| file(&e))?,
        ));
    }
    let text = with_checksum(
        &serde_json::to_string(metadata).map_err(|e| file(&e))?,
        &data,
    );
    serialize(views, Some(HashMap::from([(KEY.to_owned(), text)]))).map_err(|e| file(&e))
}

/// The agent in a file's bytes.
///
/// # Errors
/// [`AgentError::File`] for bytes that are cut short, not an agent, or of another version;
/// [`AgentError`] for weights that do not fit their maps.
pub fn load(bytes: &[u8]) -> Result<(Hebb, Metadata), AgentError> {
    let tensors = SafeTensors::deserialize(bytes).map_err(|e| file(&e))?;
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| file(&e))?;
    let text = header
        .metadata()
        .as_ref()
        .and_then(|all| all.get(KEY))
        .ok_or_else(|| AgentError::File {
            problem: format!("a safetensors file, but without {KEY:?} in its metadata"),
        })?;
    let text = without_checksum(text, &tensors)?;
    let metadata: Metadata = serde_json::from_str(&text).map_err(|e| file(&e))?;
    if metadata.version != VERSION {
        return Err(AgentError::File {
            problem: format!("version {} is not {VERSION}", metadata.version),
        });
    }
    metadata.config.validate()?;
    let [weights, a_bar, g_bar] = [0, 1, 2].map(|i| values(&tensors, TENSORS[i]));
    Ok((
        Hebb::from_parts(metadata.agent.clone(), weights?, a_bar?, g_bar?)?,
        metadata,
    ))
}

fn checksum<'a>(json: &str, data: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = Xxh3::new();
    hash.update(json.as_bytes());
    for bytes in data {
        hash.update(bytes);
    }
    format!("{:016x}", hash.digest())
}

/// A JSON object with the checksum of itself and `data` as its first field.
fn with_checksum(json: &str, data: &[Vec<u8>]) -> String {
    let sum = checksum(json, data.iter().map(Vec::as_slice));
    format!("{CHECKSUM}{sum}\",{}", &json[1..])
}

fn without_checksum(text: &str, tensors: &SafeTensors<'_>) -> Result<String, AgentError> {
    let altered = || AgentError::File {
        problem: "the file is altered: its checksum differs".to_owned(),
    };
    let rest = text.strip_prefix(CHECKSUM).ok_or_else(altered)?;
    let (sum, fields) = rest.split_once("\",").ok_or_else(altered)?;
    let json = format!("{{{fields}");
    let mut data = Vec::new();
    for name in TENSORS {
        data.push(tensors.tensor(name).map_err(|e| file(&e))?.data());
    }
    if sum == checksum(&json, data) {
        Ok(json)
    } else {
        Err(altered())
    }
}

fn values(tensors: &SafeTensors<'_>, name: &str) -> Result<Vec<f32>, AgentError> {
    let tensor = tensors.tensor(name).map_err(|e| file(&e))?;
    if tensor.dtype() != Dtype::F32 {
        return Err(AgentError::File {
            problem: format!("{name} is {:?}, expected F32", tensor.dtype()),
        });
    }
    let four = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    Ok(tensor.data().chunks_exact(4).map(four).collect())
}

fn file(error: &impl ToString) -> AgentError {
    AgentError::File {
        problem: error.to_string(),
    }
}
