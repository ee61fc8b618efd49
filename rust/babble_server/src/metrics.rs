//! What the server counts.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use prometheus_client::registry::Registry;

use crate::fault::Fault;

type Label = (&'static str, &'static str);
type Histograms = Family<[Label; 1], Histogram, fn() -> Histogram>;

/// Counters since the start, as `/metrics` shows them.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    /// When the server started.
    pub started: Instant,
    sessions: Gauge<u64, AtomicU64>,
    environments: Gauge<u64, AtomicU64>,
    requests: Family<[Label; 2], Counter>,
    seconds: Histograms,
    steps: Counter,
    received: Counter,
    sent: Counter,
    ended: Family<[Label; 1], Counter>,
    refused: Family<[Label; 1], Counter>,
    panics: Counter,
    all_requests: AtomicU64,
    errors: AtomicU64,
    samples: Mutex<VecDeque<Sample>>,
}

/// Counters at a moment.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// When.
    pub at: Instant,
    /// Requests.
    pub requests: u64,
    /// Environment steps.
    pub steps: u64,
    /// Requests that were refused or failed.
    pub errors: u64,
}

/// Samples that are kept, one a second.
const SAMPLES: usize = 61;

impl Default for Metrics {
    fn default() -> Self {
        Self::new()
    }
}

impl Metrics {
    /// Counters at zero.
    #[must_use]
    pub fn new() -> Self {
        let mut metrics = Self {
            registry: Registry::with_prefix("gym_babble"),
            started: Instant::now(),
            sessions: Gauge::default(),
            environments: Gauge::default(),
            requests: Family::default(),
            // From 4 µs to 17 s.
            seconds: Family::new_with_constructor(|| {
                Histogram::new(exponential_buckets(4e-6, 4.0, 12))
            }),
            steps: Counter::default(),
            received: Counter::default(),
            sent: Counter::default(),
            ended: Family::default(),
            refused: Family::default(),
            panics: Counter::default(),
            all_requests: AtomicU64::new(0),
            errors: AtomicU64::new(0),
            samples: Mutex::default(),
        };
        metrics.register();
        metrics
    }

    fn register(&mut self) {
        let registry = &mut self.registry;
        registry.register("sessions", "Sessions", self.sessions.clone());
        registry.register(
            "environments",
            "Environments of all sessions",
            self.environments.clone(),
        );
        registry.register(
            "requests",
            "Requests by operation and result",
            self.requests.clone(),
        );
        let seconds = "Time that a request took in the server";
        registry.register("request_seconds", seconds, self.seconds.clone());
        registry.register("steps", "Environment steps", self.steps.clone());
        registry.register("received_bytes", "Bytes of requests", self.received.clone());
        registry.register("sent_bytes", "Bytes of replies", self.sent.clone());
        registry.register(
            "sessions_ended",
            "Ended sessions by reason",
            self.ended.clone(),
        );
        registry.register(
            "refused",
            "Connections that were not let in, by reason",
            self.refused.clone(),
        );
        registry.register("panics", "Faults of the server", self.panics.clone());
    }

    /// Counts a request that was answered.
    pub fn request(&self, operation: &'static str, began: Instant, fault: Option<&Fault>) {
        let result = fault.map_or("ok", |fault| fault.kind.name());
        let labels = [("operation", operation), ("result", result)];
        self.requests.get_or_create(&labels).inc();
        let seconds = self.seconds.get_or_create(&[("operation", operation)]);
        seconds.observe(began.elapsed().as_secs_f64());
        self.all_requests.fetch_add(1, Ordering::Relaxed);
        if fault.is_some() {
            self.errors.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Counts environment steps.
    pub fn steps(&self, steps: usize) {
        self.steps.inc_by(steps as u64);
    }

    /// Counts bytes of a request and its reply.
    pub fn bytes(&self, received: usize, sent: usize) {
        self.received.inc_by(received as u64);
        self.sent.inc_by(sent as u64);
    }

    /// Counts a session that ended.
    pub fn ended(&self, reason: &'static str) {
        self.ended.get_or_create(&[("reason", reason)]).inc();
    }

    /// Counts a connection that was not let in.
    pub fn refused(&self, reason: &'static str) {
        self.refused.get_or_create(&[("reason", reason)]).inc();
    }

    /// Counts a fault of the server.
    pub fn panicked(&self) {
        self.panics.inc();
    }

    /// The counters now.
    #[must_use]
    pub fn now(&self) -> Sample {
        Sample {
            at: Instant::now(),
            requests: self.all_requests.load(Ordering::Relaxed),
            steps: self.steps.get(),
            errors: self.errors.load(Ordering::Relaxed),
        }
    }

    /// Keeps the counters of this second.
    pub fn sample(&self) {
        let mut samples = self.samples();
        if samples.len() == SAMPLES {
            samples.pop_front();
        }
        samples.push_back(self.now());
    }

    /// Counters some time ago, or at the oldest moment that is known.
    #[must_use]
    pub fn ago(&self, time: Duration) -> Sample {
        let samples = self.samples();
        let known = samples
            .iter()
            .rev()
            .find(|sample| sample.at.elapsed() >= time);
        let zero = Sample {
            at: self.started,
            requests: 0,
            steps: 0,
            errors: 0,
        };
        known.or(samples.front()).copied().unwrap_or(zero)
    }

    fn samples(&self) -> MutexGuard<'_, VecDeque<Sample>> {
        self.samples.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How often the server had a fault.
    #[must_use]
    pub fn faults(&self) -> u64 {
        self.panics.get()
    }

    /// All of it, in `OpenMetrics`' text format.
    #[must_use]
    pub fn text(&self, (sessions, environments): (usize, usize)) -> String {
        self.sessions.set(sessions as u64);
        self.environments.set(environments as u64);
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = encode(&mut text, &self.registry);
        text
    }
}
