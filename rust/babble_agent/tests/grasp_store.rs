//! Agents of grasping as files.

use babble_agent::grasp::{Experience, GraspBabbling, GraspHebb, GraspHebbConfig, load, save};
use babble_agent::{AgentError, Babbling, Hebb, HebbConfig, Variant, store};
use babble_env::tasks::reach::movement::Fidelity;
use babble_env::{Config, Executor, GraspOptions, GraspTask};

/// A small agent that has learnt a little, and its file.
fn agent() -> (GraspHebb, GraspBabbling, Config, Vec<u8>) {
    let config = Config::from_json(r#"{"profile": "icub", "grasp": {"palm_reach_m": 0.061}}"#);
    let task = GraspTask::new(config.unwrap(), GraspOptions::default()).unwrap();
    let mut babbling = GraspBabbling::new(u64::MAX);
    let experiences = babbling
        .experience(&task, 6, &mut Executor::new(2).unwrap())
        .unwrap();
    let mut hebb = GraspHebb::new(GraspHebbConfig {
        neurons: 3,
        squeeze_deg: 12.5,
        ..GraspHebbConfig::default()
    })
    .unwrap();
    hebb.learn(&experiences).unwrap();
    let bytes = save(&hebb, &babbling, task.config.clone()).unwrap();
    (hebb, babbling, task.config, bytes)
}

fn refused(bytes: &[u8]) -> String {
    match load(bytes) {
        Err(AgentError::File { problem }) => problem,
        other => panic!(
            "expected a refusal, got {:?}",
            other.map(|(.., config)| config)
        ),
    }
}

/// What is loaded is what was saved, to the bit: weights, averages, numbers of the maps, body, seed
/// and counts; and it decides and learns on alike. Catches reach's weights read as grasp's, and a
/// number that goes through decimal text.
#[test]
fn round_trip_keeps_every_bit() {
    let (mut hebb, babbling, config, bytes) = agent();
    let (mut loaded, resumed, read) = load(&bytes).unwrap();
    assert_eq!(read, config);
    let counts = |babbling: &GraspBabbling| (babbling.seed(), babbling.babbles(), babbling.kept());
    assert_eq!(counts(&resumed), counts(&babbling));
    assert_eq!(loaded.config(), hebb.config());
    assert_eq!(
        (loaded.reach(), loaded.grasp()),
        (hebb.reach(), hebb.grasp())
    );
    assert_eq!(save(&loaded, &resumed, read.clone()).unwrap(), bytes);
    let fovea = Box::new(std::array::from_fn(|i| (i % 7) as f32 / 7.0));
    let eye = [0.4, 0.6];
    assert_eq!(loaded.decide(eye, &*fovea), hebb.decide(eye, &*fovea));
    let more = [Experience {
        eye,
        fovea,
        arm: [0.1, 0.9],
        hand: [40.0, 20.0],
        diameter: 0.03,
    }];
    hebb.learn(&more).unwrap();
    loaded.learn(&more).unwrap();
    let again = |hebb: &GraspHebb| save(hebb, &resumed, read.clone()).unwrap();
    assert_eq!(again(&loaded), again(&hebb));
    assert_ne!(again(&loaded), bytes);
}

/// A loaded agent babbles on where the saved one stopped.
#[test]
fn babbling_goes_on_from_a_file() {
    let (_, mut babbling, config, bytes) = agent();
    let (_, mut resumed, _) = load(&bytes).unwrap();
    let task = GraspTask::new(config, GraspOptions::default()).unwrap();
    let mut pool = Executor::new(2).unwrap();
    let next = babbling.experience(&task, 3, &mut pool).unwrap();
    assert_eq!(resumed.experience(&task, 3, &mut pool).unwrap(), next);
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
    let (.., config, bytes) = agent();
    let numbers = HebbConfig {
        output_neurons: 5,
        obstacle_neurons: 4,
        target_neurons: 3,
        ..HebbConfig::variant(Variant::Conjunctive)
    };
    let reaching = Hebb::new(numbers.clone()).unwrap();
    let fidelity = Fidelity::QuasiStatic;
    let babbling = Babbling::new(0, fidelity);
    let (movements, legal) = (babbling.movements(), babbling.legal());
    let metadata = store::Metadata::new(numbers, config, 0, fidelity, movements, legal);
    let theirs = store::save(&reaching, &metadata).unwrap();
    assert!(refused(&theirs).contains("gym_babble.grasp"));
    assert!(matches!(store::load(&bytes), Err(AgentError::File { .. })));
}

/// A file whose weights do not fit their maps names what does not fit.
#[test]
fn parts_that_do_not_fit_are_named() {
    let (hebb, ..) = agent();
    let parts =
        |w: &babble_brain::Association| [w.weights(), w.a_bar(), w.g_bar()].map(<[f32]>::to_vec);
    let config = hebb.config().clone();
    let whole = GraspHebb::from_parts(config.clone(), parts(hebb.reach()), parts(hebb.grasp()));
    assert_eq!(whole.unwrap().grasp(), hebb.grasp());
    for (i, name) in ["weights", "a_bar", "g_bar"].into_iter().enumerate() {
        let mut short = parts(hebb.grasp());
        short[i].pop();
        let error = GraspHebb::from_parts(config.clone(), parts(hebb.reach()), short).unwrap_err();
        assert!(
            error.to_string().contains(&format!("grasp.{name}")),
            "{error}"
        );
    }
    let mut large = parts(hebb.reach());
    large[0][3] = 0.3;
    assert!(GraspHebb::from_parts(config, large, parts(hebb.grasp())).is_err());
}
