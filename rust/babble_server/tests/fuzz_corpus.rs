//! What fuzzing of requests found and began with, replayed.

#[path = "../../../fuzz/src/openenv_messages.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod openenv_messages;
#[path = "../../../fuzz/src/requests.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod requests;

use std::fs;
use std::path::Path;

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
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let mut done = 0;
    for entry in fs::read_dir(corpus.join(target)).unwrap() {
        let path = entry.unwrap().path();
        let is_done = play(&fs::read(&path).unwrap());
        println!("{}: {is_done}", path.display());
        done += usize::from(is_done);
    }
    done
}
