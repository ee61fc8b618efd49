//! What one client may ask for.

use std::time::Duration;

/// Bounds of what a client may ask for, each named in the error that it gives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Environments of one session.
    pub envs: usize,
    /// Threads that step the environments of one session.
    pub threads: usize,
    /// Bytes of one message, either way.
    pub message_bytes: usize,
    /// Pixels of one picture.
    pub picture_pixels: u64,
    /// Computing time of one request.
    pub request_time: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            envs: 4_096,
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            message_bytes: 64 << 20,
            picture_pixels: 1 << 22,
            request_time: Duration::from_secs(10),
        }
    }
}
