//! Learned agents of reaching as files.

use std::collections::HashMap;
use std::sync::Arc;

use babble_agent::reach::Experience;
use babble_agent::{
    AgentError, Learner, Network, ReachBabbling, ReachBrain, ReachNetwork, Variant,
};
use babble_env::{Config, Executor, Outcome, ReachOptions, ReachTask};
use safetensors::{SafeTensors, serialize};
use xxhash_rust::xxh3::Xxh3;

const QUASI_STATIC: ReachBabbling = ReachBabbling { quasi_static: true };

/// A small agent that has learnt a little, the task, and its file.
fn agent() -> (Learner<ReachNetwork>, ReachTask, Vec<u8>) {
    let brain = ReachBrain {
        output_neurons: 5,
        obstacle_neurons: 4,
        target_neurons: 3,
        ..ReachBrain::variant(Variant::Conjunctive)
    };
    let task = ReachTask::new(Config::profile("icub").unwrap(), ReachOptions::default()).unwrap();
    let mut learner = Learner::new(brain, &task, u64::MAX, QUASI_STATIC).unwrap();
    learner
        .learn(&task, 20, &mut Executor::new(2).unwrap())
        .unwrap();
    let bytes = learner.save().unwrap();
    (learner, task, bytes)
}

fn load(bytes: &[u8]) -> Result<Learner<ReachNetwork>, AgentError> {
    Learner::load(bytes)
}

fn refused(bytes: &[u8]) -> String {
    match load(bytes) {
        Err(AgentError::File { problem }) => problem,
        other => panic!(
            "expected a refusal, got {:?}",
            other.map(|learner| learner.babbling)
        ),
    }
}

/// What is loaded is what was saved, to the bit: weights, averages, config, body, seed and counts;
/// and it decides and learns on alike. Catches a number that goes through decimal text.
#[test]
fn round_trip_keeps_every_bit() {
    let (mut learner, task, bytes) = agent();
    let mut loaded = load(&bytes).unwrap();
    assert_eq!(*loaded.config(), task.config);
    assert_eq!(loaded.save().unwrap(), bytes);
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
    assert_eq!(loaded.save().unwrap(), learner.save().unwrap());
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

/// The same file with another text in the place of one in its JSON, and the checksum that fits.
fn with(bytes: &[u8], text: &str, other: &str) -> Vec<u8> {
    let (_, header) = SafeTensors::read_metadata(bytes).unwrap();
    let json = &header.metadata().as_ref().unwrap()["gym_babble.reach"];
    let (_, fields) = json.split_once("\",").unwrap();
    assert_eq!(fields.matches(text).count(), 1, "{text} in {fields}");
    let fields = fields.replace(text, other);
    let tensors = SafeTensors::deserialize(bytes).unwrap();
    let mut hash = Xxh3::new();
    hash.update(format!("{{{fields}").as_bytes());
    let names = ["weights", "a_mean", "g_mean"];
    let views = names.map(|name| (name, tensors.tensor(name).unwrap()));
    for (_, view) in &views {
        hash.update(view.data());
    }
    let json = format!("{{\"checksum\":\"{:016x}\",{fields}", hash.digest());
    let metadata = HashMap::from([("gym_babble.reach".to_owned(), json)]);
    serialize(views, Some(metadata)).unwrap()
}

/// A file whose counts no babbling has is refused, though its checksum is right, and the field is named.
/// Catches counts that are trusted: they decide with which babble learning goes on.
#[test]
fn counts_that_cannot_be_are_named() {
    let (learner, _, bytes) = agent();
    let babbled = format!("\"babbled\":{}", learner.babbling.babbled());
    let learnt = format!("\"learnt\":{}", learner.babbling.learnt());
    assert_eq!(with(&bytes, &babbled, &babbled), bytes);
    for (text, field, value) in [
        (&babbled, "babbled", "-1"),
        (&babbled, "babbled", "1e999"),
        (&babbled, "babbled", "2.5"),
        (&babbled, "babbled", "\"many\""),
        (&babbled, "babbled", "null"),
        (&babbled, "babbled", "true"),
        (&babbled, "babbled", "18446744073709551616"),
        (&babbled, "babbled", "18446744073709551615"),
        // So many without more to learn from end a search.
        (&babbled, "babbled", "2100001"),
        (&babbled, "babbled", "19"),
        (&learnt, "learnt", "-1"),
        (&learnt, "learnt", "1000000"),
        (&learnt, "learnt", "[20]"),
    ] {
        let problem = refused(&with(&bytes, text, &format!("\"{field}\":{value}")));
        assert!(problem.contains(field), "{field} = {value}: {problem}");
    }
    let seed = format!("\"seed\":{}", u64::MAX);
    assert!(refused(&with(&bytes, &seed, "\"seed\":-1")).contains("seed"));
    let still = with(&bytes, "\"quasi_static\":true", "\"quasi_static\":1");
    assert!(refused(&still).contains("babbling.quasi_static"));
}

/// An agent goes on learning on the config that it was made with alone, before and after it was stored,
/// and the field is named in which another one differs; it acts anywhere. Catches one that learns on, and
/// is stored, on the config that it happens to act in.
#[test]
fn another_config_is_refused_to_learn_on() {
    let (mut learner, task, bytes) = agent();
    let config = Config::from_json(r#"{"profile": "icub", "reach": {"movement_s": 5.0}}"#).unwrap();
    let other = Arc::new(ReachTask::new(config, ReachOptions::default()).unwrap());
    let pool = &mut Executor::new(1).unwrap();
    let mut loaded = load(&bytes).unwrap();
    for agent in [&mut learner, &mut loaded] {
        let refused = agent.learn(&other, 1, pool).unwrap_err();
        let AgentError::OtherConfig { field, here, .. } = refused else {
            panic!("{refused}");
        };
        assert_eq!((&*field, &*here), ("reach.movement_s", "5.0"));
        assert_eq!(agent.save().unwrap(), bytes);
        assert!(agent.network.policy(Arc::clone(&other)).is_ok());
        agent.learn(&task, 1, pool).unwrap();
    }
    assert_eq!(loaded.save().unwrap(), learner.save().unwrap());
}
