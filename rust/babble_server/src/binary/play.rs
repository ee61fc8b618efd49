//! A client that plays the binary protocol.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::ws::Message;
use babble_env::AnyTask;
use serde_json::Value;
use tokio::sync::OwnedMutexGuard;
use tokio::time::{sleep, timeout};

use super::execute::execute;
use super::reply::encode;
use super::request::{Envelope, Request};
use crate::connection::{Connection, End, QUICK};
use crate::fault::{Fault, Kind};
use crate::metrics::Metrics;
use crate::server::{Server, told};
use crate::session::Session;
use crate::table::{Playing, SessionEntry};
use crate::wire::{Made, Make, Nothing};

/// Quick steps after which the next one is expected to be quick, too. Every second step of a batch may
/// only begin new episodes.
const QUICK_IN_A_ROW: u32 = 8;

/// Operation of a message that has none, in counters.
const UNKNOWN: &str = "unknown";

/// Plays a request: [`execute`], but for the test of what happens when it panics.
type Execute = fn(&mut Session, u64, Request) -> (Bytes, Option<Fault>);

/// A client's hold of a session.
struct Hold {
    entry: Arc<SessionEntry>,
    playing: OwnedMutexGuard<Playing>,
    /// Its place among the clients that took the session up.
    holder: u64,
}

/// Plays until the connection ends, then keeps the session for a while.
pub async fn play(mut connection: Connection, server: Arc<Server>) {
    let hold = match enter(&mut connection, &server).await {
        Ok(hold) => hold,
        Err(end) => return connection.close(end).await,
    };
    let (entry, holder) = (Arc::clone(&hold.entry), hold.holder);
    entry.admitted.connected.store(true, Ordering::Relaxed);
    let end = follow(&mut connection, &server, hold).await;
    match end {
        Ok(closed) => {
            forget(&entry, &server, closed.reason);
            connection.close_with(closed.code, closed.reason).await;
        }
        Err(End::Idle) => {
            forget(&entry, &server, End::Idle.name());
            connection.close(End::Idle).await;
        }
        Err(end) => {
            tracing::info!(
                session = entry.admitted.name,
                reason = end.name(),
                "disconnected"
            );
            connection.close(end).await;
            if end != End::TakenOver {
                outlive(&entry, holder, &server).await;
            }
        }
    }
}

/// Ends a session.
fn forget(entry: &SessionEntry, server: &Server, reason: &'static str) {
    server.table.end(entry);
    server.metrics.ended(reason);
    tracing::info!(session = entry.admitted.name, reason, "ended");
}

/// Keeps a session without a connection until a client resumes it, or none did in time.
async fn outlive(entry: &SessionEntry, holder: u64, server: &Server) {
    entry.admitted.connected.store(false, Ordering::Relaxed);
    let mut holders = entry.holder.subscribe();
    let mut draining = server.draining.subscribe();
    tokio::select! {
        () = told(&mut holders, |&now| now != holder) => {}
        () = sleep(server.limits().resume_time) => {
            forget(entry, server, "not resumed in time");
        }
        () = told(&mut draining, |&draining| draining) => {
            forget(entry, server, End::Draining.name());
        }
    }
}

/// Waits for `make` or `resume`.
async fn enter(connection: &mut Connection, server: &Arc<Server>) -> Result<Hold, End> {
    loop {
        let first = timeout(server.limits().handshake_time, connection.receive()).await;
        let began = Instant::now();
        let Envelope { id, request } = read(first.map_err(|_| End::Idle)??);
        let operation = request.as_ref().map_or(UNKNOWN, Request::operation);
        let held = match request {
            Ok(Request::Make(asked)) => make(connection, server, asked).await?,
            Ok(Request::Resume(asked)) => resume(server, &asked.key).await,
            Ok(other) => Err(Fault::new(
                Kind::SessionError,
                format!("{}: begin with make or resume", other.operation()),
            )),
            Err(fault) => Err(fault),
        };
        server
            .metrics
            .request(operation, began, held.as_ref().err());
        match held {
            Ok(hold) => {
                let made = Ok(made(&hold, server));
                connection.send(Message::Binary(encode(id, &made))).await?;
                return Ok(hold);
            }
            Err(fault) => {
                let refused = encode::<Nothing>(id, &Err(fault));
                connection.send(Message::Binary(refused)).await?;
            }
        }
    }
}

async fn make(
    connection: &mut Connection,
    server: &Arc<Server>,
    asked: Make,
) -> Result<Result<Hold, Fault>, End> {
    let client = connection.peer.address;
    let opener = Arc::clone(server);
    let open = move || {
        let made = catch_unwind(AssertUnwindSafe(|| opener.open(client, &asked)));
        made.unwrap_or_else(|_| {
            opener.metrics.panicked();
            Err(panicked())
        })
    };
    let opened = connection.during(tokio::task::spawn_blocking(open)).await?;
    let held = opened.and_then(|(session, admission)| {
        let entry = server.table.enter(session, admission)?;
        tracing::info!(
            session = entry.admitted.name,
            client = %client,
            env = entry.admitted.env(),
            envs = entry.admitted.envs,
            "made"
        );
        let playing = Arc::clone(&entry.playing).try_lock_owned();
        let playing = playing.map_err(|error| fault(&error))?;
        Ok(Hold {
            entry,
            playing,
            holder: 0,
        })
    });
    Ok(held)
}

