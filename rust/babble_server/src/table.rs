//! The sessions that can be resumed.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use subtle::ConstantTimeEq;
use tokio::sync::{Mutex as AsyncMutex, watch};

use crate::admission::{Admission, Admitted};
use crate::fault::{Fault, Kind};
use crate::session::Session;

/// Sessions by their names.
#[derive(Debug, Default)]
pub struct SessionTable(Mutex<HashMap<String, Arc<SessionEntry>>>);

/// A session, and what it takes to resume it.
#[derive(Debug)]
pub struct SessionEntry {
    /// What the server knows of it.
    pub admitted: Arc<Admitted>,
    /// What a client proves to resume it.
    pub key: String,
    /// Grows with each client that takes the session up, which the one before sees and leaves.
    pub holder: watch::Sender<u64>,
    /// The session; locked by the client that holds it.
    pub playing: Arc<AsyncMutex<Playing>>,
}

/// A session at play.
#[derive(Debug)]
pub struct Playing {
    /// The environments; none after a panic.
    pub session: Option<Session>,
    /// Id of the request that was executed last.
    pub last: u64,
    /// Reply to it.
    pub reply: axum::body::Bytes,
    /// How many steps in a row were so short that they need no thread of their own.
    pub quick_steps: u32,
    /// Given back when the session ends.
    pub admission: Admission,
}

impl SessionTable {
    fn entries(&self) -> MutexGuard<'_, HashMap<String, Arc<SessionEntry>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Enters a new session.
    ///
    /// # Errors
    /// [`Fault`] if the system has no random numbers.
    pub fn enter(
        &self,
        session: Session,
        admission: Admission,
    ) -> Result<Arc<SessionEntry>, Fault> {
        let admitted = Arc::clone(&admission.admitted);
        let entry = Arc::new(SessionEntry {
            key: format!("{}-{}", admitted.name, secret()?),
            admitted,
            holder: watch::Sender::new(0),
            playing: Arc::new(AsyncMutex::new(Playing {
                session: Some(session),
                last: 0,
                reply: axum::body::Bytes::new(),
                quick_steps: 0,
                admission,
            })),
        });
        self.entries()
            .insert(entry.admitted.name.clone(), Arc::clone(&entry));
        Ok(entry)
    }

    /// The session with a key.
    ///
    /// # Errors
    /// [`Fault`] if there is none.
    pub fn find(&self, key: &str) -> Result<Arc<SessionEntry>, Fault> {
        let name = key.split('-').next().unwrap_or_default();
        let entry = self.entries().get(name).cloned();
        entry
            .filter(|entry| bool::from(entry.key.as_bytes().ct_eq(key.as_bytes())))
            .ok_or_else(|| {
                let message = "key: no session has it; it has ended, or the server was restarted";
                Fault::new(Kind::SessionError, message)
            })
    }

    /// Ends a session: it is freed when the request that may still run in it is done.
    pub fn end(&self, entry: &SessionEntry) {
        let ended = self.entries().remove(&entry.admitted.name);
        // Not while the table is locked: it may be the last one, and freeing a session takes time.
        drop(ended);
    }
}

/// 256 random bits.
fn secret() -> Result<String, Fault> {
    let mut bits = [0; 4];
    for word in &mut bits {
        *word =
            getrandom::u64().map_err(|error| Fault::new(Kind::ServerError, error.to_string()))?;
    }
    let [a, b, c, d] = bits;
    Ok(format!("{a:016x}{b:016x}{c:016x}{d:016x}"))
}
