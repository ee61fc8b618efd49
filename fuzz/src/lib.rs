//! What is done with hostile bytes, by the fuzz targets and by the test that replays their corpus.
//!
//! A checksum stands before each format's content, which no fuzzer guesses. So the input is the
//! content, and a right header is put before it; the input as it is is tried too.

pub mod agents;
pub mod configs;
pub mod snapshots;

pub use agents::agent_file;
pub use configs::config;
pub use snapshots::{grasp_snapshot, reach_snapshot};
