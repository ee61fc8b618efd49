//! Whether a record is what it says, and what was done in it.

use babble_env::Executor;
use serde::Serialize;

use crate::fault::Fault;
use crate::lesson::lesson;
use crate::policies::Policies;
use crate::record::{Record, replay};

/// What was found by running a record again.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Verdict {
    /// Who did it, as the record says.
    pub name: String,
    /// The lesson that was done, as the record says.
    pub lesson: Option<String>,
    /// Whether each task of the lesson was done.
    pub tasks: Vec<bool>,
    /// Whether each question of the lesson has the right answer.
    pub answers: Vec<bool>,
    /// Length of the record.
    pub commands: usize,
    /// Hash of the state in which running it again ends.
    pub hash: Option<String>,
    /// Whether the record says the same.
    pub same_hash: bool,
    /// What is wrong with the record, if anything is.
    pub problem: Option<String>,
}

/// Runs the record in a text again, which may name some of the policies.
///
/// # Errors
/// A [`Fault`] of the kind "Interrupted" if the executor was told to stop. All that is wrong with the record is
/// in the verdict.
pub fn verdict(text: &str, policies: Policies, executor: Executor) -> Result<Verdict, Fault> {
    let mut found = Verdict::default();
    match found.run(text, policies, executor) {
        Err(fault) if fault.kind == "Interrupted" => return Err(fault),
        Err(fault) => found.problem = Some(fault.problem),
        Ok(()) => {}
    }
    Ok(found)
}

impl Verdict {
    fn run(&mut self, text: &str, policies: Policies, executor: Executor) -> Result<(), Fault> {
        let record = Record::from_json(text).map_err(|fault| Fault {
            problem: match &fault.field {
                Some(field) => format!("no record of the lab: {field}: {}", fault.problem),
                None => format!("no record of the lab: {}", fault.problem),
            },
            ..fault
        })?;
        self.name.clone_from(&record.name);
        self.lesson.clone_from(&record.lesson);
        self.commands = record.commands.len();
        let package = env!("CARGO_PKG_VERSION");
        if record.package != package {
            let problem = format!(
                "made with version {} of the lab, and this is {package}: its bits may be others",
                record.package
            );
            return Err(Fault::record("package", problem));
        }
        let lab = replay(&record, policies, executor)?;
        let hash = lab.hash()?;
        self.same_hash = hash == record.hash;
        self.hash = Some(hash);
        if let Some(id) = &record.lesson {
            let progress = lesson(id)?.progress(lab.history());
            self.tasks = progress.tasks;
            self.answers = progress.answers.iter().map(|answer| answer.right).collect();
        }
        if self.same_hash {
            return Ok(());
        }
        let problem = "running it again ends in another state than it says: it was altered";
        Err(Fault::record("hash", problem))
    }
}
