//! Replies as bytes.

use axum::body::Bytes;
use serde::Serialize;

use crate::fault::{Fault, Kind};

/// The reply to request `id`.
pub(super) fn encode<T: Serialize>(id: Option<u64>, done: &Result<T, Fault>) -> Bytes {
    let encoded = match done {
        Ok(body) => rmp_serde::to_vec_named(&(id, "ok", body)),
        Err(fault) => rmp_serde::to_vec_named(&(id, "error", fault)),
    };
    let encoded = encoded.unwrap_or_else(|error| {
        let fault = Fault::new(Kind::ServerError, error.to_string());
        // A fault is two strings, which can always be written.
        rmp_serde::to_vec_named(&(id, "error", fault)).unwrap_or_default()
    });
    encoded.into()
}
