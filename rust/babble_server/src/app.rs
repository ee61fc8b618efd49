//! The routes.

use std::sync::Arc;

use axum::Router;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Extension, State};
use axum::http::header::{CONTENT_TYPE, SEC_WEBSOCKET_PROTOCOL};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use crate::connection::Connection;
use crate::fault::Fault;
use crate::server::{Peer, Server};
use crate::wire::SUBPROTOCOL;
use crate::{binary, gate, openenv, page};

/// Bytes that are read at once: most messages are shorter.
const READ_BUFFER: usize = 16 << 10;

/// All routes.
///
/// # Errors
/// [`Fault`] for options that the served environment does not have.
pub(crate) fn routes(server: Arc<Server>) -> Result<Router, Fault> {
    Ok(openenv::routes(&server)?
        .route("/", get(page::status))
        .route("/status.css", get(page::style))
        .route("/metrics", get(metrics))
        .route("/ws", get(web_socket))
        .layer(from_fn_with_state(Arc::clone(&server), gate::check))
        .with_state(server))
}

/// For Prometheus.
async fn metrics(State(server): State<Arc<Server>>) -> impl IntoResponse {
    let text = server.metrics.text(server.admissions.counts());
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    ([(CONTENT_TYPE, kind)], text)
}

/// The binary protocol for clients that ask for its subprotocol, and OpenEnv's for those that ask for
/// none.
async fn web_socket(
    State(server): State<Arc<Server>>,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    let longest = server.limits().message_bytes;
    let upgrade = upgrade
        .protocols([SUBPROTOCOL])
        .read_buffer_size(READ_BUFFER)
        .max_message_size(longest)
        .max_frame_size(longest);
    let is_binary = upgrade.selected_protocol().is_some();
    if !is_binary && headers.contains_key(SEC_WEBSOCKET_PROTOCOL) {
        let message = format!("the only subprotocol is {SUBPROTOCOL}; OpenEnv's JSON has none\n");
        return (StatusCode::BAD_REQUEST, message).into_response();
    }
    upgrade.on_upgrade(move |socket| async move {
        let connection = Connection::new(socket, peer, &server);
        if is_binary {
            binary::play(connection, server).await;
        } else {
            openenv::play(connection, server).await;
        }
    })
}
