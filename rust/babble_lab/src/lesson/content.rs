//! What a lesson consists of, and how far a session has come in it.

use serde::Serialize;

use super::check::{self, Right, Step};
use crate::history::{Event, Happened};
use crate::setup::Setup;

/// A lesson.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lesson {
    /// Its name in links and records.
    pub id: String,
    /// Its place among the lessons, from 1.
    pub number: usize,
    /// Its title.
    pub title: String,
    /// How long it takes \[min\].
    pub minutes: u32,
    /// What one has to know first: paragraphs, with emphasis and code as in Markdown.
    pub background: String,
    /// What it is about in one line.
    pub equation: Equation,
    /// Things to do.
    pub tasks: Vec<Task>,
    /// Things to answer.
    pub questions: Vec<Question>,
    /// Where to read on.
    pub references: Vec<String>,
    /// What it begins with.
    pub setup: Setup,
    /// The view that it begins with.
    pub view: String,
    /// Controls that it hides.
    pub hidden: Vec<String>,
}

/// An equation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Equation {
    /// The equation in Unicode.
    pub text: String,
    /// Its name, as in "Eq. 2".
    pub name: String,
    /// What the symbols mean.
    pub means: String,
}

/// Something to do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Task {
    /// Its name in the lesson.
    pub id: String,
    /// What to do.
    pub text: String,
    /// What its button sets; none if it goes on from where one is.
    pub setup: Option<Setup>,
    /// What has to have happened, one step after the other.
    #[serde(skip)]
    pub(crate) done: Vec<Step>,
}

/// Something to answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// Its name in the lesson, and in the command that answers.
    pub id: String,
    /// The question.
    pub text: String,
    /// What one can choose from; none for a number.
    pub choices: Option<Vec<String>>,
    /// Unit of the number.
    pub unit: Option<String>,
    #[serde(skip)]
    pub(crate) right: Right,
    #[serde(skip)]
    pub(crate) hint: String,
}

/// How far a session has come in a lesson.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Progress {
    /// Whether each task was done.
    pub tasks: Vec<bool>,
    /// What was answered to each question.
    pub answers: Vec<Answered>,
}

/// The last answer to a question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Answered {
    /// Whether there is one.
    pub given: bool,
    /// Whether it is right.
    pub right: bool,
    /// After a wrong one, what helps.
    pub hint: Option<String>,
}

impl Lesson {
    /// How far a session has come, by what happened in it.
    #[must_use]
    pub fn progress(&self, history: &[Event]) -> Progress {
        let moments = check::moments(history);
        Progress {
            tasks: self
                .tasks
                .iter()
                .map(|task| check::done(&task.done, &moments))
                .collect(),
            answers: self
                .questions
                .iter()
                .map(|question| question.answered(history))
                .collect(),
        }
    }
}

impl Question {
    fn answered(&self, history: &[Event]) -> Answered {
        let last = history.iter().rev().find_map(|event| match &event.what {
            Happened::Answered { question, value } if *question == self.id => Some(value),
            _ => None,
        });
        let right = last.is_some_and(|answer| self.right.is(answer));
        Answered {
            given: last.is_some(),
            right,
            hint: (last.is_some() && !right).then(|| self.hint.clone()),
        }
    }
}
