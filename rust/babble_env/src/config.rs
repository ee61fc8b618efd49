//! Body and task in one document.
//!
//! A config is a profile (`paper` or `icub`) with any of its fields replaced. Unknown fields are
//! refused. Sources of the numbers: \[P\] the paper, \[F\] fitted to its tables, \[C\] a free choice.

use std::fs;
use std::path::Path;

use babble_body::Body;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::EnvError;
use crate::tasks::grasp::GraspNumbers;

/// Names of the profiles.
pub const PROFILES: [&str; 2] = ["paper", "icub"];

/// The reaching task's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReachNumbers {
    /// Distance from start to target: lowest and highest \[m\]; 0.08 and 0.25 \[F\] (body `icub`:
    /// 0.10 and 0.20 \[C\]).
    pub distance_m: [f64; 2],
    /// Success when the fingertip is at most this far from the target \[m\]; 0.02 \[C\].
    pub success_radius_m: f64,
    /// Lowest and highest b1 and b2 of a movement; 0.01 and 0.99 \[C\].
    pub b_range: [f64; 2],
    /// Movement time T of the pattern generators \[s\]; 8 \[C\]. Shorter movements lose their
    /// curvature to the muscles' lag.
    pub movement_s: f64,
    /// Time to settle after T, in muscle time constants `K_D/K_P`; 4 \[C\]. 120 s at most.
    pub settle_time_constants: f64,
    /// Change of the equilibrium point by an action of 1 in `delta_posture` control \[deg\]; 5 \[C\].
    pub delta_posture_deg: f64,
    /// Joint speed below which the arm counts as settled, if that is asked for \[rad/s\]; 0.05 \[C\].
    pub settled_speed_rad_s: f64,
    /// Time between two actions \[s\]; 0.05 \[C\].
    pub control_period_s: f64,
    /// Physics steps in a control period; 10 \[C\], that is 5 ms each.
    pub physics_steps: u32,
}

/// Everything that a modeller may change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The profile this config started from.
    pub profile: String,
    /// Arm, hand, muscles, eye, obstacle and target.
    pub body: Body,
    /// The reaching task's numbers.
    pub reach: ReachNumbers,
    /// The grasping task's numbers.
    pub grasp: GraspNumbers,
}

impl Config {
    /// The profile of that name.
    ///
    /// # Errors
    /// [`EnvError::Option`] for an unknown name.
    pub fn profile(name: &str) -> Result<Self, EnvError> {
        let reach = ReachNumbers {
            distance_m: [0.08, 0.25],
            success_radius_m: 0.02,
            b_range: [0.01, 0.99],
            movement_s: 8.0,
            settle_time_constants: 4.0,
            delta_posture_deg: 5.0,
            settled_speed_rad_s: 0.05,
            control_period_s: 0.05,
            physics_steps: 10,
        };
        let (body, reach, grasp) = match name {
            "paper" => (Body::paper(), reach, GraspNumbers::paper()),
            "icub" => (
                Body::icub(),
                ReachNumbers {
                    distance_m: [0.1, 0.2],
                    ..reach
                },
                GraspNumbers::icub(),
            ),
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
        })
    }

    /// A profile with the fields of a JSON object replaced; `profile` names it (`paper` if absent).
    ///
    /// # Errors
    /// [`EnvError`] with the path of the field that is unknown, of a wrong type or out of bounds.
    pub fn from_json(text: &str) -> Result<Self, EnvError> {
        let overrides = serde_json::from_str(text).map_err(|error| document(&error))?;
        Self::from_value(overrides)
    }

    /// The same from a TOML document.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn from_toml(text: &str) -> Result<Self, EnvError> {
        let overrides: Value = toml::from_str(text).map_err(|error| document(&error))?;
        Self::from_value(overrides)
    }

    /// The same from a file that ends in `.toml` or `.json`.
    ///
    /// # Errors
    /// As [`Self::from_json`], and for a file that cannot be read.
    pub fn from_file(path: &Path) -> Result<Self, EnvError> {
        let named = |problem: String| EnvError::Config {
            field: path.display().to_string(),
            problem,
        };
        let text = fs::read_to_string(path).map_err(|error| named(error.to_string()))?;
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("toml") => Self::from_toml(&text).map_err(|error| within_file(path, error)),
            Some("json") => Self::from_json(&text).map_err(|error| within_file(path, error)),
            _ => Err(named("a config file ends in .toml or .json".to_owned())),
        }
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
        let mut value = serde_json::to_value(base).map_err(|error| document(&error))?;
        merge(&mut value, overrides, &mut Vec::new())?;
        let config: Self =
            serde_path_to_error::deserialize(value).map_err(|error| EnvError::Config {
                field: error.path().to_string(),
                problem: error.inner().to_string(),
            })?;
        config.validate()?;
        Ok(config)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`EnvError::Config`] or [`EnvError::Body`] with field, value and bound.
    pub fn validate(&self) -> Result<(), EnvError> {
        self.body.validate()?;
        self.grasp.validate()?;
        let reach = &self.reach;
        let [near, far] = reach.distance_m;
        within("reach.distance_m[0]", near, 1e-3, 1.0)?;
        within("reach.distance_m[1]", far, near, 2.0)?;
        within("reach.success_radius_m", reach.success_radius_m, 1e-4, near)?;
        within("reach.b_range[0]", reach.b_range[0], 0.01, 0.99)?;
        within("reach.b_range[1]", reach.b_range[1], reach.b_range[0], 0.99)?;
        // Before the movement time, which is bounded by it.
        within("reach.control_period_s", reach.control_period_s, 1e-3, 1.0)?;
        within(
            "reach.movement_s",
            reach.movement_s,
            reach.control_period_s,
            120.0,
        )?;
        within(
            "reach.settle_time_constants",
            reach.settle_time_constants,
            0.0,
            20.0,
        )?;
        let muscles = &self.body.muscles;
        let settle_s = reach.settle_time_constants * muscles.kd / muscles.kp;
        within(
            "reach.settle_time_constants K_D/K_P in seconds",
            settle_s,
            0.0,
            120.0,
        )?;
        within(
            "reach.delta_posture_deg",
            reach.delta_posture_deg,
            0.01,
            180.0,
        )?;
        within(
            "reach.settled_speed_rad_s",
            reach.settled_speed_rad_s,
            1e-6,
            100.0,
        )?;
        within(
            "reach.physics_steps",
            f64::from(reach.physics_steps),
            1.0,
            1000.0,
        )
    }

    /// The whole document as JSON.
    ///
    /// # Errors
    /// Never for a validated config; the serializer's signature has it.
    pub fn to_json(&self) -> Result<String, EnvError> {
        serde_json::to_string(self).map_err(|error| document(&error))
    }
}

impl ReachNumbers {
    /// Physics step \[s\].
    #[must_use]
    pub fn physics_step_s(&self) -> f64 {
        self.control_period_s / f64::from(self.physics_steps)
    }

    /// Control periods of the pattern generators' movement time.
    #[must_use]
    pub fn movement_steps(&self) -> usize {
        (self.movement_s / self.control_period_s).round().max(1.0) as usize
    }
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
        other => other,
    }
}

fn document(error: &impl ToString) -> EnvError {
    EnvError::Config {
        field: "document".to_owned(),
        problem: error.to_string(),
    }
}

/// `Ok` when `value` is finite and inside `[low, high]`.
pub(crate) fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), EnvError> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    Err(EnvError::Config {
        field: field.to_owned(),
        problem: format!("{value} is out of bounds: finite and in [{low}, {high}]"),
    })
}
