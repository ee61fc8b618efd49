//! What fuzzing found and began with, replayed: nothing panics, and what was read is gone on with.

#[path = "../../../fuzz/src/lib.rs"]
#[expect(
    unreachable_pub,
    dead_code,
    reason = "it is a crate of its own, of which the seeds use more"
)]
mod fuzz;

use std::fs;
use std::path::Path;

/// How many inputs of a target's corpus are taken, and how many there are.
fn replayed(target: &str, run: fn(&[u8]) -> bool) -> (usize, usize) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let (mut taken, mut all) = (0, 0);
    for entry in fs::read_dir(corpus.join(target)).unwrap() {
        let path = entry.unwrap().path();
        println!("{}", path.display());
        taken += usize::from(run(&fs::read(&path).unwrap()));
        all += 1;
    }
    (taken, all)
}

/// Of each format some inputs are taken. Fails when a format changed, after which no input reaches
/// what it is for: `cargo run --bin seeds` in `fuzz` writes those that fuzzing begins with anew.
#[test]
fn the_corpus_is_read() {
    for (target, run, seeds) in [
        (
            "reach_snapshot",
            fuzz::reach_snapshot as fn(&[u8]) -> bool,
            6,
        ),
        ("grasp_snapshot", fuzz::grasp_snapshot, 7),
        ("config", fuzz::config, 3),
        ("agent_file", fuzz::agent_file, 3),
    ] {
        let (taken, all) = replayed(target, run);
        assert!(taken >= seeds, "{target}: {taken} of {all} are taken");
    }
}
