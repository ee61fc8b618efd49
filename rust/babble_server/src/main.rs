//! The environment server.

fn main() {}
