//! Agents as files.

use babble_agent::store::{Metadata, load, save};
use babble_agent::{AgentError, Babbling, Hebb, HebbConfig, Variant};
use babble_env::tasks::reach::movement::Fidelity;
use babble_env::{Config, Executor, ReachOptions, ReachTask};

/// A small agent that has learnt a little, and its file.
fn agent() -> (Hebb, Metadata, Vec<u8>) {
    let config = HebbConfig {
        output_neurons: 5,
        obstacle_neurons: 4,
        target_neurons: 3,
        ..HebbConfig::variant(Variant::Conjunctive)
    };
    let task = ReachTask::new(Config::profile("icub").unwrap(), ReachOptions::default()).unwrap();
    let mut babbling = Babbling::new(u64::MAX, Fidelity::QuasiStatic);
    let experiences = babbling
        .experience(&task, 20, &mut Executor::new(2).unwrap())
        .unwrap();
    let mut hebb = Hebb::new(config.clone()).unwrap();
    hebb.learn(&experiences).unwrap();
    let (movements, legal) = (babbling.movements(), babbling.legal());
    let fidelity = Fidelity::QuasiStatic;
    let metadata = Metadata::new(config, task.config, u64::MAX, fidelity, movements, legal);
    let bytes = save(&hebb, &metadata).unwrap();
    (hebb, metadata, bytes)
}

fn refused(bytes: &[u8]) -> String {
    match load(bytes) {
        Err(AgentError::File { problem }) => problem,
        other => panic!(
            "expected a refusal, got {:?}",
            other.map(|(_, metadata)| metadata)
        ),
    }
}

/// What is loaded is what was saved, to the bit: weights, averages, config, body, seed and counts;
/// and it decides and learns on alike. Catches a number that goes through decimal text.
#[test]
fn round_trip_keeps_every_bit() {
    let (mut hebb, metadata, bytes) = agent();
    let (mut loaded, read) = load(&bytes).unwrap();
    assert_eq!(read, metadata);
    assert_eq!(save(&loaded, &read).unwrap(), bytes);
    let bits = |values: &[f32]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(
        bits(loaded.weights().weights()),
        bits(hebb.weights().weights())
    );
    let (eye, obstacle) = ([0.4, 0.6], [0.1, -0.2]);
    assert_eq!(loaded.decide(eye, obstacle), hebb.decide(eye, obstacle));
    let more = [babble_agent::Experience {
        eye,
        obstacle,
        b: [0.7, 0.3],
    }];
    hebb.learn(&more).unwrap();
    loaded.learn(&more).unwrap();
    assert_eq!(save(&loaded, &read).unwrap(), save(&hebb, &read).unwrap());
}

/// Cut short anywhere: refused. Catches a length that is trusted.
#[test]
fn truncated_files_are_refused() {
    let (_, _, bytes) = agent();
    for end in 0..bytes.len() {
        refused(&bytes[..end]);
    }
    refused(&[&bytes[..], &[0; 4]].concat());
}

/// Any bit altered anywhere, in the header or in a weight: refused. Catches a checksum that leaves
/// out a part, and weights that silently differ by one bit.
#[test]
fn altered_files_are_refused() {
    let (_, _, bytes) = agent();
    for at in 0..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        refused(&altered);
    }
}

/// Files of other programs are refused, also well-formed ones.
#[test]
fn foreign_files_are_refused() {
    refused(b"");
    refused(b"PK\x03\x04 a zip archive");
    let header = br#"{"weights":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}"#;
    let mut foreign = (header.len() as u64).to_le_bytes().to_vec();
    foreign.extend_from_slice(header);
    foreign.extend_from_slice(&[0; 4]);
    assert!(refused(&foreign).contains("gym_babble"));
}
