//! Configs as documents: TOML or JSON text, and files, whose faults are named by field.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use crate::error::EnvError;

/// Largest file that is read \[byte\].
const MOST_BYTES: u64 = 1 << 20;

/// The values of a JSON text.
pub(crate) fn from_json(text: &str) -> Result<Value, EnvError> {
    let mut document = serde_json::Deserializer::from_str(text);
    let found = named(serde_path_to_error::deserialize(&mut document))?;
    document.end().map_err(|error| fault("document", &error))?;
    Ok(found)
}

/// The values of a TOML text.
pub(crate) fn from_toml(text: &str) -> Result<Value, EnvError> {
    let document = toml::Deserializer::parse(text).map_err(|error| fault("document", &error))?;
    named(serde_path_to_error::deserialize(document))
}

/// The text of a file, without the mark of its byte order that some editors put first.
pub(crate) fn text_of(path: &Path) -> Result<String, EnvError> {
    let refused = |problem: String| EnvError::Config {
        field: path.display().to_string(),
        problem,
    };
    let failed = |error: std::io::Error| refused(error.to_string());
    let file = File::open(path).map_err(failed)?;
    // A device or a pipe may never end.
    if !file.metadata().map_err(failed)?.is_file() {
        return Err(refused("this is not a file".to_owned()));
    }
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(refused(format!(
            "a config file has at most {MOST_BYTES} bytes"
        )));
    }
    let text = String::from_utf8(bytes)
        .map_err(|error| refused(format!("this is not UTF-8 text: {}", error.utf8_error())))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned())
}

/// What is wrong with a field.
pub(crate) fn fault(field: &str, error: &impl ToString) -> EnvError {
    EnvError::Config {
        field: field.to_owned(),
        problem: error.to_string(),
    }
}

fn named<E: fmt::Display>(
    found: Result<Document, serde_path_to_error::Error<E>>,
) -> Result<Value, EnvError> {
    found.map(|Document(value)| value).map_err(|error| {
        let path = error.path().to_string();
        // The whole document is the path ".", and "?" what could not be read as a field.
        let field = match path.trim_end_matches(['.', '?']) {
            "" => "document",
            field => field,
        };
        fault(field, error.inner())
    })
}

/// A value of any format in which each name of a map stands once and each number is finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Document(pub Value);

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DocumentVisitor).map(Self)
    }
}

struct DocumentVisitor;

impl<'de> Visitor<'de> for DocumentVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("null, a bool, a finite number, a string, a list or a map")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value)
            .map(Value::Number)
            .ok_or_else(|| E::custom(format_args!("{value} is not finite")))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut all = Vec::new();
        while let Some(Document(item)) = items.next_element()? {
            all.push(item);
        }
        Ok(Value::Array(all))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Value, A::Error> {
        let mut all = Map::new();
        while let Some(name) = fields.next_key::<String>()? {
            let Document(value) = fields.next_value()?;
            if all.contains_key(&name) {
                return Err(A::Error::custom(format_args!("duplicate field {name:?}")));
            }
            all.insert(name, value);
        }
        Ok(Value::Object(all))
    }
}
