//! Records of the lab.

use std::collections::BTreeMap;

use babble_lab::{Policies, Verdict};
use pyo3::prelude::*;

use crate::{convert, errors, signals};

/// What running the record in a text again finds, within some seconds, as JSON; `policies` are the files of the
/// networks that it may name.
#[pyfunction]
pub(crate) fn check_record(
    py: Python<'_>,
    text: &str,
    policies: BTreeMap<String, Vec<u8>>,
    seconds: f64,
    threads: usize,
) -> PyResult<String> {
    let mut known = Policies::default();
    for (name, bytes) in policies {
        let added = known.add(&name, &bytes);
        added.map_err(|fault| errors::AgentFileError::new_err(fault.problem))?;
    }
    let run = |executor| babble_lab::verdict(text, known, executor);
    let (found, late) = py
        .detach(|| signals::within(seconds, threads, run))
        .map_err(errors::env)?;
    // Only an interruption is an error: what is wrong with the record is in what was found.
    let found = match found {
        Err(_) if late => Verdict {
            problem: Some(format!("running it again takes more than {seconds} s")),
            ..Verdict::default()
        },
        found => found.map_err(|_| signals::raised())?,
    };
    convert::json(&found)
}
