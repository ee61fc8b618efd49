//! What fuzzing of requests found and began with, replayed.

#[path = "../../../fuzz/src/openenv_messages.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod openenv_messages;
#[path = "../../../fuzz/src/requests.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod requests;

use std::fs;
use std::path::Path;

use proptest::prelude::*;

/// Of each operation a request is done. Fails when a message changed, after which no input reaches
/// what it is for: `cargo run --bin seeds` in `fuzz` writes those that fuzzing begins with anew.
#[test]
fn the_corpus_is_read() {
    let done = replayed("request", requests::request);
    assert!(done >= 13, "{done} are done");
}

/// As of requests.
#[test]
fn the_corpus_of_openenvs_messages_is_read() {
    let done = replayed("openenv_message", openenv_messages::message);
    assert!(done >= 7, "{done} are done");
}

/// How many inputs of a target can be done.
fn replayed(target: &str, play: impl Fn(&[u8]) -> bool) -> usize {
    let mut done = 0;
    for (name, input) in corpus(target) {
        let is_done = play(&input);
        println!("{name}: {is_done}");
        done += usize::from(is_done);
    }
    done
}

/// The inputs of a target by their names, which order them.
fn corpus(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let mut inputs: Vec<_> = fs::read_dir(folder.join(target))
        .unwrap()
        .map(|entry| {
            let path = entry.unwrap().path();
            (path.display().to_string(), fs::read(&path).unwrap())
        })
        .collect();
    inputs.sort();
    inputs
}

/// One of the inputs with some bytes changed.
fn changed(target: &str) -> impl Strategy<Value = Vec<u8>> + use<> {
    let byte = (any::<prop::sample::Index>(), any::<u8>());
    let changes = prop::collection::vec(byte, 1..4);
    (prop::sample::select(corpus(target)), changes).prop_map(|((_, mut input), changes)| {
        for (at, value) in changes {
            let at = at.index(input.len());
            input[at] = value;
        }
        input
    })
}

proptest! {
    #[test]
    fn a_changed_request_is_played_or_refused(input in changed("request")) {
        requests::request(&input);
    }
}
