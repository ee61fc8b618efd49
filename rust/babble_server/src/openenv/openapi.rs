//! The HTTP routes as a document of `OpenAPI`.

use serde_json::{Map, Value, json};

use super::{Mode, schema};
use crate::session::Session;

/// Version of OpenEnv's HTTP interface.
const INTERFACE: &str = "1.0.0";

/// The document of `/openapi.json`.
pub(super) fn openapi(session: &Session, mode: Mode) -> Value {
    let mut paths = documents();
    if mode == Mode::Simulation {
        paths.extend(control());
    }
    let mut schemas = schema::schemas(session);
    schemas["reset"] = schema::reset(session);
    schemas["result"] = result();
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": format!("gym-babble {}: {}", env!("CARGO_PKG_VERSION"), session.env),
            "version": INTERFACE,
            "description": "OpenEnv's interface. Episodes are played on the WebSocket /ws.",
        },
        "paths": paths,
        "components": {"schemas": schemas},
    })
}

/// What all modes have.
fn documents() -> Map<String, Value> {
    let text = || json!({"type": "string"});
    let health = json!({
        "type": "object",
        "properties": {"status": {"enum": ["healthy"]}},
        "required": ["status"],
    });
    let metadata = json!({
        "type": "object",
        "properties": {
            "name": text(),
            "description": text(),
            "version": text(),
            "documentation_url": text(),
        },
        "required": ["name", "description"],
    });
    let object = json!({"type": "object"});
    Map::from_iter([
        get("/health", "Whether the server can be used.", &health),
        get("/metadata", "What the environment is.", &metadata),
        get(
            "/schema",
            "Schemas of actions, observations and states.",
            &object,
        ),
        post(
            "/mcp",
            "JSON-RPC of the Model Context Protocol; there are no tools.",
            &object,
            &object,
        ),
    ])
}

/// What production does not have.
fn control() -> Map<String, Value> {
    let part = |name: &str| json!({"$ref": format!("#/components/schemas/{name}")});
    let step = json!({
        "type": "object",
        "properties": {"action": part("action")},
        "required": ["action"],
    });
    let (first, never) = (
        "The first observation of an episode, which ends with the request.",
        "Always refused: an episode is played on the WebSocket /ws.",
    );
    Map::from_iter([
        post("/reset", first, &part("reset"), &part("result")),
        post("/step", never, &step, &part("result")),
        get("/state", "The state before a reset.", &part("state")),
    ])
}

fn get(path: &str, summary: &str, reply: &Value) -> (String, Value) {
    (path.to_owned(), json!({"get": operation(summary, reply)}))
}

fn post(path: &str, summary: &str, body: &Value, reply: &Value) -> (String, Value) {
    let mut operation = operation(summary, reply);
    operation["requestBody"] = json!({"content": {"application/json": {"schema": body}}});
    (path.to_owned(), json!({"post": operation}))
}

fn operation(summary: &str, reply: &Value) -> Value {
    json!({
        "summary": summary,
        "responses": {
            "200": {"description": "Done.", "content": {"application/json": {"schema": reply}}},
            "default": {"description": "An error, which detail describes."},
        },
    })
}

/// What `/reset` answers: reward and end stand beside the observation.
fn result() -> Value {
    json!({
        "type": "object",
        "properties": {
            "observation": {"type": "object"},
            "reward": {"type": ["number", "null"]},
            "done": {"type": "boolean"},
            "metadata": {"type": "object"},
        },
        "required": ["observation", "reward", "done"],
    })
}
