//! JSON schemas of actions, observations, states and resets, from the registry and the spec.

use babble_env::case::CasePart;
use babble_env::option_spec::{OptionDefault, OptionKind, OptionSpec};
use babble_env::registry::TASKS;
use babble_env::spec::{Entry, Spec};
use serde_json::{Map, Value, json};

use crate::session::Session;

/// The schemas of `/schema`.
pub(super) fn schemas(session: &Session) -> Value {
    json!({
        "action": action(&session.spec.action),
        "observation": observation(session),
        "reset_observation": observation(session),
        "state": state(session),
    })
}

fn action(entry: &Entry) -> Value {
    json!({
        "title": "Action",
        "type": "object",
        "properties": {
            "action": numbers(entry),
            "metadata": {"type": "object", "description": "Ignored."},
        },
        "required": ["action"],
        "additionalProperties": false,
    })
}

fn observation(session: &Session) -> Value {
    let spec = &session.spec;
    let mut properties = Map::new();
    match session.obs() {
        "flat" => properties.extend([("observation".to_owned(), flat(spec))]),
        "goal" => {
            properties.insert("observation".to_owned(), flat(spec));
            properties.extend(spec.goals.iter().map(named));
        }
        _ => properties.extend(spec.senses.iter().map(named)),
    }
    if let Some(size) = session.retina() {
        properties.insert("retina".to_owned(), retina(size));
    }
    let metadata = metadata(spec);
    properties.insert("metadata".to_owned(), metadata);
    let required: Vec<String> = properties.keys().cloned().collect();
    let [low, high] = spec.reward_bounds;
    let reward = json!({
        "description": "Reward of the step; null after a reset.",
        "anyOf": [{"type": "number", "minimum": low, "maximum": high}, {"type": "null"}],
    });
    let done = json!({"type": "boolean", "description": "Whether the episode has ended."});
    properties.extend([("reward".to_owned(), reward), ("done".to_owned(), done)]);
    json!({
        "title": "Observation",
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn named(entry: &Entry) -> (String, Value) {
    (entry.name.to_owned(), numbers(entry))
}

/// A list of numbers, each with its name and bounds.
fn numbers(entry: &Entry) -> Value {
    let description = format!("{} [{}]", entry.description, entry.unit);
    list(&description, each(entry))
}

fn flat(spec: &Spec) -> Value {
    let names: Vec<&str> = spec.senses.iter().map(|sense| sense.name).collect();
    let description = format!("All senses, one after the other: {}", names.join(", "));
    list(&description, spec.senses.iter().flat_map(each))
}

fn list(description: &str, items: impl Iterator<Item = Value>) -> Value {
    let items: Vec<Value> = items.collect();
    json!({
        "description": description,
        "type": "array",
        "minItems": items.len(),
        "maxItems": items.len(),
        "prefixItems": items,
    })
}

fn each(entry: &Entry) -> impl Iterator<Item = Value> {
    let bounds = entry.low.iter().zip(&entry.high);
    entry.labels.iter().zip(bounds).map(|(label, (&low, &high))| {
        json!({"title": label, "type": "number", "minimum": single(low), "maximum": single(high)})
    })
}

/// A bound as the float32 number that is written in observations.
fn single(bound: f64) -> Value {
    let text = (bound as f32).to_string();
    serde_json::from_str(&text).unwrap_or_else(|_| json!(bound))
}

fn retina(size: u32) -> Value {
    let level = json!({"type": "integer", "minimum": 0, "maximum": 255});
    let array = |n: u32, items: Value| json!({"type": "array", "minItems": n, "maxItems": n, "items": items});
    let mut image = array(size, array(size, array(3, level)));
    image["description"] = json!("The eye's image: rows of pixels (red, green, blue).");
    image
}

fn metadata(spec: &Spec) -> Value {
    let flag = || json!({"type": "boolean"});
    let flags = |names: &[&str]| -> Map<String, Value> {
        names
            .iter()
            .map(|&name| (name.to_owned(), flag()))
            .collect()
    };
    let mut info = flags(spec.facts);
    let terms = spec.reward_terms.iter();
    let terms: Map<String, Value> = terms
        .map(|&name| (name.to_owned(), json!({"type": "number"})))
        .collect();
    info.insert("outcome".to_owned(), object(&flags(&spec.outcomes)));
    info.insert("reward_terms".to_owned(), object(&terms));
    info.extend(spec.measures.iter().map(|measure| {
        let labels = measure.labels.iter();
        let description = format!("{} [{}]", measure.description, measure.unit);
        let items = labels.map(|label| json!({"title": label, "type": "number"}));
        (measure.name.to_owned(), list(&description, items))
    }));
    let ends = flags(&["terminated", "truncated"]).into_iter();
    object(&ends.chain([("info".to_owned(), object(&info))]).collect())
}

/// An object with these properties and no others.
fn object(properties: &Map<String, Value>) -> Value {
    let required: Vec<&String> = properties.keys().collect();
    let required = json!(required);
    json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn state(session: &Session) -> Value {
    json!({
        "title": "State",
        "type": "object",
        "properties": {
            "episode_id": {"type": ["string", "null"], "description": "Name of the episode."},
            "step_count": {"type": "integer", "minimum": 0, "description": "Steps since the reset."},
            "env": {"type": "string", "description": "Id of the environment."},
            "seed": {
                "type": ["integer", "null"],
                "description": "Seed of the reset; null if it had none.",
            },
            "case": {
                "description": "The case of the episode.",
                "anyOf": [case(session.task.case_parts()), {"type": "null"}],
            },
        },
        "required": ["episode_id", "step_count", "env", "seed", "case"],
        "additionalProperties": false,
    })
}

fn case(parts: &[CasePart]) -> Value {
    let properties: Map<String, Value> = parts.iter().map(case_part).collect();
    json!({"type": "object", "properties": properties, "additionalProperties": false})
}

fn case_part(part: &CasePart) -> (String, Value) {
    let mut kinds = vec![json!({"type": "null"})];
    if part.lengths.is_empty() {
        kinds.push(json!({"type": "boolean"}));
    }
    kinds.extend(part.lengths.iter().map(|&n| match n {
        0 => json!({"type": "number"}),
        n => json!({
            "type": "array",
            "minItems": n,
            "maxItems": n,
            "items": {"type": "number"},
        }),
    }));
    let description = match part.unit {
        "" => part.doc.to_owned(),
        unit => format!("{} [{unit}]", part.doc),
    };
    let schema = json!({"description": description, "anyOf": kinds});
    (part.name.to_owned(), schema)
}

/// What a reset may say. Options and parts of a case are those of the environment of this server.
pub(super) fn reset(session: &Session) -> Value {
    let ids: Vec<&str> = TASKS
        .iter()
        .flat_map(|task| task.environments)
        .map(|row| row.id)
        .collect();
    let options: Map<String, Value> = session.entry.options.iter().map(option).collect();
    let mut scenario = case(session.task.case_parts());
    scenario["description"] =
        json!("What to ask of the cases from now on; {} to ask nothing more.");
    json!({
        "title": "Reset",
        "type": "object",
        "properties": {
            "seed": {
                "type": "integer",
                "minimum": 0,
                "maximum": u64::MAX,
                "description": "Seed of Gymnasium's reset: it draws the same cases.",
            },
            "episode_id": {
                "type": "string",
                "maxLength": 255,
                "description": "Name of the episode; a random one if not given.",
            },
            "env": {
                "enum": ids,
                "description": "Id of another environment. With env, options or config the environment \
                                is made anew; what is not given is as the server was started.",
            },
            "options": {
                "type": "object",
                "properties": options,
                "description": "Options of the environment.",
            },
            "config": {
                "type": ["string", "object"],
                "description": "Name of a profile, or what differs from one; the paper's if not given.",
            },
            "scenario": scenario,
        },
        "additionalProperties": false,
    })
}

fn option(option: &OptionSpec) -> (String, Value) {
    let mut schema = match option.kind {
        OptionKind::Choice { values } => json!({"enum": values}),
        OptionKind::Flag => json!({"type": "boolean"}),
        OptionKind::Whole { low, high, .. } => {
            json!({"type": "integer", "minimum": low, "maximum": high})
        }
        OptionKind::Number { low, high } => {
            json!({"type": "number", "minimum": low, "maximum": high})
        }
        OptionKind::Numbers { low, high, .. } => json!({
            "type": "array",
            "minItems": 1,
            "items": {"type": "number", "minimum": low, "maximum": high},
        }),
    };
    if option.default == OptionDefault::Derived {
        schema = json!({"anyOf": [schema, {"type": "null"}]});
    }
    schema["description"] = json!(option.doc);
    (option.name.to_owned(), schema)
}
