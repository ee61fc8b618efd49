//! OpenEnv's routes over HTTP.

use std::sync::Arc;
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::{Extension, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde_json::{Value, json};

use super::message::{Code, Refusal, Reset, read_action};
use super::player::check_size;
use super::{Mode, Player, mcp, openapi, schema};
use crate::fault::{Fault, Kind};
use crate::server::{Peer, Server};
use crate::session::Session;

/// What does not change while the server runs.
#[derive(Debug)]
struct Documents {
    metadata: Value,
    schema: Value,
    openapi: Value,
    state: String,
}

/// OpenEnv's routes, except `/ws`.
///
/// # Errors
/// [`Fault`] for options that the served environment does not have.
pub(crate) fn routes(server: &Arc<Server>) -> Result<Router<Arc<Server>>, Fault> {
    let served = &server.options.served;
    let session = Session::make(&served.make(), server.limits(), 1)?;
    check_size(&session, server.limits())?;
    let mode = served.openenv_mode;
    let metadata = json!({
        "name": session.env,
        "description": session.entry.doc,
        "version": env!("CARGO_PKG_VERSION"),
        "documentation_url": env!("CARGO_PKG_REPOSITORY"),
    });
    let (schema, openapi) = (schema::schemas(&session), openapi::openapi(&session, mode));
    let player = Player::new(served.clone(), server.limits().clone(), session);
    let state = player
        .state_json()
        .map_err(|refusal| Fault::new(Kind::ServerError, refusal.message))?;
    let documents = Arc::new(Documents {
        metadata,
        schema,
        openapi,
        state,
    });
    let document = |part: fn(&Documents) -> &Value| {
        let documents = Arc::clone(&documents);
        get(move || async move { Json(part(&documents).clone()) })
    };
    let always = Router::new()
        .route(
            "/health",
            get(|| async { Json(json!({"status": "healthy"})) }),
        )
        .route("/metadata", document(|all| &all.metadata))
        .route("/schema", document(|all| &all.schema))
        .route("/openapi.json", document(|all| &all.openapi))
        .route(
            "/mcp",
            post(|body: Bytes| async move { Json(mcp::answer_bytes(&body)) }),
        );
    if mode == Mode::Production {
        return Ok(always);
    }
    let state = move || async move { as_json(documents.state.clone()) };
    Ok(always
        .route("/reset", post(reset))
        .route("/step", post(step))
        .route("/state", get(state)))
}

/// The first observation of an episode that ends with the request.
async fn reset(
    State(server): State<Arc<Server>>,
    Extension(peer): Extension<Peer>,
    body: Bytes,
) -> Response {
    let (began, counters) = (Instant::now(), Arc::clone(&server));
    let work = move || -> Result<String, Refusal> {
        let asked = if body.is_empty() {
            Reset::default()
        } else {
            Reset::read(read(&body)?)?
        };
        let served = &server.options.served;
        let (session, _admission) = server
            .open(peer.address, &served.make())
            .map_err(|fault| no_session(&server, fault))?;
        Player::new(served.clone(), server.limits().clone(), session).first(asked)
    };
    let done = tokio::task::spawn_blocking(work).await.unwrap_or_else(|_| {
        counters.metrics.panicked();
        Err(Refusal::new(Code::SessionError, "the server has a fault"))
    });
    let fault = done.as_ref().err().map(Refusal::fault);
    counters
        .metrics
        .request("openenv_reset", began, fault.as_ref());
    match done {
        Ok(shown) => as_json(shown),
        Err(refusal) => refused(&refusal),
    }
}

/// Each request has an environment of its own, which no reset has begun.
async fn step(body: Bytes) -> Response {
    let checked = read(&body).and_then(|mut asked| read_action(asked["action"].take()));
    if let Err(refusal) = checked {
        return refused(&refusal);
    }
    let message = "over HTTP each request has an environment of its own, so there is no episode to \
                   step: play it on the WebSocket /ws";
    (StatusCode::CONFLICT, Json(json!({"detail": message}))).into_response()
}

fn read(body: &[u8]) -> Result<Value, Refusal> {
    let invalid = |error| Refusal::new(Code::InvalidJson, format!("Invalid JSON: {error}"));
    let value: Value = serde_json::from_slice(body).map_err(invalid)?;
    if value.is_object() {
        return Ok(value);
    }
    let message = "the body must be an object";
    Err(Refusal::new(Code::ValidationError, message))
}

fn as_json(text: String) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

fn refused(refusal: &Refusal) -> Response {
    let status = match refusal.code {
        Code::InvalidJson | Code::UnknownType | Code::ValidationError => {
            StatusCode::UNPROCESSABLE_ENTITY
        }
        Code::CapacityReached => StatusCode::SERVICE_UNAVAILABLE,
        Code::ExecutionError | Code::FactoryError | Code::SessionError => {
            StatusCode::INTERNAL_SERVER_ERROR
        }
    };
    (status, Json(json!({"detail": refusal.message}))).into_response()
}

/// Why a client gets no session, as OpenEnv says it.
pub(super) fn no_session(server: &Server, fault: Fault) -> Refusal {
    let code = match fault.kind {
        Kind::LimitError => Code::CapacityReached,
        Kind::SessionError => Code::SessionError,
        _ => Code::FactoryError,
    };
    let mut refusal = Refusal::new(code, fault.message);
    if code == Code::CapacityReached {
        refusal.active_sessions = Some(server.admissions.counts().0);
        refusal.max_sessions = Some(server.limits().sessions);
    }
    refusal
}
