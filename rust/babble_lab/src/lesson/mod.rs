//! Guided lessons: texts, tasks that notice when they were done, questions with answers.
//!
//! A lesson is a TOML file of `lessons/`. Its checks are data, and they read what happened in a session alone, so
//! the page and whoever runs a record again agree.

mod check;
mod content;
mod file;

use std::sync::LazyLock;

use crate::fault::Fault;
use file::LessonFile;

pub use content::{Answered, Equation, Lesson, Progress, Question, Task};

/// The files of `lessons/` in one: `examples/lessons.rs` makes it.
const FILES: &str = include_str!("../../lessons/lessons.json");

static LESSONS: LazyLock<Vec<Lesson>> = LazyLock::new(|| {
    let files = LessonFile::read_all(FILES)
        .unwrap_or_else(|problem| panic!("the lessons of this build are broken: {problem}"));
    let numbered = files.into_iter().zip(1..);
    numbered.map(|(file, number)| file.lesson(number)).collect()
});

/// All lessons, in their order.
#[must_use]
pub fn lessons() -> &'static [Lesson] {
    &LESSONS
}

/// The lesson of that id.
///
/// # Errors
/// A [`Fault`] for a name that no lesson has.
pub fn lesson(id: &str) -> Result<&'static Lesson, Fault> {
    let found = LESSONS.iter().find(|lesson| lesson.id == id);
    found.ok_or_else(|| {
        let known: Vec<&str> = LESSONS.iter().map(|lesson| &*lesson.id).collect();
        let problem = format!("{id:?} is not one of {}", known.join(", "));
        Fault::config("lesson", problem)
    })
}
