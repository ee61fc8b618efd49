//! What fuzzing of requests found and began with, replayed.

#[path = "../../../fuzz/src/requests.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod requests;

use std::fs;
use std::path::Path;

/// Of each operation a request is done. Fails when a message changed, after which no input reaches
/// what it is for: `cargo run --bin seeds` in `fuzz` writes those that fuzzing begins with anew.
#[test]
fn the_corpus_is_read() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/request");
    let mut done = 0;
    for entry in fs::read_dir(corpus).unwrap() {
        let path = entry.unwrap().path();
        let is_done = requests::request(&fs::read(&path).unwrap());
        println!("{}: {is_done}", path.display());
        done += usize::from(is_done);
    }
    assert!(done >= 13, "{done} are done");
}