/// Takes a session over, also from a client that holds it.
async fn resume(server: &Server, key: &str) -> Result<Hold, Fault> {
    let entry = server.table.find(key)?;
    let mut holder = 0;
    entry.holder.send_modify(|now| {
        *now += 1;
        holder = *now;
    });
    let longest = server.limits().request_time + QUICK;
    let playing = timeout(longest, Arc::clone(&entry.playing).lock_owned()).await;
    let playing = playing.map_err(|_| {
        let message = "the session's last request still runs; resume it again";
        Fault::new(Kind::LimitError, message)
    })?;
    tracing::info!(session = entry.admitted.name, "resumed");
    Ok(Hold {
        entry,
        playing,
        holder,
    })
}

fn made(hold: &Hold, server: &Server) -> Made {
    let limits = server.limits();
    let session = hold.playing.session.as_ref();
    let json = |value: Result<Value, serde_json::Error>| value.unwrap_or_default();
    let task = session.map(|session| &*session.task);
    Made {
        session: hold.entry.admitted.name.clone(),
        key: hold.entry.key.clone(),
        resume_s: limits.resume_time.as_secs_f64(),
        last: hold.playing.last,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        env: hold.entry.admitted.env(),
        task: session.map_or_else(String::new, |session| session.entry.name.to_owned()),
        num_envs: hold.entry.admitted.envs,
        autoreset: session.map_or_else(String::new, |session| session.autoreset.to_string()),
        threads: session.map_or(0, Session::threads),
        config: json(serde_json::to_value(task.map(AnyTask::config))),
        options: session.map_or(Value::Null, |session| session.options.clone().into()),
        spec: json(serde_json::to_value(session.map(|session| &session.spec))),
        quantities: task.map_or(Value::Null, AnyTask::quantities),
        limits: BTreeMap::from([
            ("message_bytes", limits.message_bytes as u64),
            ("picture_pixels", limits.picture_pixels),
        ]),
    }
}

/// How a session ended for good.
struct Closed {
    code: u16,
    reason: &'static str,
}

impl Closed {
    const ASKED: Self = Self {
        code: 1000,
        reason: "closed",
    };
    const FAULT: Self = Self {
        code: 1011,
        reason: "fault of the server",
    };
}

/// Plays the requests of a client that holds a session.
async fn follow(
    connection: &mut Connection,
    server: &Arc<Server>,
    mut hold: Hold,
) -> Result<Closed, End> {
    let mut holders = hold.entry.holder.subscribe();
    loop {
        let message = tokio::select! {
            message = connection.receive() => message?,
            () = told(&mut holders, |&now| now != hold.holder) => return Err(End::TakenOver),
        };
        let received = message_len(&message);
        let began = Instant::now();
        let Envelope { id, request } = read(message);
        let last = hold.playing.last;
        let mut closed = None;
        let reply = match id {
            Some(id) if id == last + 1 => {
                let closes = matches!(request, Ok(Request::Close(_)));
                hold = run(connection, server, hold, id, request, began).await?;
                if hold.playing.session.is_none() {
                    closed = Some(Closed::FAULT);
                } else if closes {
                    closed = Some(Closed::ASKED);
                }
                hold.playing.reply.clone()
            }
            Some(id) if id == last && id > 0 => hold.playing.reply.clone(),
            id => {
                let fault = misplaced(id, last, request);
                hold.playing
                    .admission
                    .admitted
                    .errors
                    .fetch_add(1, Ordering::Relaxed);
                server.metrics.request(UNKNOWN, began, Some(&fault));
                encode::<Nothing>(id, &Err(fault))
            }
        };
        server.metrics.bytes(received, reply.len());
        tokio::select! {
            sent = connection.send(Message::Binary(reply)) => sent?,
            () = told(&mut holders, |&now| now != hold.holder) => return Err(End::TakenOver),
        }
        if let Some(closed) = closed {
            return Ok(closed);
        }
    }
}

/// The error of a message whose id is not the next one.
fn misplaced(id: Option<u64>, last: u64, request: Result<Request, Fault>) -> Fault {
    match (id, request) {
        (None, Err(fault)) => fault,
        (id, _) => {
            let message = format!("id = {}: expected {}", id.unwrap_or_default(), last + 1);
            Fault::new(Kind::ProtocolError, message)
        }
    }
}

