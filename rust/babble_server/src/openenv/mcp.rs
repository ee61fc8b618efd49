//! JSON-RPC of the Model Context Protocol, as far as OpenEnv asks for it: there are no tools.

use serde::Deserialize;
use serde_json::{Map, Value, json};

/// Codes of JSON-RPC 2.0.
const PARSE_ERROR: i64 = -32700;
const INVALID_REQUEST: i64 = -32600;
const METHOD_NOT_FOUND: i64 = -32601;
const INVALID_PARAMS: i64 = -32602;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    jsonrpc: String,
    method: String,
    #[serde(default)]
    params: Map<String, Value>,
    #[serde(default)]
    id: Value,
}

/// Reply to the body of a request.
pub(super) fn answer_bytes(body: &[u8]) -> Value {
    match serde_json::from_slice(body) {
        Ok(request) => answer(request),
        Err(error) => refused(&Value::Null, PARSE_ERROR, &format!("Parse error: {error}")),
    }
}

/// Reply to a request.
pub(super) fn answer(request: Value) -> Value {
    let request: Request = match serde_json::from_value(request) {
        Ok(request) => request,
        Err(error) => return invalid(&error.to_string()),
    };
    let id = &request.id;
    if request.jsonrpc != "2.0" {
        return invalid("jsonrpc must be \"2.0\"");
    }
    if !(id.is_null() || id.is_string() || id.is_i64() || id.is_u64()) {
        return invalid("id must be a string or a whole number");
    }
    match &request.method[..] {
        "tools/list" => json!({"jsonrpc": "2.0", "id": id, "result": {"tools": []}}),
        "tools/call" => {
            let name = request.params.get("name").unwrap_or(&Value::Null);
            let message = format!("Tool not found: {name}: there are no tools");
            refused(id, INVALID_PARAMS, &message)
        }
        other => refused(id, METHOD_NOT_FOUND, &format!("Method not found: {other}")),
    }
}

fn invalid(problem: &str) -> Value {
    let message = format!("Invalid request: {problem}");
    refused(&Value::Null, INVALID_REQUEST, &message)
}

fn refused(id: &Value, code: i64, message: &str) -> Value {
    json!({"jsonrpc": "2.0", "id": id, "error": {"code": code, "message": message, "data": null}})
}
