//! A client that plays the binary protocol.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::Message;
use babble_env::AnyTask;
use serde_json::Value;
use tokio::sync::OwnedMutexGuard;
use tokio::time::{sleep, timeout};

use super::execute::execute;
use super::reply::encode;
use super::request::{Envelope, Request};
use crate::connection::{Connection, End};
use crate::fault::{Fault, Kind};
use crate::server::{Server, told};
use crate::session::Session;
use crate::table::{Playing, SessionEntry};
use crate::wire::{Made, Make, Nothing};

/// A step that takes longer is not done in the thread that serves connections.
const QUICK: Duration = Duration::from_millis(1);

type Guard = OwnedMutexGuard<Playing>;

/// A client's hold of a session.
struct Hold {
    entry: Arc<SessionEntry>,
    playing: Guard,
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
    let end = follow(&mut connection, hold).await;
    match end {
        Ok(closed) => {
            server.table.end(&entry);
            connection.close_with(closed.code, closed.reason).await;
        }
        Err(end) => {
            tracing::info!(session = entry.admitted.name, ?end, "disconnected");
            connection.close(end).await;
            if end == End::Idle {
                server.table.end(&entry);
            } else if end != End::TakenOver {
                outlive(&entry, holder, &server).await;
            }
        }
    }
}

/// Keeps a session without a connection until a client resumes it, or none did in time.
async fn outlive(entry: &SessionEntry, holder: u64, server: &Server) {
    entry.admitted.connected.store(false, Ordering::Relaxed);
    let mut holders = entry.holder.subscribe();
    let mut draining = server.draining.subscribe();
    tokio::select! {
        () = told(&mut holders, |&now| now != holder) => {}
        () = sleep(server.limits().resume_time) => {
            tracing::info!(session = entry.admitted.name, "not resumed in time");
            server.table.end(entry);
        }
        () = told(&mut draining, |&draining| draining) => server.table.end(entry),
    }
}

/// Waits for `make` or `resume`.
async fn enter(connection: &mut Connection, server: &Arc<Server>) -> Result<Hold, End> {
    loop {
        let first = timeout(server.limits().handshake_time, connection.receive()).await;
        let envelope = read(first.map_err(|_| End::Idle)??);
        let id = envelope.id;
        let held = match envelope.request {
            Ok(Request::Make(asked)) => make(connection, server, asked).await?,
            Ok(Request::Resume(asked)) => resume(server, &asked.key).await,
            Ok(other) => Err(Fault::new(
                Kind::SessionError,
                format!("{}: begin with make or resume", other.operation()),
            )),
            Err(fault) => Err(fault),
        };
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
        catch_unwind(AssertUnwindSafe(|| opener.open(client, &asked)))
            .unwrap_or_else(|_| panicked())
    };
    let opened = connection.during(tokio::task::spawn_blocking(open)).await?;
    let held = opened.and_then(|(session, admission)| {
        let entry = server.table.enter(session, admission)?;
        tracing::info!(
            session = entry.admitted.name,
            client = %client,
            env = entry.admitted.env,
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
        Fault::new(Kind::SessionError, message)
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
        env: hold.entry.admitted.env.clone(),
        task: session.map_or_else(String::new, |session| session.entry.name.to_owned()),
        num_envs: hold.entry.admitted.envs,
        autoreset: session.map_or_else(String::new, |session| session.autoreset.to_string()),
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
        reason: "the server has a fault, and the session ended",
    };
}

/// Plays the requests of a client that holds a session.
async fn follow(connection: &mut Connection, mut hold: Hold) -> Result<Closed, End> {
    let mut holders = hold.entry.holder.subscribe();
    loop {
        let message = tokio::select! {
            message = connection.receive() => message?,
            () = told(&mut holders, |&now| now != hold.holder) => return Err(End::TakenOver),
        };
        let envelope = read(message);
        let playing = &hold.playing;
        let reply = match envelope.id {
            Some(id) if id == playing.last + 1 => {
                let closes = matches!(envelope.request, Ok(Request::Close(_)));
                let reply;
                (hold, reply) = run(connection, hold, id, envelope.request).await?;
                if hold.playing.session.is_none() || closes {
                    connection.send(Message::Binary(reply)).await?;
                    return Ok(if closes { Closed::ASKED } else { Closed::FAULT });
                }
                reply
            }
            Some(id) if id == playing.last && id > 0 => playing.reply.clone(),
            id => {
                let next = playing.last + 1;
                let fault = envelope.request.err().filter(|_| id.is_none());
                let fault = fault.unwrap_or_else(|| {
                    let message = format!("id = {}: expected {next}", id.unwrap_or_default());
                    Fault::new(Kind::ProtocolError, message)
                });
                hold.entry.admitted.errors.fetch_add(1, Ordering::Relaxed);
                encode::<Nothing>(id, &Err(fault))
            }
        };
        connection.send(Message::Binary(reply)).await?;
    }
}

/// Executes a request once: its reply is kept, also if the connection ends meanwhile.
async fn run(
    connection: &mut Connection,
    hold: Hold,
    id: u64,
    request: Result<Request, Fault>,
) -> Result<(Hold, Bytes), End> {
    let Hold {
        entry,
        mut playing,
        holder,
    } = hold;
    let here = match &request {
        Ok(Request::Step(_)) => playing.is_quick,
        Ok(Request::Close(_)) | Err(_) => true,
        Ok(_) => false,
    };
    if here {
        run_now(&mut playing, id, request);
    } else {
        let work = tokio::task::spawn_blocking(move || {
            run_now(&mut playing, id, request);
            playing
        });
        playing = connection.during(work).await?;
    }
    let reply = playing.reply.clone();
    let hold = Hold {
        entry,
        playing,
        holder,
    };
    Ok((hold, reply))
}

fn run_now(playing: &mut Playing, id: u64, request: Result<Request, Fault>) {
    let began = Instant::now();
    let steps = matches!(request, Ok(Request::Step(_)));
    let (reply, fault) = match (request, &mut playing.session) {
        (Ok(request), Some(session)) => attempt(session, id, request).unwrap_or_else(|| {
            playing.session = None;
            refused(id, panicked::<Nothing>().err())
        }),
        (Err(fault), _) => refused(id, Some(fault)),
        (Ok(_), None) => refused(id, panicked::<Nothing>().err()),
    };
    let admitted = &playing.admission.admitted;
    if fault.is_some() {
        admitted.errors.fetch_add(1, Ordering::Relaxed);
    } else if steps {
        admitted
            .steps
            .fetch_add(admitted.envs as u64, Ordering::Relaxed);
    }
    if steps {
        playing.is_quick = began.elapsed() < QUICK;
    }
    playing.last = id;
    playing.reply = reply;
}

/// Nothing if the work panicked.
fn attempt(session: &mut Session, id: u64, request: Request) -> Option<(Bytes, Option<Fault>)> {
    let work = || session.timed(|session| execute(session, id, request));
    catch_unwind(AssertUnwindSafe(work)).ok()
}

fn refused(id: u64, fault: Option<Fault>) -> (Bytes, Option<Fault>) {
    let refused = fault.clone().map_or(Ok(Nothing {}), Err);
    (encode(Some(id), &refused), fault)
}

fn panicked<T>() -> Result<T, Fault> {
    let message = "the server has a fault: please report it; the session ended";
    Err(Fault::new(Kind::ServerError, message))
}

fn fault(error: &impl std::fmt::Display) -> Fault {
    Fault::new(Kind::ServerError, error.to_string())
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
