//! The record of a session as a file, which anybody can run again.

use std::collections::BTreeMap;
use std::iter;

use babble_env::Executor;
use serde::{Deserialize, Serialize};

use crate::command::Command;
use crate::fault::Fault;
use crate::lab::Lab;
use crate::policies::Policies;
use crate::setup::Setup;

/// Version of the file.
const VERSION: u32 = 1;
/// Most bytes of a file.
const MOST_BYTES: usize = 4 << 20;
/// Most commands of a session.
const MOST_COMMANDS: usize = 20_000;
/// Most letters of a name.
const MOST_LETTERS: usize = 200;

/// A session as a file: the same setup and commands give the same hash.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Version of the format.
    pub version: u32,
    /// Version of the package, whose bits these are.
    pub package: String,
    /// The lesson that was done.
    pub lesson: Option<String>,
    /// Who did it.
    pub name: String,
    /// The setup that it begins with.
    pub setup: Setup,
    /// Hashes of agents from files that it begins with: such a session cannot be run again from here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loaded: Vec<String>,
    /// Hashes of the files of policies that it names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub policies: BTreeMap<String, String>,
    /// What was done.
    pub commands: Vec<Command>,
    /// Hash of the state at the end.
    pub hash: String,
}

impl Record {
    /// A record from the text of a file.
    ///
    /// # Errors
    /// A [`Fault`] for a text that is no record, of another version, or too long.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        if text.len() > MOST_BYTES {
            let problem = format!("{} bytes: a record has at most {MOST_BYTES}", text.len());
            return Err(Fault::record("document", problem));
        }
        let record: Self = Fault::reading(text)?;
        let (version, name, commands) = (record.version, &record.name, record.commands.len());
        if version != VERSION {
            let problem = format!("version {version} is not {VERSION}");
            return Err(Fault::record("version", problem));
        }
        if name.chars().count() > MOST_LETTERS {
            let problem = format!("a name has at most {MOST_LETTERS} letters");
            return Err(Fault::record("name", problem));
        }
        if commands > MOST_COMMANDS {
            let problem = format!("{commands} commands: there are at most {MOST_COMMANDS}");
            return Err(Fault::record("commands", problem));
        }
        Ok(record)
    }
}

impl Lab {
    /// The session so far as a record.
    ///
    /// # Errors
    /// A [`Fault`] for a name that is too long.
    pub fn record(&self, lesson: Option<&str>, name: &str) -> Result<Record, Fault> {
        if name.chars().count() > MOST_LETTERS {
            let problem = format!("a name has at most {MOST_LETTERS} letters");
            return Err(Fault::record("name", problem));
        }
        Ok(Record {
            version: VERSION,
            package: env!("CARGO_PKG_VERSION").to_owned(),
            lesson: lesson.map(str::to_owned),
            name: name.to_owned(),
            setup: (*self.begun_with).clone(),
            loaded: self.loaded.clone(),
            policies: self.policies.hashes(self.setups()),
            commands: self.commands.clone(),
            hash: self.hash()?,
        })
    }
}

impl Lab {
    /// The setups that the record has.
    fn setups(&self) -> impl Iterator<Item = &Setup> {
        setups(&self.begun_with, &self.commands)
    }
}

fn setups<'a>(first: &'a Setup, commands: &'a [Command]) -> impl Iterator<Item = &'a Setup> {
    let changed = commands.iter().filter_map(|command| match command {
        Command::Change { setup } => Some(setup),
        _ => None,
    });
    iter::once(first).chain(changed)
}

/// The session of a record, run again. Whether it is the same shows in its hash.
///
/// # Errors
/// A [`Fault`] for a setup or a command that cannot be, naming its place; for a session that would take
/// too long; or for one that began with agents from files, or names other policies than these.
pub fn replay(record: &Record, policies: Policies, executor: Executor) -> Result<Lab, Fault> {
    if !record.loaded.is_empty() {
        let problem = "it begins with an agent from a file, so it cannot be run again from here";
        return Err(Fault::record("loaded", problem));
    }
    let known = policies.hashes(setups(&record.setup, &record.commands));
    if known != record.policies {
        let problem = "it names a policy whose file is not known here, so it cannot be run again";
        return Err(Fault::record("policies", problem));
    }
    let mut lab = Lab::open(record.setup.clone(), policies, executor)?;
    for (i, command) in record.commands.iter().enumerate() {
        lab.apply(command).map_err(|fault| Fault {
            problem: format!("command {}: {}", i + 1, fault.problem),
            ..fault
        })?;
    }
    Ok(lab)
}
