//! What all connections share.

use std::io;
use std::net::IpAddr;
use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};

use crate::admission::{Admission, Admissions};
use crate::fault::{Fault, Kind};
use crate::limits::Limits;
use crate::metrics::Metrics;
use crate::options::Options;
use crate::session::Session;
use crate::table::SessionTable;
use crate::token::Token;
use crate::wire::Make;

/// Connections beyond those of sessions: for pages, checks of health, and handshakes.
const SPARE_CONNECTIONS: u32 = 64;

/// What all connections share.
#[derive(Debug)]
pub struct Server {
    /// How it was started.
    pub options: Options,
    /// All sessions.
    pub admissions: Arc<Admissions>,
    /// Sessions of the binary protocol.
    pub table: SessionTable,
    /// Connections that may still be accepted.
    pub connections: Arc<Semaphore>,
    /// What is counted.
    pub metrics: Metrics,
    /// What clients have to show, if anything.
    pub token: Option<Token>,
    /// True once the server is being stopped.
    pub draining: watch::Sender<bool>,
}

/// The other end of a connection.
#[derive(Debug, Clone)]
pub struct Peer {
    /// Its address.
    pub address: IpAddr,
    /// Held while the connection lasts.
    pub permit: Arc<OwnedSemaphorePermit>,
}

fn most_connections(limits: &Limits) -> u32 {
    u32::try_from(limits.sessions)
        .unwrap_or(u32::MAX)
        .saturating_add(SPARE_CONNECTIONS)
        .min(1 << 20)
}

/// Waits until a watched value is as asked.
pub(crate) async fn told<T>(watched: &mut watch::Receiver<T>, asked: impl FnMut(&T) -> bool) {
    // If the sender is gone the value will not change: whoever holds it ends all that wait.
    if watched.wait_for(asked).await.is_err() {
        std::future::pending::<()>().await;
    }
}

impl Server {
    /// A server with no sessions.
    ///
    /// # Errors
    /// An access token that cannot be used or is missing.
    pub fn new(options: Options) -> io::Result<Self> {
        let token = Token::given(options.token_file.as_deref(), options.host)?;
        let limits = &options.limits;
        Ok(Self {
            admissions: Arc::new(Admissions::new(limits)),
            table: SessionTable::default(),
            connections: Arc::new(Semaphore::new(most_connections(limits) as usize)),
            metrics: Metrics::new(),
            token,
            draining: watch::Sender::new(false),
            options,
        })
    }

    /// Waits until all connections have ended.
    pub(crate) async fn drained(&self) {
        // It fails only for a closed semaphore, and this one is never closed.
        let _ = self
            .connections
            .acquire_many(most_connections(self.limits()))
            .await;
    }

    /// What clients may ask for.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.options.limits
    }

    /// Begins a session. It takes time: call it in a thread for long work.
    ///
    /// # Errors
    /// [`Fault`] for what is refused or beyond a limit.
    pub fn open(&self, client: IpAddr, asked: &Make) -> Result<(Session, Admission), Fault> {
        if *self.draining.borrow() {
            let message = "the server is being stopped and begins no session";
            return Err(Fault::new(Kind::SessionError, message));
        }
        let mut admission = self.admissions.admit(client, &asked.env, asked.num_envs)?;
        let session = Session::make(asked, self.limits(), admission.threads())?;
        admission.keep_threads(session.threads());
        Ok((session, admission))
    }
}
