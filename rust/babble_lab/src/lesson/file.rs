//! Lessons as they stand in their files, whose unknown fields are errors.

use serde::Deserialize;
use serde_json::{Map, Value};

use super::check::{Right, Step};
use super::content::{Equation, Lesson, Question, Task};
use crate::setup::{AgentSetup, Setup};

/// A lesson as it stands in its file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LessonFile {
    id: String,
    title: String,
    minutes: u32,
    background: String,
    equation: EquationFile,
    setup: SetupFile,
    view: String,
    #[serde(default)]
    hidden: Vec<String>,
    tasks: Vec<TaskFile>,
    questions: Vec<QuestionFile>,
    references: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EquationFile {
    text: String,
    name: String,
    means: String,
}

/// What differs from the defaults; in a task, from the lesson's setup.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct SetupFile {
    env: Option<String>,
    options: Option<Map<String, Value>>,
    profile: Option<String>,
    config: Option<Map<String, Value>>,
    seed: Option<u64>,
    agents: Option<Vec<AgentSetup>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TaskFile {
    id: String,
    text: String,
    setup: Option<SetupFile>,
    done: Vec<Step>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct QuestionFile {
    id: String,
    text: String,
    /// The first one is right; they are shown in the order of the alphabet.
    choices: Option<Vec<String>>,
    /// Least and greatest number that is right.
    between: Option<[f64; 2]>,
    unit: Option<String>,
    hint: String,
}

impl LessonFile {
    pub(super) fn read_all(text: &str) -> Result<Vec<Self>, String> {
        let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let files: Vec<Self> = serde_json::from_value(value).map_err(|error| error.to_string())?;
        let questions = files.iter().flat_map(|file| &file.questions);
        match questions.clone().find(|question| !question.has_answer()) {
            None => Ok(files),
            Some(question) => Err(format!(
                "question {:?} needs either two choices or more, or between",
                question.id
            )),
        }
    }

    pub(super) fn lesson(self, number: usize) -> Lesson {
        let setup = self.setup.on(&Setup {
            env: "BabbleReach-v0".to_owned(),
            options: Map::new(),
            profile: "paper".to_owned(),
            config: Map::new(),
            seed: 0,
            agents: vec![AgentSetup::hebb("paper")],
        });
        let task = |task: TaskFile| Task {
            id: task.id,
            text: task.text,
            setup: task.setup.map(|file| file.on(&setup)),
            done: task.done,
        };
        Lesson {
            id: self.id,
            number,
            title: self.title,
            minutes: self.minutes,
            background: self.background,
            equation: Equation {
                text: self.equation.text,
                name: self.equation.name,
                means: self.equation.means,
            },
            tasks: self.tasks.into_iter().map(task).collect(),
            questions: self
                .questions
                .into_iter()
                .map(QuestionFile::question)
                .collect(),
            references: self.references,
            view: self.view,
            hidden: self.hidden,
            setup,
        }
    }
}

impl SetupFile {
    fn on(self, base: &Setup) -> Setup {
        let base = base.clone();
        Setup {
            env: self.env.unwrap_or(base.env),
            options: self.options.unwrap_or(base.options),
            profile: self.profile.unwrap_or(base.profile),
            config: self.config.unwrap_or(base.config),
            seed: self.seed.unwrap_or(base.seed),
            agents: self.agents.unwrap_or(base.agents),
        }
    }
}

impl QuestionFile {
    fn has_answer(&self) -> bool {
        match &self.choices {
            Some(choices) => choices.len() > 1 && self.between.is_none(),
            None => self.between.is_some(),
        }
    }

    fn question(self) -> Question {
        let mut choices = self.choices;
        let right = match (&choices, self.between) {
            (Some(choices), _) => Right::Choice(choices[0].clone()),
            (None, between) => Right::Between(between.unwrap_or_default()),
        };
        if let Some(choices) = &mut choices {
            choices.sort();
        }
        Question {
            id: self.id,
            text: self.text,
            choices,
            unit: self.unit,
            right,
            hint: self.hint,
        }
    }
}
