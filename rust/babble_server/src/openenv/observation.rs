//! What an environment shows, as OpenEnv's clients get it.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::session::Session;
use crate::wire::Shown;

/// The data of an observation.
///
/// float32 numbers are written with as few digits as tell them apart: a client that reads them as
/// float64 and stores them as float32 has the same bits. Of all float32 numbers one, ±7.038531e-26, is
/// rounded twice on this way, and ends one unit in its last place off.
#[derive(Debug, Serialize)]
pub(super) struct Observed<'a> {
    observation: Observation<'a>,
    reward: Option<f64>,
    done: bool,
    /// OpenEnv's clients read it here or in the observation.
    metadata: Metadata<'a>,
}

/// Names and values of an observation.
#[derive(Debug)]
struct Observation<'a> {
    session: &'a Session,
    shown: &'a Shown,
    metadata: Metadata<'a>,
}

/// What Gymnasium's `step` returns beside observation and reward.
#[derive(Debug, Clone, Copy, Serialize)]
struct Metadata<'a> {
    terminated: bool,
    truncated: bool,
    info: Info<'a>,
}

/// Gymnasium's info.
#[derive(Debug, Clone, Copy)]
struct Info<'a> {
    session: &'a Session,
    shown: &'a Shown,
}

impl<'a> Observed<'a> {
    /// What the only environment of a session shows: after a reset there is no reward.
    pub(super) fn new(session: &'a Session, shown: &'a Shown, is_reset: bool) -> Self {
        let is = |flag: &[u8]| flag.first() == Some(&1);
        let metadata = Metadata {
            terminated: is(&shown.terminated.0),
            truncated: is(&shown.truncated.0),
            info: Info { session, shown },
        };
        Self {
            observation: Observation {
                session,
                shown,
                metadata,
            },
            reward: shown.reward.0.first().copied().filter(|_| !is_reset),
            done: metadata.terminated || metadata.truncated,
            metadata,
        }
    }
}

impl Serialize for Observation<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (spec, shown) = (&self.session.spec, self.shown);
        let mut map = serializer.serialize_map(None)?;
        match self.session.obs() {
            "flat" => map.serialize_entry("observation", &shown.senses.0)?,
            "goal" => {
                map.serialize_entry("observation", &shown.senses.0)?;
                for (goal, numbers) in spec.goals.iter().zip([&shown.achieved, &shown.desired]) {
                    map.serialize_entry(goal.name, &numbers.0)?;
                }
            }
            _ => {
                let lengths = spec.senses.iter().map(|sense| sense.labels.len());
                for (sense, part) in spec.senses.iter().zip(parts(&shown.senses.0, lengths)) {
                    map.serialize_entry(sense.name, part)?;
                }
            }
        }
        if let Some(size) = self.session.retina() {
            let size = size as usize;
            let rows: Vec<Vec<&[u8]>> = shown
                .retina
                .0
                .chunks(3 * size)
                .map(|row| row.chunks(3).collect())
                .collect();
            map.serialize_entry("retina", &rows)?;
        }
        map.serialize_entry("metadata", &self.metadata)?;
        map.end()
    }
}

impl Serialize for Info<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (spec, shown) = (&self.session.spec, self.shown);
        let mut map = serializer.serialize_map(None)?;
        for (name, &fact) in spec.facts.iter().zip(&shown.facts.0) {
            map.serialize_entry(name, &(fact == 1))?;
        }
        let now = shown.outcome.0.first().map_or(0, |&code| usize::from(code));
        let outcomes = spec.outcomes.iter().enumerate();
        map.serialize_entry(
            "outcome",
            &Named(outcomes.map(|(i, name)| (name, i == now))),
        )?;
        let terms = spec.reward_terms.iter().zip(&shown.terms.0);
        map.serialize_entry("reward_terms", &Named(terms))?;
        let lengths = spec.measures.iter().map(|measure| measure.labels.len());
        for (measure, part) in spec.measures.iter().zip(parts(&shown.measures.0, lengths)) {
            map.serialize_entry(measure.name, part)?;
        }
        map.end()
    }
}

/// Names with values.
struct Named<I>(I);

impl<K: Serialize, V: Serialize, I: Iterator<Item = (K, V)> + Clone> Serialize for Named<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.clone())
    }
}

/// Consecutive parts of so many numbers.
fn parts<T>(mut all: &[T], lengths: impl Iterator<Item = usize>) -> impl Iterator<Item = &[T]> {
    lengths.map(move |n| {
        let (part, rest) = all.split_at(n.min(all.len()));
        all = rest;
        part
    })
}
