//! Plays the golden trajectories of both tasks and compares them with the snapshots of
//! `babble_env/tests/golden.rs`, in a build of any kind: for another processor, or for WebAssembly,
//! where a panic ends the program with a trap.

#[path = "../../babble_env/tests/playing/mod.rs"]
mod playing;

use std::collections::BTreeMap;

use playing::golden;

/// The JSON of a snapshot, below its head.
macro_rules! snapshot {
    ($name:literal) => {
        include_str!(concat!(
            "../../babble_env/tests/snapshots/golden__",
            $name,
            ".snap"
        ))
    };
}

fn compare(task: &str, played: &BTreeMap<String, String>, snapshot: &str) {
    let (_, json) = snapshot.split_once("\n---\n").expect("a head and a body");
    let held: BTreeMap<String, String> = serde_json::from_str(json).expect("hashes by name");
    assert_eq!(played, &held, "{task}: other bits than in the snapshot");
    println!("{task}: the same bits in {} places", held.len());
}

fn main() {
    compare(
        "reaching",
        &golden::reaching(),
        snapshot!("trajectories_are_golden"),
    );
    compare(
        "grasping",
        &golden::grasping(),
        snapshot!("grasps_are_golden"),
    );
}
