//! Named tensors and JSON in a safetensors file. The JSON stands in the header's metadata and begins
//! with a checksum of all the rest. Nothing in such a file is code.

use babble_brain::Association;
use babble_env::Config;
use safetensors::tensor::{Dtype, TensorView};
use safetensors::{SafeTensors, serialize};
use serde::Serialize;
use serde::de::{Deserialize, Deserializer, Error};
use serde_json::Value;
use xxhash_rust::xxh3::Xxh3;

use crate::error::AgentError;

/// What the JSON begins with; the checksum of 16 hexadecimal digits and `",` follow.
const CHECKSUM: &str = "{\"checksum\":\"";

/// A tensor to be written.
#[derive(Debug)]
pub struct Tensor<'a> {
    /// Its name.
    pub name: String,
    /// Its lengths along each axis.
    pub shape: Vec<usize>,
    /// Its numbers, the last axis fastest.
    pub values: &'a [f32],
}

/// Names of an association's tensors: weights, averages of the output and of the input.
pub(crate) fn names(prefix: &str) -> [String; 3] {
    ["weights", "a_mean", "g_mean"].map(|name| format!("{prefix}{name}"))
}

/// The weights and averages of an association.
pub(crate) fn of<'a>(prefix: &str, w: &'a Association) -> [Tensor<'a>; 3] {
    let [weights, a_mean, g_mean] = names(prefix);
    let tensor = |name, shape, values| Tensor {
        name,
        shape,
        values,
    };
    [
        tensor(weights, vec![w.n_out(), w.n_in()], w.weights()),
        tensor(a_mean, vec![w.n_out()], w.a_mean()),
        tensor(g_mean, vec![w.n_in()], w.g_mean()),
    ]
}

/// The bytes of a file; `key` names the JSON in the header, an object of at least one field.
///
/// # Errors
/// [`AgentError::File`] for tensors whose numbers do not fit their shapes.
pub fn write(
    key: &str,
    metadata: &impl Serialize,
    tensors: &[Tensor],
) -> Result<Vec<u8>, AgentError> {
    let data: Vec<Vec<u8>> = tensors
        .iter()
        .map(|tensor| tensor.values.iter().flat_map(|x| x.to_le_bytes()).collect())
        .collect();
    let mut views = Vec::new();
    for (tensor, data) in tensors.iter().zip(&data) {
        let view = TensorView::new(Dtype::F32, tensor.shape.clone(), data).map_err(|e| file(&e))?;
        views.push((tensor.name.as_str(), view));
    }
    let json = serde_json::to_string(metadata).map_err(|e| file(&e))?;
    let text = with_checksum(&json, &data);
    #[expect(
        clippy::disallowed_types,
        reason = "of one entry, as safetensors takes it"
    )]
    let metadata = std::collections::HashMap::from([(key.to_owned(), text)]);
    serialize(views, Some(metadata)).map_err(|e| file(&e))
}

/// What the texts in a file's header are called.
///
/// # Errors
/// [`AgentError::File`] for bytes that are no safetensors file.
pub fn keys(bytes: &[u8]) -> Result<Vec<String>, AgentError> {
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| file(&e))?;
    let texts = header.metadata().as_ref();
    Ok(texts.map_or_else(Vec::new, |texts| texts.keys().cloned().collect()))
}

/// How many tensors a file's bytes hold.
///
/// # Errors
/// [`AgentError::File`] for bytes that are no safetensors file.
pub fn count(bytes: &[u8]) -> Result<usize, AgentError> {
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| file(&e))?;
    Ok(header.tensors().len())
}

/// The shape and the numbers of a tensor that was read.
pub type Shaped = (Vec<usize>, Vec<f32>);

/// The JSON and the tensors of that `names` in a file's bytes.
///
/// # Errors
/// [`AgentError::File`] for bytes that are cut short, altered, or of another kind.
pub fn read(
    key: &str,
    bytes: &[u8],
    names: &[String],
) -> Result<(String, Vec<Shaped>), AgentError> {
    let tensors = SafeTensors::deserialize(bytes).map_err(|e| file(&e))?;
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| file(&e))?;
    let text = header
        .metadata()
        .as_ref()
        .and_then(|all| all.get(key))
        .ok_or_else(|| AgentError::File {
            problem: format!("a safetensors file, but without {key:?} in its metadata"),
        })?;
    let json = without_checksum(text, &tensors, names)?;
    let values = names.iter().map(|name| values(&tensors, name));
    Ok((json, values.collect::<Result<_, _>>()?))
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

fn without_checksum(
    text: &str,
    tensors: &SafeTensors<'_>,
    names: &[String],
) -> Result<String, AgentError> {
    let altered = || AgentError::File {
        problem: "the file is altered: its checksum differs".to_owned(),
    };
    let rest = text.strip_prefix(CHECKSUM).ok_or_else(altered)?;
    let (sum, fields) = rest.split_once("\",").ok_or_else(altered)?;
    let json = format!("{{{fields}");
    let mut data = Vec::new();
    for name in names {
        data.push(tensors.tensor(name).map_err(|e| file(&e))?.data());
    }
    if sum == checksum(&json, data) {
        Ok(json)
    } else {
        Err(altered())
    }
}

fn values(tensors: &SafeTensors<'_>, name: &str) -> Result<Shaped, AgentError> {
    let tensor = tensors.tensor(name).map_err(|e| file(&e))?;
    if tensor.dtype() != Dtype::F32 {
        return Err(AgentError::File {
            problem: format!("{name} is {:?}, expected F32", tensor.dtype()),
        });
    }
    let four = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let values = tensor.data().chunks_exact(4).map(four).collect();
    Ok((tensor.shape().to_vec(), values))
}

/// The fields of the JSON in a header.
pub(crate) fn fields(json: &str) -> Result<Value, AgentError> {
    let mut json = serde_json::Deserializer::from_str(json);
    serde_path_to_error::deserialize(&mut json).map_err(|e| file(&e))
}

/// The config in a file. The code that reads a config is there once, which a browser downloads.
pub(crate) fn whole_config<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Config, D::Error> {
    Config::from_whole(Value::deserialize(deserializer)?).map_err(D::Error::custom)
}

/// An error of a file, from any other.
pub(crate) fn file(error: &impl ToString) -> AgentError {
    AgentError::File {
        problem: error.to_string(),
    }
}
