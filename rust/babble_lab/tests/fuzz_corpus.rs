//! What fuzzing of records found and began with, replayed.

#[path = "../../../fuzz/src/lab_records.rs"]
#[expect(unreachable_pub, reason = "it is part of a crate of its own")]
mod lab_records;

use std::fs;
use std::path::Path;

/// Some records can be run again. Fails when their format changed, after which no input reaches what it is for:
/// `cargo run --bin seeds` in `fuzz` writes those that fuzzing begins with anew.
#[test]
fn the_corpus_is_read() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/lab_record");
    let mut done = 0;
    for entry in fs::read_dir(corpus).unwrap() {
        let path = entry.unwrap().path();
        let is_done = lab_records::record(&fs::read(&path).unwrap());
        println!("{}: {is_done}", path.display());
        done += usize::from(is_done);
    }
    assert!(done >= 5, "{done} are done");
}
