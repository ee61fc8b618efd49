//! Agents of grasping as files.

use babble_agent::grasp::{Experience, GraspBabbling};
use babble_agent::{
    AgentError, GraspBrain, GraspNetwork, Learner, Network, ReachBabbling, ReachBrain,
    ReachNetwork, Variant,
};
use babble_env::{Config, Executor, GraspOptions, GraspTask, Outcome, ReachOptions, ReachTask};

/// A small agent that has learnt a little, its task, and its file.
fn agent() -> (Learner<GraspNetwork>, GraspTask, Vec<u8>) {
    let config = Config::from_json(r#"{"profile": "icub", "grasp": {"palm_reach_m": 0.061}}"#);
    let task = GraspTask::new(config.unwrap(), GraspOptions::default()).unwrap();
    let brain = GraspBrain {
        neurons: 3,
        squeeze_deg: 12.5,
        ..GraspBrain::default()
    };
    let mut learner = Learner::new(brain, &task, u64::MAX, GraspBabbling::InHand).unwrap();
    learner
        .learn(&task, 6, &mut Executor::new(2).unwrap())
        .unwrap();
    let bytes = learner.save().unwrap();
    (learner, task, bytes)
}

fn load(bytes: &[u8]) -> Result<Learner<GraspNetwork>, AgentError> {
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

/// What is loaded is what was saved, to the bit: weights, averages, numbers of the maps, body, seed
/// and counts; and it decides and learns on alike. Catches reach's weights read as grasp's, and a
/// number that goes through decimal text.
#[test]
fn round_trip_keeps_every_bit() {
    let (mut learner, task, bytes) = agent();
    let mut loaded = load(&bytes).unwrap();
    assert_eq!(*loaded.config(), task.config);
    let counts = |learner: &Learner<GraspNetwork>| {
        let babbling = &learner.babbling;
        (babbling.seed(), babbling.babbled(), babbling.learnt())
    };
    assert_eq!(counts(&loaded), counts(&learner));
    let (ours, theirs) = (&mut learner.network, &mut loaded.network);
    assert_eq!(theirs.config(), ours.config());
    assert_eq!(theirs.associations(), ours.associations());
    let fovea = Box::new(std::array::from_fn(|i| (i % 7) as f32 / 7.0));
    let eye = [0.4, 0.6];
    assert_eq!(theirs.decide(eye, &*fovea), ours.decide(eye, &*fovea));
    let more = [Experience {
        eye,
        fovea,
        arm: [0.1, 0.9],
        hand: [40.0, 20.0],
        pregrasp: None,
        diameter: 0.03,
        outcome: Outcome::Success,
    }];
    ours.learn(&more).unwrap();
    theirs.learn(&more).unwrap();
    let again = |learner: &Learner<GraspNetwork>| learner.save().unwrap();
    assert_eq!(again(&loaded), again(&learner));
    assert_ne!(again(&loaded), bytes);
}

/// A loaded agent babbles on where the saved one stopped.
#[test]
fn babbling_goes_on_from_a_file() {
    let (mut learner, task, bytes) = agent();
    let mut loaded = load(&bytes).unwrap();
    let mut pool = Executor::new(2).unwrap();
    learner.learn(&task, 3, &mut pool).unwrap();
    loaded.learn(&task, 3, &mut pool).unwrap();
    assert_eq!(
        loaded.network.associations(),
        learner.network.associations()
    );
}

/// Cut short, or with more at the end: refused. Catches a length that is trusted.
#[test]
fn truncated_files_are_refused() {
    let (.., bytes) = agent();
    for end in (0..bytes.len()).step_by(13).chain([bytes.len() - 1]) {
        refused(&bytes[..end]);
    }
    refused(&[&bytes[..], &[0; 4]].concat());
}

/// Any bit altered anywhere, in the header or in a weight: refused. Catches a checksum that leaves
/// out a part, and weights that silently differ by one bit.
#[test]
fn altered_files_are_refused() {
    let (.., bytes) = agent();
    let header = 8 + u64::from_le_bytes(*bytes.first_chunk().unwrap()) as usize;
    for at in (0..header).chain((header..bytes.len()).step_by(5)) {
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        refused(&altered);
    }
}

/// Files of other programs are refused, and agents of reaching are; so are those of grasping there.
#[test]
fn foreign_files_are_refused() {
    refused(b"");
    refused(b"PK\x03\x04 a zip archive");
    let (.., bytes) = agent();
    let reach = ReachTask::new(Config::profile("paper").unwrap(), ReachOptions::default()).unwrap();
    let brain = ReachBrain {
        output_neurons: 5,
        obstacle_neurons: 4,
        target_neurons: 3,
        ..ReachBrain::variant(Variant::Conjunctive)
    };
    let reaching =
        Learner::<ReachNetwork>::new(brain, &reach, 0, ReachBabbling::default()).unwrap();
    let theirs = reaching.save().unwrap();
    assert!(refused(&theirs).contains("gym_babble.grasp"));
    let reached = Learner::<ReachNetwork>::load(&bytes);
    assert!(matches!(reached, Err(AgentError::File { .. })));
}

/// Weights that do not fit their association are named, and nothing is set.
#[test]
fn parts_that_do_not_fit_are_named() {
    let mut network = agent().0.network;
    let before = network.clone();
    let parts: Vec<[Vec<f32>; 3]> = network
        .associations()
        .iter()
        .map(|w| [w.weights(), w.a_mean(), w.g_mean()].map(<[f32]>::to_vec))
        .collect();
    for (i, whole) in parts.iter().enumerate() {
        for (part, name) in ["weights", "a_mean", "g_mean"].into_iter().enumerate() {
            let mut short = whole.clone();
            short[part].pop();
            let error = network.set(i, &short[0], &short[1], &short[2]);
            assert!(error.unwrap_err().to_string().starts_with(name));
        }
        let mut large = whole.clone();
        large[0][3] = 0.3;
        assert!(network.set(i, &large[0], &large[1], &large[2]).is_err());
        assert!(network.set(i, &whole[0], &whole[1], &whole[2]).is_ok());
    }
    assert_eq!(network.associations(), before.associations());
}
