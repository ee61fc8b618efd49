//! Records of the lab: refused, or run again, and what they end in can be gone on with.

use std::cell::Cell;
use std::time::{Duration, Instant};

use babble_env::Executor;
use babble_lab::{Command, Lab, Policies, Record, ToJson, replay};

/// Time after which long work stops, so that no input takes long.
const LIMIT: Duration = Duration::from_secs(2);
/// Commands of a record that are done.
const COMMANDS: usize = 8;

/// A record as text. Whether it can be run again.
pub fn record(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(mut record) = Record::from_json(text) else {
        return false;
    };
    record.commands.truncate(COMMANDS);
    record.commands.iter_mut().for_each(shorten);
    begin();
    let Ok(lab) = run(&record) else {
        return false;
    };
    lab.state()
        .expect("it has a state")
        .to_json()
        .expect("as JSON");
    let name = record.lesson.as_deref();
    let again = lab.record(name, "again").expect("a record");
    let text = again.to_json().expect("as JSON");
    let again = Record::from_json(&text).expect("it is read again");
    begin();
    match run(&again) {
        Ok(other) => assert_eq!(other.hash().expect("a hash"), again.hash),
        Err(fault) => assert_eq!(fault.kind, "Interrupted"),
    }
    true
}

fn run(record: &Record) -> Result<Lab, babble_lab::Fault> {
    let executor = Executor::new(1).expect("a thread");
    let mut lab = replay(
        record,
        Policies::default(),
        executor.interrupted_by(is_over),
    )?;
    // After an error it is as it was before.
    let hash = lab.hash()?;
    if lab.apply(&Command::Step { n: 1 }).is_err() {
        assert_eq!(lab.hash()?, hash);
    } else {
        lab.undo()?;
    }
    Ok(lab)
}

/// Less of a command that takes long.
fn shorten(command: &mut Command) {
    let (n, most) = match command {
        Command::Babble { n } | Command::Test { n } => (n, 2),
        Command::Step { n } => (n, 100),
        _ => return,
    };
    *n = (*n).min(most);
}

thread_local! {
    static BEGAN: Cell<Option<Instant>> = const { Cell::new(None) };
}

fn begin() {
    BEGAN.set(Some(Instant::now()));
}

fn is_over() -> bool {
    BEGAN.get().is_none_or(|began| began.elapsed() > LIMIT)
}
