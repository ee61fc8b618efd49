//! How a session was before a command, to go back to.

use std::sync::Arc;

use crate::agent::Agent;
use crate::command::Command;
use crate::cost::Cost;
use crate::history::Event;
use crate::setup::Setup;
use crate::stage::StageSnapshot;

/// Most that all snapshots take \[byte\].
const MOST_BYTES: usize = 64 << 20;
/// Most snapshots.
const MOST_SNAPSHOTS: usize = 1_000;

/// A session before a command. Learners that did not change are shared.
#[derive(Debug, Clone)]
pub(crate) struct Snapshot {
    pub(crate) setup: Arc<Setup>,
    pub(crate) agents: Vec<Agent>,
    pub(crate) stage: StageSnapshot,
    /// Lengths of the curve, and of the commands and their events.
    pub(crate) lengths: [usize; 2],
    /// The last command and its event.
    pub(crate) last: Option<(Command, Event)>,
    pub(crate) cost: Cost,
}

impl Snapshot {
    /// Bytes that it takes beside those of the snapshot before it.
    fn bytes(&self, before: Option<&Self>) -> usize {
        let known = before.map_or(&[][..], |before| &before.agents);
        let new = |agent: &Agent| {
            let mind = agent.learner()?;
            let shared = known
                .iter()
                .filter_map(Agent::learner)
                .any(|one| Arc::ptr_eq(&one.learner, &mind.learner));
            (!shared).then(|| mind.bytes())
        };
        self.stage.bytes() + self.agents.iter().filter_map(new).sum::<usize>()
    }
}

/// The snapshots before what was done last, one for each act.
#[derive(Debug, Default)]
pub(crate) struct Undo {
    snapshots: Vec<Snapshot>,
}

impl Undo {
    /// How many acts can be undone.
    pub(crate) fn len(&self) -> usize {
        self.snapshots.len()
    }

    /// Keeps a snapshot, and forgets the oldest ones that memory has no room for.
    pub(crate) fn push(&mut self, snapshot: Snapshot) {
        self.snapshots.push(snapshot);
        let (mut bytes, mut kept) = (0, 0);
        for i in (0..self.snapshots.len()).rev() {
            let before = i.checked_sub(1).map(|i| &self.snapshots[i]);
            bytes += self.snapshots[i].bytes(before);
            if kept == MOST_SNAPSHOTS || bytes > MOST_BYTES {
                break;
            }
            kept += 1;
        }
        self.snapshots.drain(..self.snapshots.len() - kept);
    }

    /// The snapshot before the last act.
    pub(crate) fn pop(&mut self) -> Option<Snapshot> {
        self.snapshots.pop()
    }
}
