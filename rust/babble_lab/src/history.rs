//! What happened in a session, for the checks of lessons.

use std::sync::Arc;

use crate::command::{Answer, Case};
use crate::setup::Setup;
use crate::state::Outcomes;

/// What a command did; commands that are one in the record are one event.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// The setup after it.
    pub setup: Arc<Setup>,
    /// Babbles that each agent has learnt from by then.
    pub learnt: Vec<u64>,
    /// What happened.
    pub what: Happened,
}

/// What can happen.
#[derive(Debug, Clone, PartialEq)]
pub enum Happened {
    /// The agents babbled.
    Babbled,
    /// An episode began.
    Recalled {
        /// Its case.
        case: Case,
        /// Whether it is the next one of the seed, and not one that was asked for.
        drawn: bool,
    },
    /// The episode went on.
    Stepped {
        /// How the episodes that ended in it ended, by agent.
        ended: Vec<Option<String>>,
        /// Its case.
        case: Case,
        /// As [`EpisodeState::palm`](crate::EpisodeState::palm).
        palm: Option<f64>,
    },
    /// A test.
    Tested {
        /// Test cases.
        cases: u64,
        /// In how many of them each agent succeeded.
        successes: Vec<u64>,
        /// How the cases of each agent ended.
        outcomes: Vec<Outcomes>,
    },
    /// Neurons were silenced.
    Lesioned {
        /// Whose.
        agent: usize,
        /// How many neurons of the agent are silent now.
        silenced: usize,
    },
    /// The setup changed.
    Changed,
    /// A student answered.
    Answered {
        /// Id of the question.
        question: String,
        /// The answer.
        value: Answer,
    },
}

impl Event {
    /// Takes in what a command did that is one with that of this event in the record.
    pub(crate) fn merge(&mut self, next: Self) {
        if let (Happened::Stepped { ended, .. }, Happened::Stepped { ended: more, .. }) =
            (&mut self.what, next.what)
        {
            for (before, now) in ended.iter_mut().zip(more) {
                *before = now.or(before.take());
            }
        }
        self.setup = next.setup;
        self.learnt = next.learnt;
    }
}
