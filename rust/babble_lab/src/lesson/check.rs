//! Checks of tasks: steps that must have happened one after the other, each with its conditions.

use std::collections::BTreeMap;
use std::rc::Rc;

use babble_env::CaseValue;
use serde::Deserialize;
use serde_json::Value;

use crate::command::{Answer, Case};
use crate::history::{Event, Happened};
use crate::setup::Setup;

/// What must have happened; numbers are those of the first agent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    /// The agent babbled; the number is how many babbles it has learnt from.
    Learnt,
    /// An episode began; no number.
    Began,
    /// The agent's episode ended; the number is how far from the wrist the ball met the palm \[m\], 0 if it
    /// did not.
    Ended,
    /// All agents have played a case to its end; no number.
    Played,
    /// A test of at least 40 cases; the number is the agent's share of successes.
    Tested,
    /// Neurons were silenced; the number is how many of the agent's are silent.
    Lesioned,
}

/// Fewer test cases than these tell too little.
const FEWEST_CASES: u64 = 40;

/// One step of a check.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Step {
    what: Kind,
    #[serde(default)]
    at_least: Option<f64>,
    #[serde(default)]
    at_most: Option<f64>,
    /// How the episode ended.
    #[serde(default)]
    outcome: Option<String>,
    /// The part in which the case differs from that of the episode before, and which alone does.
    #[serde(default)]
    moved: Option<String>,
    /// Values of the setup, by JSON pointer.
    #[serde(default)]
    setup: BTreeMap<String, Wanted>,
}

/// What a value must be.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Wanted {
    /// A number within bounds.
    Range(Range),
    /// Whether there is a value that is not null.
    Given(Given),
    /// This value.
    Is(Value),
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    at_least: f64,
    at_most: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Given {
    given: bool,
}

/// An event, and what it stands on.
pub(super) struct Moment<'a> {
    event: &'a Event,
    /// The setup as JSON.
    setup: Rc<Value>,
    /// The case of the episode.
    case: Option<&'a Case>,
    /// The case of the episode before it.
    before: Option<&'a Case>,
    /// How many agents have played the case to its end.
    ended: usize,
}

/// Goes through a session and notes what each event stands on.
pub(super) fn moments(history: &[Event]) -> Vec<Moment<'_>> {
    let (mut case, mut before) = (None, None);
    let mut ended = 0;
    let mut last: Option<&Setup> = None;
    let mut setup = Rc::new(Value::Null);
    let mut noted = Vec::new();
    for event in history {
        if last.is_none_or(|last| !std::ptr::eq(last, &raw const *event.setup)) {
            setup = Rc::new(serde_json::to_value(&*event.setup).unwrap_or_default());
        }
        match &event.what {
            Happened::Recalled { case: begun, .. } => {
                (before, case, ended) = (case, Some(begun), 0);
            }
            Happened::Stepped { ended: now, .. } => ended += now.iter().flatten().count(),
            Happened::Changed => (before, case) = (None, None),
            _ => {}
        }
        last = Some(&event.setup);
        noted.push(Moment {
            event,
            setup: Rc::clone(&setup),
            case,
            before,
            ended,
        });
    }
    noted
}

/// Whether all steps happened, one after the other.
pub(super) fn done(steps: &[Step], moments: &[Moment<'_>]) -> bool {
    let mut left = steps.iter().peekable();
    for moment in moments {
        if left.peek().is_some_and(|step| step.is(moment)) {
            left.next();
        }
    }
    left.peek().is_none()
}

impl Step {
    fn is(&self, moment: &Moment<'_>) -> bool {
        let Some(number) = self.number(moment) else {
            return false;
        };
        let holds =
            |(pointer, wanted): (&String, &Wanted)| wanted.is(moment.setup.pointer(pointer));
        self.at_least.is_none_or(|least| number >= least)
            && self.at_most.is_none_or(|most| number <= most)
            && self.setup.iter().all(holds)
            && self.moved.as_ref().is_none_or(|part| moved(part, moment))
    }

    /// The number of an event of this kind, 0 where it has none; none where it is of another kind.
    fn number(&self, moment: &Moment<'_>) -> Option<f64> {
        let event = moment.event;
        match (&event.what, self.what) {
            (Happened::Babbled, Kind::Learnt) => event.learnt.first().map(|&n| n as f64),
            (Happened::Recalled { .. }, Kind::Began) => Some(0.0),
            (Happened::Stepped { ended, palm, .. }, Kind::Ended) => {
                let outcome = ended.first()?.as_ref()?;
                let wanted = self.outcome.as_ref().is_none_or(|wanted| wanted == outcome);
                wanted.then_some(palm.unwrap_or_default())
            }
            (Happened::Stepped { ended, .. }, Kind::Played) => {
                let last = ended.iter().any(Option::is_some);
                (last && moment.ended == event.setup.agents.len()).then_some(0.0)
            }
            (
                Happened::Tested {
                    cases, successes, ..
                },
                Kind::Tested,
            ) if *cases >= FEWEST_CASES => {
                let successes = *successes.first()?;
                Some(successes as f64 / *cases as f64)
            }
            (Happened::Lesioned { agent: 0, silenced }, Kind::Lesioned) => Some(*silenced as f64),
            _ => None,
        }
    }
}

/// Whether the case differs from the one before in that part, and in no other.
fn moved(part: &str, moment: &Moment<'_>) -> bool {
    let (Some(case), Some(before)) = (moment.case, moment.before) else {
        return false;
    };
    let same = |name: &str| same_value(case.get(name), before.get(name));
    // An object that is dragged is not in the hand any more.
    let of_others = |name: &&String| *name != part && *name != "in_hand";
    !same(part) && case.keys().filter(of_others).all(|name| same(name))
}

fn same_value(one: Option<&CaseValue>, other: Option<&CaseValue>) -> bool {
    one.unwrap_or(&CaseValue::Absent) == other.unwrap_or(&CaseValue::Absent)
}

impl Wanted {
    fn is(&self, value: Option<&Value>) -> bool {
        let value = value.filter(|value| !value.is_null());
        match self {
            Self::Range(Range { at_least, at_most }) => value
                .and_then(Value::as_f64)
                .is_some_and(|number| (*at_least..=*at_most).contains(&number)),
            Self::Given(Given { given }) => value.is_some() == *given,
            Self::Is(wanted) => value == Some(wanted),
        }
    }
}

/// The right answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Right {
    /// One of the choices.
    Choice(String),
    /// A number from the first to the second.
    Between([f64; 2]),
}

impl Right {
    pub(super) fn is(&self, answer: &Answer) -> bool {
        match (self, answer) {
            (Self::Choice(right), Answer::Text(given)) => right == given,
            (Self::Between([low, high]), Answer::Number(given)) => (*low..=*high).contains(given),
            _ => false,
        }
    }
}
