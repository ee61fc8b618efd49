//! OpenEnv's WebSocket.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use axum::extract::ws::Message;

use super::http::no_session;
use super::message::{Code, Refusal};
use super::player::Player;
use crate::admission::Admission;
use crate::connection::{Connection, End, QUICK};
use crate::server::Server;

/// A client's episode.
#[derive(Debug)]
struct Playing {
    player: Player,
    /// Whether the message before took so short that the next one is done in the same thread.
    is_quick: bool,
    /// Given back when the session ends.
    admission: Admission,
}

/// Plays a connection to its end.
pub(crate) async fn play(mut connection: Connection, server: Arc<Server>) {
    let ended = match begin(&mut connection, &server).await {
        Ok(Ok(playing)) => {
            let admitted = Arc::clone(&playing.admission.admitted);
            let session = &admitted.name;
            tracing::info!(session, client = %admitted.client, env = admitted.env(), "made for OpenEnv");
            let ended = follow(&mut connection, &server, playing).await;
            let reason = ended
                .as_ref()
                .map_or_else(|end| end.name(), |closed| closed.1);
            server.metrics.ended(reason);
            tracing::info!(session, reason, "ended");
            ended
        }
        Ok(Err(refusal)) => refuse(&mut connection, &refusal)
            .await
            .map(|()| (1013, "no session")),
        Err(end) => Err(end),
    };
    match ended {
        Ok((code, reason)) => connection.close_with(code, reason).await,
        Err(end) => connection.close(end).await,
    }
}

async fn refuse(connection: &mut Connection, refusal: &Refusal) -> Result<(), End> {
    connection.send(Message::Text(refusal.text().into())).await
}

async fn begin(
    connection: &mut Connection,
    server: &Arc<Server>,
) -> Result<Result<Playing, Refusal>, End> {
    let (server, address) = (Arc::clone(server), connection.peer.address);
    let work = tokio::task::spawn_blocking(move || {
        let served = &server.options.served;
        let opened = server.open(address, &served.make());
        let (session, admission) = opened.map_err(|fault| no_session(&server, fault))?;
        Ok(Playing {
            player: Player::new(served.clone(), server.limits().clone(), session),
            is_quick: false,
            admission,
        })
    });
    connection.during(work).await
}

/// Answers messages until the client ends the session.
async fn follow(
    connection: &mut Connection,
    server: &Arc<Server>,
    mut playing: Playing,
) -> Result<(u16, &'static str), End> {
    loop {
        let Message::Text(text) = connection.receive().await? else {
            let message = "Invalid JSON: messages are text, not binary";
            refuse(connection, &Refusal::new(Code::InvalidJson, message)).await?;
            continue;
        };
        let received = text.len();
        let answered;
        if playing.is_quick {
            answered = answer(&mut playing, server, &text);
        } else {
            let server = Arc::clone(server);
            let work = tokio::task::spawn_blocking(move || {
                let answered = answer(&mut playing, &server, &text);
                (playing, answered)
            });
            (playing, answered) = connection.during(work).await?;
        }
        let reply = match answered {
            Ok(Some(reply)) => reply,
            Ok(None) => return Ok((1000, "closed")),
            Err(Panicked) => {
                let message = "the server has a fault: please report it; the session ended";
                refuse(connection, &Refusal::new(Code::SessionError, message)).await?;
                return Ok((1011, "the server has a fault, and the session ended"));
            }
        };
        server.metrics.bytes(received, reply.len());
        connection.send(Message::Text(reply.into())).await?;
    }
}

/// The work had a fault, after which the environment cannot be used.
struct Panicked;

/// The reply to a message; none if it ends the session.
fn answer(playing: &mut Playing, server: &Server, text: &str) -> Result<Option<String>, Panicked> {
    let (began, before) = (Instant::now(), playing.player.steps());
    let work = || playing.player.answer(text);
    let Ok(reply) = catch_unwind(AssertUnwindSafe(work)) else {
        server.metrics.panicked();
        return Err(Panicked);
    };
    let Some(reply) = reply else { return Ok(None) };
    let admitted = &playing.admission.admitted;
    admitted.plays(playing.player.env());
    // A step adds one, and a reset begins at none.
    let steps = playing.player.steps().saturating_sub(before);
    admitted.steps.fetch_add(steps, Ordering::Relaxed);
    server.metrics.steps(steps as usize);
    let fault = reply.result.as_ref().err().map(Refusal::fault);
    if fault.is_some() {
        admitted.errors.fetch_add(1, Ordering::Relaxed);
    }
    server
        .metrics
        .request(reply.operation, began, fault.as_ref());
    playing.is_quick = began.elapsed() < QUICK;
    Ok(Some(reply.result.unwrap_or_else(|refusal| refusal.text())))
}
