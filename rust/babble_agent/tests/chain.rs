//! The chain of babbles: what its chunks do, what is kept, and what is learnt from it.

use babble_agent::chain::chunks::{Carry, Chunk, Close, Open, Return, TurnAway, Withdraw};
use babble_agent::chain::infant::{Infant, seconds};
use babble_agent::chain::{ChainBrain, ChainNetwork, Sequence};
use babble_agent::grasp::GraspBabbling;
use babble_agent::{AgentError, Babble, Babbling, Learner, Network, Rule, babble};
use babble_env::{Config, Executor, GraspOptions, GraspTask, Outcome, Purpose, Stream};

const DEG: f64 = std::f64::consts::PI / 180.0;

fn task() -> GraspTask {
    GraspTask::new(Config::from_json("{}").unwrap(), GraspOptions::default()).unwrap()
}

fn pool(threads: usize) -> Executor {
    Executor::new(threads).unwrap()
}

fn brain() -> ChainBrain {
    ChainBrain {
        eye_neurons: 11,
        neurons: 9,
        ..ChainBrain::default()
    }
}

fn learner(task: &GraspTask, brain: ChainBrain) -> Learner<ChainNetwork> {
    Learner::new(brain, task, 4, GraspBabbling::InHand).unwrap()
}

/// Runs some chunks, and shows arm, hand and object after each.
fn after<'a>(
    task: &'a GraspTask,
    seed: u64,
    chunks: &[&dyn Chunk],
) -> Option<(Infant<'a>, [f64; 2])> {
    let mut stream = Stream::new(Purpose::Learning, seed, 0);
    let (mut infant, _) = Infant::draw(task, &mut stream).unwrap();
    let mut before = infant.felt();
    for chunk in chunks {
        before = infant.felt();
        if !chunk.run(&mut infant, &mut stream).unwrap() {
            return None;
        }
    }
    Some((infant, before))
}

/// Each chunk does what it says: the reflex grips, opening opens, and withdrawal extends the elbow alone
/// by what was drawn, as far as the muscles come in 2 s; the object stays on its support meanwhile.
/// Catches a hand that stays closed, an elbow that folds, a shoulder that moves along, and an object that
/// the hand takes with it.
#[test]
fn chunks_do_what_they_say() {
    let task = task();
    let mut seen = 0;
    for seed in 0..12 {
        let Some((closed, _)) = after(&task, seed, &[&Close, &Carry]) else {
            continue;
        };
        assert!(closed.world.touch(&task).encloses());
        let carried = task.robot.object(closed.world.world());
        let (open, _) = after(&task, seed, &[&Close, &Carry, &Open]).unwrap();
        assert!(open.felt_hand().iter().all(|&x| x < 20.0 * DEG));
        let (away, from) = after(&task, seed, &[&Close, &Carry, &Open, &Withdraw]).unwrap();
        let (to, room) = (away.felt(), from[1] - task.arm.lower[1]);
        assert!(
            (to[0] - from[0]).abs() < 3.0 * DEG,
            "{seed}: {:?}",
            (from, to)
        );
        let extended = from[1] - to[1];
        assert!(extended < 40.0 * DEG && extended > room.min(10.0 * DEG) * 0.6 - 2.0 * DEG);
        let object = task.robot.object(away.world.world());
        assert!(
            (object - carried).norm() < 0.02,
            "{seed}: {carried} {object}"
        );
        seen += 1;
    }
    assert!(seen >= 8, "{seen}");
}

/// The arm comes back to where it had withdrawn to, off by the jitter at most. Catches a return to
/// another posture, and a jitter in radians.
#[test]
fn the_arm_returns_with_a_jitter() {
    let task = task();
    for (jitter_deg, most) in [(0.0, 6.0), (6.0, 14.0)] {
        let back = Return { jitter_deg };
        let chunks: [&dyn Chunk; 6] = [&Close, &Carry, &Open, &Withdraw, &TurnAway, &back];
        let found: Vec<_> = (0..10)
            .filter_map(|seed| after(&task, seed, &chunks))
            .collect();
        assert!(found.len() >= 6);
        for (infant, _) in found {
            let to = infant.memory.pregrasp.unwrap();
            for i in 0..2 {
                assert!((to[i] - infant.memory.withdrawn[i]).abs() < most * DEG);
            }
        }
    }
}

