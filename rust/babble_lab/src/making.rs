//! From a setup to a task and the numbers of a brain.

use std::sync::Arc;

use babble_agent::erased::brain_of;
use babble_agent::rule::Rule;
use babble_env::option_spec::OptionValues;
use babble_env::registry::{self, ProtocolEntry};
use babble_env::{AnyTask, Config};
use babble_eye::EyeConfig;
use serde_json::{Map, Value};

use crate::fault::Fault;
use crate::setup::Setup;

/// The fields of the config that differ from the profile. A camera frame brings the ranges of pan and tilt
/// that belong to it, unless these are given too.
pub(crate) fn config_fields(setup: &Setup) -> Result<Map<String, Value>, Fault> {
    let mut fields = setup.config.clone();
    let eye = fields.get_mut("body").and_then(|body| body.get_mut("eye"));
    let Some(eye) = eye.and_then(Value::as_object_mut) else {
        return Ok(fields);
    };
    let ranges = match eye.get("frame").and_then(Value::as_str) {
        Some("fick") => EyeConfig::fick(),
        Some("helmholtz") => EyeConfig::helmholtz(),
        _ => return Ok(fields),
    };
    let ranges = serde_json::to_value(ranges)?;
    for name in ["pan_deg", "tilt_deg"] {
        let value = || ranges[name].clone();
        eye.entry(name).or_insert_with(value);
    }
    Ok(fields)
}

/// Body and task.
pub(crate) fn config(setup: &Setup) -> Result<Config, Fault> {
    let mut fields = config_fields(setup)?;
    if fields.contains_key("profile") {
        let problem = "the profile stands beside the config, not in it";
        return Err(Fault::config("config.profile", problem));
    }
    fields.insert("profile".to_owned(), setup.profile.clone().into());
    let config = Config::from_json(&serde_json::to_string(&fields)?)?;
    // Its bits depend on the platform.
    if serde_json::to_value(config.body.engine)? != "tree" {
        let problem = "the lab has the engine `tree` alone";
        return Err(Fault::config("body.engine", problem));
    }
    Ok(config)
}

/// The task of a setup with further options.
pub(crate) fn task(setup: &Setup, more: &Map<String, Value>) -> Result<Arc<dyn AnyTask>, Fault> {
    setup.check()?;
    let mut options = setup.options.clone();
    options.extend(more.clone());
    Ok(babble_env::make(&setup.env, config(setup)?, &options)?)
}

/// The values of all options of a setup's environment.
pub(crate) fn options(setup: &Setup) -> Result<OptionValues, Fault> {
    let (task, row) = registry::environment(&setup.env)?;
    let mut all = registry::presets(row.presets);
    all.extend(setup.options.clone());
    Ok(OptionValues::read(task.options, &all)?)
}

/// The protocol of the cases that results in an environment are reported on.
pub(crate) fn protocol(setup: &Setup) -> Result<&'static ProtocolEntry, Fault> {
    let (task, _) = registry::environment(&setup.env)?;
    let values = options(setup)?;
    let fits = |one: &&ProtocolEntry| {
        let mut presets = one.presets.iter();
        presets.all(|(name, value)| values.name(name) == *value)
    };
    task.protocols.iter().find(fits).ok_or_else(|| {
        let problem = format!("{} has no test cases for these options", setup.env);
        Fault::config("options", problem)
    })
}

/// The numbers of a variant with some of them replaced.
pub(crate) fn brain(
    task: &str,
    variant: &str,
    changes: &Map<String, Value>,
    own_rule: bool,
) -> Result<Value, Fault> {
    let mut brain = brain_of(task, variant)?;
    let named = changes.get("rule").and_then(|rule| rule.get("name"));
    match named.map(Value::as_str) {
        _ if own_rule => brain["rule"] = serde_json::to_value(Rule::own())?,
        None => {}
        Some(Some(name)) => brain["rule"] = serde_json::to_value(name.parse::<Rule>()?)?,
        Some(None) => return Err(Fault::config("brain.rule.name", "it is not a name")),
    }
    merge(&mut brain, changes, "brain")?;
    Ok(brain)
}

fn merge(base: &mut Value, changes: &Map<String, Value>, path: &str) -> Result<(), Fault> {
    let known = || -> Vec<String> {
        let fields = base.as_object().into_iter().flat_map(Map::keys);
        fields.cloned().collect()
    };
    if let Some(name) = changes.keys().find(|name| base.get(name).is_none()) {
        let problem = format!("unknown field; there are {}", known().join(", "));
        return Err(Fault::config(&format!("{path}.{name}"), problem));
    }
    for (name, change) in changes {
        match (&mut base[name], change) {
            (Value::Object(_), Value::Object(fields)) => {
                merge(&mut base[name], fields, &format!("{path}.{name}"))?;
            }
            (value, change) => *value = change.clone(),
        }
    }
    Ok(())
}

/// What of `all` differs from `base`, nested.
pub(crate) fn difference(all: &Value, base: &Value) -> Map<String, Value> {
    let mut changes = Map::new();
    let (Value::Object(all), Value::Object(base)) = (all, base) else {
        return changes;
    };
    for (name, value) in all {
        let before = base.get(name).unwrap_or(&Value::Null);
        if value == before {
            continue;
        }
        let value = match (value, before) {
            (Value::Object(_), Value::Object(_)) => difference(value, before).into(),
            _ => value.clone(),
        };
        changes.insert(name.clone(), value);
    }
    changes
}
