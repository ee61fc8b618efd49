//! Body and task in one document.
//!
//! A config is a profile (`paper` or `icub`) with any of its fields replaced. Unknown fields are
//! refused. Sources of the numbers: \[P\] the paper, \[F\] fitted to its tables, \[C\] our choice.

use std::collections::BTreeSet;
use std::path::Path;

use babble_body::Body;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::document;
use crate::error::EnvError;
use crate::noise::NoiseConfig;
use crate::tasks::grasp::config::GraspConfig;
use crate::tasks::reach::config::ReachConfig;

/// Names of the profiles.
pub const PROFILES: [&str; 2] = ["paper", "icub"];

/// Everything that a modeller may change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The profile this config started from.
    pub profile: String,
    /// Arm, hand, muscles, eye, obstacle and target.
    pub body: Body,
    /// The reaching task's numbers.
    pub reach: ReachConfig,
    /// The grasping task's numbers.
    pub grasp: GraspConfig,
    /// Noise of senses and muscles; not written while there is none.
    #[serde(default, skip_serializing_if = "NoiseConfig::is_off")]
    pub noise: NoiseConfig,
}

impl Config {
    /// The profile of that name.
    ///
    /// # Errors
    /// [`EnvError::Option`] for an unknown name.
    pub fn profile(name: &str) -> Result<Self, EnvError> {
        let (body, reach, grasp) = match name {
            "paper" => (Body::paper(), ReachConfig::paper(), GraspConfig::paper()),
            "icub" => (Body::icub(), ReachConfig::icub(), GraspConfig::icub()),
            _ => {
                return Err(EnvError::Option {
                    option: "config",
                    value: name.to_owned(),
                    known: PROFILES.join(", "),
                });
            }
        };
        Ok(Self {
            profile: name.to_owned(),
            body,
            reach,
            grasp,
            noise: NoiseConfig::default(),
        })
    }

    /// A profile with the fields of a JSON object replaced; `profile` names it (`paper` if absent).
    ///
    /// # Errors
    /// [`EnvError`] with the path of the field that is unknown, of a wrong type or out of bounds.
    pub fn from_json(text: &str) -> Result<Self, EnvError> {
        Self::from_value(document::from_json(text)?)
    }

    /// The same from a TOML document.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn from_toml(text: &str) -> Result<Self, EnvError> {
        Self::from_value(document::from_toml(text)?)
    }

    /// The same from a file that ends in `.toml` or `.json`.
    ///
    /// # Errors
    /// As [`Self::from_json`]; [`EnvError::Config`] for a file that cannot be read, is no text, or has
    /// more than a megabyte.
    pub fn from_file(path: &Path) -> Result<Self, EnvError> {
        let read = match path.extension().and_then(|ending| ending.to_str()) {
            Some("toml") => Self::from_toml,
            Some("json") => Self::from_json,
            _ => {
                let problem = "a config file ends in .toml or .json";
                return Err(document::fault(&path.display().to_string(), &problem));
            }
        };
        read(&document::text_of(path)?).map_err(|error| within_file(path, error))
    }

    fn from_value(overrides: Value) -> Result<Self, EnvError> {
        let profile = match overrides.get("profile") {
            None => "paper",
            Some(Value::String(name)) => name,
            Some(other) => {
                return Err(EnvError::Config {
                    field: "profile".to_owned(),
                    problem: format!("{other} is not a name"),
                });
            }
        };
        let base = Self::profile(profile)?;
        let mut value =
            serde_json::to_value(&base).map_err(|error| document::fault("document", &error))?;
        value["noise"] = serde_json::to_value(base.noise)
            .map_err(|error| document::fault("document", &error))?;
        merge(&mut value, overrides, &mut Vec::new())?;
        let config = Self::from_whole(value)?;
        config.validate()?;
        Ok(config)
    }

    /// A whole document, as [`Self::to_json`] writes it; its numbers are not checked.
    ///
    /// # Errors
    /// [`EnvError::Config`] with the path of the field that is unknown, missing or of a wrong type.
    pub fn from_whole(value: Value) -> Result<Self, EnvError> {
        serde_path_to_error::deserialize(value).map_err(|error| EnvError::Config {
            field: error.path().to_string(),
            problem: error.inner().to_string(),
        })
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`EnvError::Config`] or [`EnvError::Body`] with field, value and bound.
    pub fn validate(&self) -> Result<(), EnvError> {
        self.body.validate()?;
        self.noise.validate()?;
        self.grasp.validate()?;
        self.reach.validate(&self.body.muscles)
    }

    /// The first field in which another config differs: its path, and its values here and there as
    /// JSON.
    ///
    /// # Errors
    /// As [`Self::to_json`].
    pub fn difference(&self, other: &Self) -> Result<Option<[String; 3]>, EnvError> {
        let value = |config| {
            serde_json::to_value(config).map_err(|error| document::fault("document", &error))
        };
        Ok(difference(&value(self)?, &value(other)?, &mut Vec::new()))
    }

    /// The whole document as JSON.
    ///
    /// # Errors
    /// Never for a validated config; the serializer's signature has it.
    pub fn to_json(&self) -> Result<String, EnvError> {
        serde_json::to_string(self).map_err(|error| document::fault("document", &error))
    }
}

fn difference(here: &Value, there: &Value, path: &mut Vec<String>) -> Option<[String; 3]> {
    if here == there {
        return None;
    }
    let (Value::Object(ours), Value::Object(theirs)) = (here, there) else {
        return Some([path.join("."), here.to_string(), there.to_string()]);
    };
    let keys: BTreeSet<&String> = ours.keys().chain(theirs.keys()).collect();
    keys.into_iter().find_map(|key| {
        path.push(key.clone());
        let [here, there] = [ours, theirs].map(|fields| fields.get(key).unwrap_or(&Value::Null));
        let found = difference(here, there, path);
        path.pop();
        found
    })
}

/// Replaces in `base` what `overrides` has; a key that `base` does not have is an unknown field.
fn merge(base: &mut Value, overrides: Value, path: &mut Vec<String>) -> Result<(), EnvError> {
    let (Value::Object(base), Value::Object(overrides)) = (&mut *base, &overrides) else {
        *base = overrides;
        return Ok(());
    };
    for (key, value) in overrides {
        path.push(key.clone());
        match base.get_mut(key) {
            Some(slot) => merge(slot, value.clone(), path)?,
            // A joint's lock is there only where it has one; its fields are checked when the whole
            // is read.
            None if path.len() == 4 && path[1] == "joints" => {
                base.insert(key.clone(), value.clone());
            }
            None => {
                let known = base.keys().cloned().collect::<Vec<_>>().join(", ");
                return Err(EnvError::Config {
                    field: path.join("."),
                    problem: format!("unknown field; there are {known}"),
                });
            }
        }
        path.pop();
    }
    Ok(())
}

/// The same error with the file's path before the field's.
fn within_file(path: &Path, error: EnvError) -> EnvError {
    match error {
        EnvError::Config { field, problem } => EnvError::Config {
            field: format!("{}: {field}", path.display()),
            problem,
        },
        EnvError::Body(error) => document::fault(
            &path.display().to_string(),
            &format_args!("in body: {error}"),
        ),
        other => document::fault(&path.display().to_string(), &other),
    }
}
