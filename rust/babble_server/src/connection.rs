//! A WebSocket with pings, deadlines and the server's stop.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::ws::{CloseFrame, Message, WebSocket};
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::{Interval, MissedTickBehavior, interval_at, timeout};

use crate::server::{Peer, Server, told};

/// Work that takes longer is not done in the thread that serves connections.
pub(crate) const QUICK: Duration = Duration::from_millis(1);
/// Pings without an answer after which a client counts as gone.
pub(crate) const UNANSWERED: u32 = 2;

/// Why a connection ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The client closed it, it broke, or what came was no WebSocket message.
    Closed,
    /// A message was too long.
    TooLong,
    /// Pings were not answered, or replies not read.
    Dead,
    /// No request came for too long.
    Idle,
    /// Another client resumed the session.
    TakenOver,
    /// The server is being stopped.
    Draining,
}

/// A WebSocket of a client.
#[derive(Debug)]
pub struct Connection {
    socket: WebSocket,
    /// The other end.
    pub peer: Peer,
    ping: Interval,
    ping_time: Duration,
    idle_time: Duration,
    unanswered: u32,
    last_request: Instant,
    draining: watch::Receiver<bool>,
    /// A message that came during long work.
    pending: Option<Message>,
}

impl End {
    /// Its name in counters and the log.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::TooLong => "message too long",
            Self::Dead => "no answer",
            Self::Idle => "idle",
            Self::TakenOver => "resumed elsewhere",
            Self::Draining => "server stopped",
        }
    }
}

impl Connection {
    /// A connection that was just made.
    #[must_use]
    pub fn new(socket: WebSocket, peer: Peer, server: &Arc<Server>) -> Self {
        let limits = server.limits();
        let period = limits.ping_time.min(limits.idle_time);
        let mut ping = interval_at(tokio::time::Instant::now() + period, period);
        ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
        Self {
            socket,
            peer,
            ping,
            ping_time: limits.ping_time,
            idle_time: limits.idle_time,
            unanswered: 0,
            last_request: Instant::now(),
            draining: server.draining.subscribe(),
            pending: None,
        }
    }

    /// The next request, binary or text.
    ///
    /// # Errors
    /// [`End`] when there is none.
    pub async fn receive(&mut self) -> Result<Message, End> {
        if let Some(message) = self.pending.take() {
            self.last_request = Instant::now();
            return Ok(message);
        }
        loop {
            tokio::select! {
                message = self.socket.recv() => {
                    self.unanswered = 0;
                    if let Some(message) = read(message)? {
                        self.last_request = Instant::now();
                        return Ok(message);
                    }
                }
                _ = self.ping.tick() => {
                    if self.last_request.elapsed() >= self.idle_time {
                        return Err(End::Idle);
                    }
                    self.send_ping().await?;
                }
                () = told(&mut self.draining, |&draining| draining) => return Err(End::Draining),
            }
        }
    }

    /// Waits for work in another thread, and answers pings meanwhile. The work goes on if the
    /// connection ends.
    ///
    /// # Errors
    /// [`End`] if the connection ends first.
    pub async fn during<T>(&mut self, mut work: JoinHandle<T>) -> Result<T, End> {
        loop {
            tokio::select! {
                done = &mut work => {
                    self.last_request = Instant::now();
                    return done.map_err(|_| End::Closed);
                }
                message = self.socket.recv(), if self.pending.is_none() => {
                    self.unanswered = 0;
                    self.pending = read(message)?;
                }
                _ = self.ping.tick() => self.send_ping().await?,
            }
        }
    }

    async fn send_ping(&mut self) -> Result<(), End> {
        // A client that waits for its reply with another request is not asked.
        if self.unanswered >= UNANSWERED && self.pending.is_none() {
            return Err(End::Dead);
        }
        self.unanswered += 1;
        self.send(Message::Ping(axum::body::Bytes::new())).await
    }

    /// Sends a message. One at a time is on its way, so a client that does not read costs no memory.
    ///
    /// # Errors
    /// [`End`] if the client does not take it in time.
    pub async fn send(&mut self, message: Message) -> Result<(), End> {
        match timeout(UNANSWERED * self.ping_time, self.socket.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) => Err(End::Closed),
            Err(_) => Err(End::Dead),
        }
    }

    /// Closes the connection, if the client is still there to be told why.
    pub async fn close(mut self, end: End) {
        let (code, reason) = match end {
            End::Closed | End::Dead => return,
            End::TooLong => (1009, "the message is longer than this server allows"),
            End::Idle => (1000, "no request came for too long"),
            End::TakenOver => (1000, "another client resumed the session"),
            End::Draining => (1001, "the server is being stopped"),
        };
        self.close_with(code, reason).await;
    }

    /// Closes the connection with a code of RFC 6455.
    pub async fn close_with(&mut self, code: u16, reason: &'static str) {
        let reason = reason.into();
        let frame = Message::Close(Some(CloseFrame { code, reason }));
        let farewell = async {
            if self.socket.send(frame).await.is_ok() {
                // Until the client has answered the close.
                while let Some(Ok(_)) = self.socket.recv().await {}
            }
        };
        let _ = timeout(Duration::from_secs(1), farewell).await;
    }
}

/// A request; none if it is a ping or a pong.
fn read(message: Option<Result<Message, axum::Error>>) -> Result<Option<Message>, End> {
    match message {
        Some(Ok(message @ (Message::Binary(_) | Message::Text(_)))) => Ok(Some(message)),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(None),
        Some(Err(error)) => Err(why(error)),
        Some(Ok(Message::Close(_))) | None => Err(End::Closed),
    }
}

fn why(error: axum::Error) -> End {
    match error.into_inner().downcast_ref() {
        Some(tungstenite::Error::Capacity(_)) => End::TooLong,
        _ => End::Closed,
    }
}
