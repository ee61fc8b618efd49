//! What clients may ask for.

use std::time::Duration;

use clap::{Args, Parser};

/// Bounds of what clients may ask for, each named in the error that it gives.
#[derive(Debug, Clone, PartialEq, Args)]
#[command(next_help_heading = "Limits")]
pub struct Limits {
    /// Sessions at once.
    #[arg(long, default_value_t = 256)]
    pub sessions: usize,
    /// Sessions at once from one address.
    #[arg(long, default_value_t = 128)]
    pub sessions_per_client: usize,
    /// New sessions a second, on average; twice as many may begin at once.
    #[arg(long, default_value_t = 100.0, value_parser = positive)]
    pub sessions_per_second: f64,
    /// Environments of one session.
    #[arg(long, default_value_t = 4_096)]
    pub envs_per_session: usize,
    /// Environments of all sessions.
    #[arg(long, default_value_t = 16_384)]
    pub envs: usize,
    /// Threads that step the environments of one session.
    #[arg(long, default_value_t = processors())]
    pub threads_per_session: usize,
    /// Such threads of all sessions. Sessions get fewer when they run out; results are the same.
    #[arg(long, default_value_t = 8 * processors())]
    pub threads: usize,
    /// Bytes of one message, either way.
    #[arg(long, default_value_t = 16 << 20)]
    pub message_bytes: usize,
    /// Pixels of one picture.
    #[arg(long, default_value_t = 1 << 22)]
    pub picture_pixels: u64,
    /// Computing time of one request.
    #[arg(long = "request-seconds", default_value = "10", value_parser = seconds)]
    pub request_time: Duration,
    /// How long a session outlives its connection.
    #[arg(long = "resume-seconds", default_value = "60", value_parser = seconds)]
    pub resume_time: Duration,
    /// How long a session may go without a request.
    #[arg(long = "idle-seconds", default_value = "900", value_parser = seconds)]
    pub idle_time: Duration,
    /// Time between pings. A connection is dropped after two that were not answered.
    #[arg(long = "ping-seconds", default_value = "20", value_parser = seconds)]
    pub ping_time: Duration,
    /// How long a client may take for the head of an HTTP request, and for its first message.
    #[arg(long = "handshake-seconds", default_value = "10", value_parser = seconds)]
    pub handshake_time: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        #[derive(Parser)]
        struct Defaults {
            #[command(flatten)]
            limits: Limits,
        }
        Defaults::parse_from([""]).limits
    }
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number <= 1e6 => Ok(number),
        _ => Err("expected a number above 0, at most 1000000".to_owned()),
    }
}

/// A time as a person types it.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    positive(text).map(Duration::from_secs_f64)
}
