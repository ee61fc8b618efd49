//! How many sessions there are, and who may begin another.

use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::fault::Fault;
use crate::limits::Limits;

/// The admitted sessions.
#[derive(Debug)]
pub struct Admissions {
    ledger: Mutex<Ledger>,
    limits: Limits,
}

#[derive(Debug)]
struct Ledger {
    /// By their numbers.
    sessions: BTreeMap<u64, Arc<Admitted>>,
    clients: HashMap<IpAddr, usize>,
    envs: usize,
    threads: usize,
    last: u64,
    /// How many may begin now.
    allowance: f64,
    counted: Instant,
}

/// What the server knows of a session while it lasts.
#[derive(Debug)]
pub struct Admitted {
    /// Its name.
    pub name: String,
    /// Address of the client that began it.
    pub client: IpAddr,
    /// Id of its environments, which a reset of OpenEnv's may change.
    env: Mutex<String>,
    /// How many there are.
    pub envs: usize,
    /// When it began.
    pub began: Instant,
    /// Environment steps so far.
    pub steps: AtomicU64,
    /// Requests that were refused or failed.
    pub errors: AtomicU64,
    /// Whether a client is connected to it.
    pub connected: AtomicBool,
}

/// The right to have a session, given back when dropped.
#[derive(Debug)]
pub struct Admission {
    admissions: Arc<Admissions>,
    number: u64,
    threads: usize,
    /// What the server knows of the session.
    pub admitted: Arc<Admitted>,
}

impl Admitted {
    /// Id of its environments.
    #[must_use]
    pub fn env(&self) -> String {
        let env = self.env.lock();
        env.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Its environments have this id now.
    pub(crate) fn plays(&self, env: &str) {
        let mut now = self.env.lock().unwrap_or_else(PoisonError::into_inner);
        if *now != env {
            env.clone_into(&mut now);
        }
    }
}

impl Admissions {
    /// None, within limits.
    #[must_use]
    pub fn new(limits: &Limits) -> Self {
        let ledger = Ledger {
            sessions: BTreeMap::new(),
            clients: HashMap::new(),
            envs: 0,
            threads: 0,
            last: 0,
            allowance: 2.0 * limits.sessions_per_second,
            counted: Instant::now(),
        };
        Self {
            ledger: Mutex::new(ledger),
            limits: limits.clone(),
        }
    }

    fn ledger(&self) -> MutexGuard<'_, Ledger> {
        self.ledger.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The sessions that last, in the order in which they began.
    #[must_use]
    pub fn sessions(&self) -> Vec<Arc<Admitted>> {
        self.ledger().sessions.values().cloned().collect()
    }

    /// How many sessions and environments there are.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let ledger = self.ledger();
        (ledger.sessions.len(), ledger.envs)
    }

    /// Admits a session with `envs` environments.
    ///
    /// # Errors
    /// [`Fault`] that names the limit.
    pub fn admit(
        self: &Arc<Self>,
        client: IpAddr,
        env: &str,
        envs: usize,
    ) -> Result<Admission, Fault> {
        let limits = &self.limits;
        let mut ledger = self.ledger();
        let of_client = ledger.clients.get(&client).copied().unwrap_or(0) + 1;
        let bounds = [
            ("num_envs", envs, limits.envs_per_session),
            ("sessions", ledger.sessions.len() + 1, limits.sessions),
            (
                "sessions of your address",
                of_client,
                limits.sessions_per_client,
            ),
            (
                "environments of all sessions",
                ledger.envs.saturating_add(envs),
                limits.envs,
            ),
        ];
        for (what, value, most) in bounds {
            if value > most {
                return Err(Fault::limit(what, value, most));
            }
        }
        ledger.spend(limits.sessions_per_second)?;
        // More threads than are left would be refused by nobody and help nobody.
        let threads = limits
            .threads_per_session
            .min(limits.threads.saturating_sub(ledger.threads))
            .max(1);
        ledger.envs += envs;
        ledger.threads += pool_threads(threads);
        *ledger.clients.entry(client).or_default() = of_client;
        ledger.last += 1;
        let number = ledger.last;
        let admitted = Arc::new(Admitted {
            name: format!("s{number}"),
            client,
            env: Mutex::new(env.to_owned()),
            envs,
            began: Instant::now(),
            steps: AtomicU64::new(0),
            errors: AtomicU64::new(0),
            connected: AtomicBool::new(true),
        });
        ledger.sessions.insert(number, Arc::clone(&admitted));
        drop(ledger);
        Ok(Admission {
            admissions: Arc::clone(self),
            number,
            threads,
            admitted,
        })
    }
}

impl Ledger {
    /// Takes one new session from the allowance, which fills up with time.
    fn spend(&mut self, per_second: f64) -> Result<(), Fault> {
        let now = Instant::now();
        let since = now.duration_since(self.counted).as_secs_f64();
        self.counted = now;
        self.allowance = (self.allowance + since * per_second).min(2.0 * per_second.max(0.5));
        if self.allowance < 1.0 {
            return Err(Fault::limit(
                "new sessions a second",
                format!("over {per_second}"),
                format!("{per_second}; try again in a moment"),
            ));
        }
        self.allowance -= 1.0;
        Ok(())
    }
}

/// A session with one thread uses that of the request.
const fn pool_threads(threads: usize) -> usize {
    if threads > 1 { threads } else { 0 }
}

impl Admission {
    /// Threads that the session may have.
    #[must_use]
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// Gives back the threads that the session does not need.
    pub fn keep_threads(&mut self, needed: usize) {
        let mut ledger = self.admissions.ledger();
        ledger.threads = ledger.threads + pool_threads(needed) - pool_threads(self.threads);
        self.threads = needed;
    }
}

impl Drop for Admission {
    fn drop(&mut self) {
        let mut ledger = self.admissions.ledger();
        ledger.sessions.remove(&self.number);
        ledger.envs -= self.admitted.envs;
        ledger.threads -= pool_threads(self.threads);
        if let Some(of_client) = ledger.clients.get_mut(&self.admitted.client) {
            *of_client -= 1;
            if *of_client == 0 {
                ledger.clients.remove(&self.admitted.client);
            }
        }
    }
}
