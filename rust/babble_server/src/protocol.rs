//! The binary protocol as data, from which its page is made.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use crate::binary::request::OPERATIONS;
use crate::fault::Fault;
use crate::wire::SUBPROTOCOL;

/// All operations with the names of their messages, and a schema for each message, as JSON.
#[must_use]
pub fn json() -> String {
    let settings = SchemaSettings::draft2020_12();
    let mut requests = settings.clone().into_generator();
    let mut replies = settings.for_serialize().into_generator();
    let name = |schema: &Value| {
        let reference = schema["$ref"].as_str().unwrap_or_default();
        reference.rsplit('/').next().unwrap_or_default().to_owned()
    };
    let operations: Vec<Value> = OPERATIONS
        .iter()
        .map(|operation| {
            let request = (operation.request)(&mut requests);
            let reply = (operation.reply)(&mut replies);
            json!({
                "name": operation.name,
                "does": operation.does,
                "request": name(request.as_value()),
                "reply": name(reply.as_value()),
            })
        })
        .collect();
    let fault = replies.subschema_for::<Fault>();
    let document = json!({
        "subprotocol": SUBPROTOCOL,
        "operations": operations,
        "error": name(fault.as_value()),
        "requests": requests.take_definitions(true),
        "replies": replies.take_definitions(true),
    });
    format!("{document:#}")
}
