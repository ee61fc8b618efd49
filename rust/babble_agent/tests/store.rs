//! Learned agents of reaching as files.

use babble_agent::reach::Experience;
use babble_agent::{
    AgentError, Learner, Network, ReachBabbling, ReachBrain, ReachNetwork, Variant,
};
use babble_env::{Config, Executor, Outcome, ReachOptions, ReachTask};

/// A small agent that has learnt a little, the config of its task, and its file.
fn agent() -> (Learner<ReachNetwork>, Config, Vec<u8>) {
    let brain = ReachBrain {
        output_neurons: 5,
        obstacle_neurons: 4,
        target_neurons: 3,
        ..ReachBrain::variant(Variant::Conjunctive)
    };
    let task = ReachTask::new(Config::profile("icub").unwrap(), ReachOptions::default()).unwrap();
    let mut learner = Learner::new(brain, u64::MAX, ReachBabbling { quasi_static: true }).unwrap();
    learner
        .learn(&task, 20, &mut Executor::new(2).unwrap())
        .unwrap();
    let bytes = learner.save(task.config.clone()).unwrap();
    (learner, task.config, bytes)
}

fn load(bytes: &[u8]) -> Result<(Learner<ReachNetwork>, Config), AgentError> {
    Learner::load(bytes)
}

fn refused(bytes: &[u8]) -> String {
    match load(bytes) {
        Err(AgentError::File { problem }) => problem,
        other => panic!(
            "expected a refusal, got {:?}",
            other.map(|(_, config)| config)
        ),
    }
}

/// What is loaded is what was saved, to the bit: weights, averages, config, body, seed and counts;
/// and it decides and learns on alike. Catches a number that goes through decimal text.
#[test]
fn round_trip_keeps_every_bit() {
    let (mut learner, config, bytes) = agent();
    let (mut loaded, read) = load(&bytes).unwrap();
    assert_eq!(read, config);
    assert_eq!(loaded.save(read.clone()).unwrap(), bytes);
    let counts = |learner: &Learner<ReachNetwork>| {
        let babbling = &learner.babbling;
        (
            babbling.seed(),
            babbling.options(),
            babbling.babbled(),
            babbling.learnt(),
        )
    };
    assert_eq!(counts(&loaded), counts(&learner));
    let (ours, theirs) = (&mut learner.network, &mut loaded.network);
    assert_eq!(theirs.associations(), ours.associations());
    assert_eq!(theirs.config(), ours.config());
    let (eye, obstacle) = ([0.4, 0.6], [0.1, -0.2]);
    assert_eq!(theirs.decide(eye, obstacle), ours.decide(eye, obstacle));
    let more = [Experience {
        eye,
        obstacle,
        b: [0.7, 0.3],
        outcome: Outcome::Success,
    }];
    ours.learn(&more).unwrap();
    theirs.learn(&more).unwrap();
    assert_eq!(
        loaded.save(read.clone()).unwrap(),
        learner.save(read).unwrap()
    );
}

/// A weight beyond the rule's bound, or averages that do not fit, are named. Catches weights that are
/// set before they are checked.
#[test]
fn weights_that_do_not_fit_are_named() {
    let (learner, ..) = agent();
    let mut network = learner.network;
    let before = network.clone();
    let [w, a, g] = {
        let association = network.associations()[0];
        [
            association.weights(),
            association.a_mean(),
            association.g_mean(),
        ]
        .map(<[f32]>::to_vec)
    };
    let mut large = w.clone();
    large[3] = 0.3;
    let mut set =
        |w: &[f32], a: &[f32], g: &[f32]| network.set(0, w, a, g).map_err(|e| e.to_string());
    assert!(set(&large, &a, &g).unwrap_err().contains("number 3 is 0.3"));
    assert!(set(&w[1..], &a, &g).unwrap_err().starts_with("weights"));
    assert!(set(&w, &a[1..], &g).unwrap_err().starts_with("a_mean"));
    assert!(
        set(&w, &a, &vec![2.0; g.len()])
            .unwrap_err()
            .starts_with("g_mean")
    );
    assert_eq!(network.associations(), before.associations());
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
