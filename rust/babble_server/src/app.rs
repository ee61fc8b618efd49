//! The routes.

use std::sync::Arc;

use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Extension, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Router, body};

use crate::binary;
use crate::connection::Connection;
use crate::gate;
use crate::page;
use crate::server::{Peer, Server};
use crate::wire::SUBPROTOCOL;

/// Bytes that are read at once: most messages are shorter.
const READ_BUFFER: usize = 16 << 10;

/// All routes.
pub(crate) fn routes(server: Arc<Server>) -> Router {
    Router::new()
        .route("/", get(page::status))
        .route("/status.css", get(page::style))
        .route("/metrics", get(metrics))
        .route("/ws", get(web_socket))
        .layer(from_fn_with_state(Arc::clone(&server), gate::check))
        .with_state(server)
}

/// For Prometheus.
async fn metrics(State(server): State<Arc<Server>>) -> impl IntoResponse {
    let text = server.metrics.text(server.admissions.counts());
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    ([(CONTENT_TYPE, kind)], text)
}

/// The binary protocol for clients that ask for its subprotocol.
async fn web_socket(
    State(server): State<Arc<Server>>,
    Extension(peer): Extension<Peer>,
    upgrade: WebSocketUpgrade,
) -> Response {
    let longest = server.limits().message_bytes;
    let upgrade = upgrade
        .protocols([SUBPROTOCOL])
        .read_buffer_size(READ_BUFFER)
        .max_message_size(longest)
        .max_frame_size(longest);
    if upgrade.selected_protocol().is_none() {
        // Here OpenEnv's JSON will be played.
        let body = body::Body::from("this WebSocket has the subprotocol gym-babble.v1");
        return (StatusCode::BAD_REQUEST, body).into_response();
    }
    upgrade.on_upgrade(move |socket| {
        let connection = Connection::new(socket, peer, &server);
        binary::play(connection, server)
    })
}