/// Babble k depends on the seed and k alone: any number of threads, any portions. Each is charged with its
/// whole time, and those that failed teach nothing.
#[test]
fn babbling_is_one_sequence() {
    let task = task();
    let options = GraspBabbling::Chain(Sequence::default());
    let experience = |portions: &[usize], threads| {
        let mut babbling = Babbling::<GraspTask>::new(4, options);
        let mut all = Vec::new();
        for &n in portions {
            all.extend(babbling.experience(&task, n, &mut pool(threads)).unwrap());
        }
        (all, babbling.babbled())
    };
    let (kept, babbled) = experience(&[8], 1);
    assert_eq!(experience(&[8], 2), (kept.clone(), babbled));
    assert_eq!(experience(&[3, 5], 2), (kept.clone(), babbled));
    let all = Babbling::<GraspTask>::new(4, options);
    let all = babble(&all, &task, babbled as usize, &mut pool(2))
        .unwrap()
        .concat();
    let learnable: Vec<_> = all.iter().filter(|one| one.is_kept()).cloned().collect();
    assert_eq!(learnable, kept);
    for one in &kept {
        assert_eq!(one.outcome, Outcome::Success);
        let numbers = [one.eye, one.arm, one.pregrasp.unwrap()].concat();
        assert!(
            numbers.iter().all(|x| (0.0..=1.0).contains(x)),
            "{numbers:?}"
        );
    }
    let steps = task.babble_steps(options) as f64 * task.config.grasp.control_period_s;
    assert!((steps - seconds(&Sequence::default())).abs() < 1e-9);
}

/// A learner that was saved and resumed is one that went on, in babbles and in trials, whatever the
/// number of threads. Catches uses or values that are not stored, and trials made twice.
#[test]
fn a_resumed_learner_goes_on() {
    let task = task();
    let mut whole = learner(&task, brain());
    whole.learn(&task, 6, &mut pool(1)).unwrap();
    whole.practise(&task, 50, &mut pool(1)).unwrap();
    let mut resumed = Learner::<ChainNetwork>::load(&whole.save().unwrap()).unwrap();
    for (learner, threads) in [(&mut whole, 1), (&mut resumed, 2)] {
        learner.learn(&task, 4, &mut pool(threads)).unwrap();
        learner.practise(&task, 50, &mut pool(threads)).unwrap();
    }
    assert_eq!(whole.save().unwrap(), resumed.save().unwrap());
    assert_eq!(whole.practice().trials, 100);
    let refused = whole.practise(&task, 51, &mut pool(1));
    assert!(matches!(
        refused,
        Err(AgentError::Config {
            field: "trials",
            ..
        })
    ));
}

/// With the outstar and one experience, the recalled maps have the shape of the experience's: Eq. 4 reads
/// its postures back. Catches outputs exchanged, and ends of the arm's ranges that are pulled inside.
#[test]
fn what_was_paired_is_recalled() {
    let task = task();
    let mut babbling = Babbling::<GraspTask>::new(2, GraspBabbling::Chain(Sequence::default()));
    let one = babbling
        .experience(&task, 1, &mut pool(1))
        .unwrap()
        .remove(0);
    let mut network = ChainNetwork::new(ChainBrain::default()).unwrap();
    network.learn(std::slice::from_ref(&one)).unwrap();
    let mut senses = vec![0.0; babble_env::tasks::grasp::SENSES];
    senses[babble_env::tasks::grasp::at::EYE..][..2].copy_from_slice(&one.eye);
    senses[babble_env::tasks::grasp::at::FOVEA..][..441].copy_from_slice(&*one.fovea);
    let found = network.decide_from(&senses).unwrap();
    let wanted = [one.pregrasp.unwrap(), one.arm].concat();
    for (found, wanted) in found.iter().zip(&wanted) {
        assert!(
            (found - f64::from(*wanted)).abs() < 0.02,
            "{found} {wanted}"
        );
    }
    for (found, wanted) in found[4..].iter().zip(one.hand) {
        assert!((found - f64::from(wanted)).abs() < 3.0, "{found} {wanted}");
    }
}

/// Numbers out of bounds are named.
#[test]
fn numbers_out_of_bounds_are_named() {
    for (field, brain) in [
        (
            "sizes",
            ChainBrain {
                sizes: 0,
                ..brain()
            },
        ),
        (
            "neurons",
            ChainBrain {
                neurons: 5,
                ..brain()
            },
        ),
        (
            "squeeze_deg",
            ChainBrain {
                squeeze_deg: -1.0,
                ..brain()
            },
        ),
    ] {
        let error = ChainNetwork::new(brain).unwrap_err();
        assert!(error.to_string().contains(field), "{error}");
    }
    let rule = "covariance".parse::<Rule>().unwrap();
    assert!(ChainNetwork::new(ChainBrain { rule, ..brain() }).is_ok());
}