/// Executes a request once: its reply is kept, also if the connection ends meanwhile.
async fn run(
    connection: &mut Connection,
    server: &Arc<Server>,
    hold: Hold,
    id: u64,
    request: Result<Request, Fault>,
    began: Instant,
) -> Result<Hold, End> {
    let mut hold = hold;
    let here = match &request {
        Ok(Request::Step(_)) => hold.playing.quick_steps >= QUICK_IN_A_ROW,
        Ok(Request::Close(_)) | Err(_) => true,
        Ok(_) => false,
    };
    if here {
        run_now(
            &mut hold.playing,
            &server.metrics,
            id,
            request,
            began,
            execute,
        );
        return Ok(hold);
    }
    let counters = Arc::clone(server);
    let work = tokio::task::spawn_blocking(move || {
        run_now(
            &mut hold.playing,
            &counters.metrics,
            id,
            request,
            began,
            execute,
        );
        hold
    });
    connection.during(work).await
}

fn run_now(
    playing: &mut Playing,
    metrics: &Metrics,
    id: u64,
    request: Result<Request, Fault>,
    began: Instant,
    execute: Execute,
) {
    let operation = request.as_ref().map_or(UNKNOWN, Request::operation);
    let is_step = matches!(request, Ok(Request::Step(_)));
    let work = Instant::now();
    let (reply, fault) = match (request, &mut playing.session) {
        (Ok(request), Some(session)) => {
            attempt(session, id, request, execute).unwrap_or_else(|| {
                metrics.panicked();
                playing.session = None;
                refused(id, panicked())
            })
        }
        (Err(fault), _) => refused(id, fault),
        (Ok(_), None) => refused(id, panicked()),
    };
    let admitted = &playing.admission.admitted;
    if fault.is_some() {
        admitted.errors.fetch_add(1, Ordering::Relaxed);
    } else if is_step {
        admitted
            .steps
            .fetch_add(admitted.envs as u64, Ordering::Relaxed);
        metrics.steps(admitted.envs);
    }
    if is_step {
        let is_quick = work.elapsed() < QUICK;
        playing.quick_steps = if is_quick {
            playing.quick_steps.saturating_add(1)
        } else {
            0
        };
    }
    playing.last = id;
    playing.reply = reply;
    metrics.request(operation, began, fault.as_ref());
}

/// Nothing if the work panicked.
fn attempt(
    session: &mut Session,
    id: u64,
    request: Request,
    execute: Execute,
) -> Option<(Bytes, Option<Fault>)> {
    let work = || session.timed(|session| execute(session, id, request));
    catch_unwind(AssertUnwindSafe(work)).ok()
}

fn refused(id: u64, fault: Fault) -> (Bytes, Option<Fault>) {
    let refused = Err(fault);
    (encode::<Nothing>(Some(id), &refused), refused.err())
}

fn panicked() -> Fault {
    let message = "the server has a fault: please report it; the session ended";
    Fault::new(Kind::ServerError, message)
}

fn fault(error: &impl std::fmt::Display) -> Fault {
    Fault::new(Kind::ServerError, error.to_string())
}

fn message_len(message: &Message) -> usize {
    match message {
        Message::Binary(bytes) => bytes.len(),
        Message::Text(text) => text.len(),
        _ => 0,
    }
}

fn read(message: Message) -> Envelope {
    match message {
        Message::Binary(bytes) => Envelope::read(&bytes),
        _ => Envelope {
            id: None,
            request: Err(Fault::new(
                Kind::ProtocolError,
                "this subprotocol has binary messages only",
            )),
        },
    }
}

#[cfg(test)]
mod tests {
    use std::net::{IpAddr, Ipv4Addr};
    use std::time::Instant;

    use clap::Parser;

    use crate::binary::execute::execute;
    use crate::binary::play::run_now;
    use crate::binary::request::Request;
    use crate::options::Cli;
    use crate::server::Server;
    use crate::wire::{Make, Reset};

    const CLIENT: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

    #[test]
    fn a_panic_ends_its_session_alone_and_is_counted() {
        let server = Server::new(Cli::parse_from([""]).options).unwrap();
        let make = r#"{"env": "BabbleReach-v0"}"#;
        let make: Make = serde_json::from_str(make).unwrap();
        let entries = [0, 1].map(|_| {
            let (session, admission) = server.open(CLIENT, &make).unwrap();
            server.table.enter(session, admission).unwrap()
        });
        let [broken, whole] = &entries;
        let reset = |entry: &crate::table::SessionEntry, id, execute| {
            let mut playing = entry.playing.try_lock().unwrap();
            let request = Ok(Request::Reset(Reset::default()));
            let now = Instant::now();
            run_now(&mut playing, &server.metrics, id, request, now, execute);
            (
                playing.session.is_some(),
                String::from_utf8_lossy(&playing.reply).into_owned(),
            )
        };
        let (is_there, reply) = reset(broken, 1, |_, _, _| panic!("as a test"));
        assert!(!is_there && reply.contains("ServerError"), "{reply}");
        // Whoever still asks gets the same answer.
        let (_, reply) = reset(broken, 2, execute);
        assert!(reply.contains("ServerError"), "{reply}");
        let (is_there, reply) = reset(whole, 1, execute);
        assert!(is_there && !reply.contains("error"), "{reply}");
        assert_eq!(server.metrics.faults(), 1);
        server.table.end(broken);
        drop(entries);
        assert_eq!(server.admissions.counts(), (1, 1));
    }
}
