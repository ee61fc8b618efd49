//! A snapshot continues bit for bit, or is refused.

mod playing;

use std::sync::Arc;

use babble_env::tasks::reach::CaseRequest;
use babble_env::{Autoreset, Batch, Config, Control, EnvError, ReachOptions, ReachTask, Reward};
use playing::{Actions, bits, control, goal, seeded, task};
use proptest::prelude::*;

fn options(of: Control) -> ReachOptions {
    ReachOptions {
        max_episode_steps: 30,
        ..control(of)
    }
}

fn played(options: ReachOptions, steps: usize) -> (Batch<ReachTask>, Actions) {
    played_by(task(options), steps)
}

fn played_by(task: Arc<ReachTask>, steps: usize) -> (Batch<ReachTask>, Actions) {
    let mut env = seeded(task, 1, Autoreset::NextStep, 1, 8);
    let mut actions = Actions::new(1);
    for _ in 0..steps {
        env.step(&actions.draw()).unwrap();
    }
    (env, actions)
}

/// Any choice of options, on any body; episodes are short, so that many end.
fn any_task() -> impl Strategy<Value = Arc<ReachTask>> {
    let controls = proptest::sample::select(Control::ALL);
    let rewards = proptest::sample::select(Reward::ALL);
    let body = proptest::sample::select(&["paper", "icub"]);
    (controls, rewards, any::<[bool; 3]>(), body).prop_map(
        |(control, reward, [goal, settled, record], body)| {
            let options = ReachOptions {
                reward: if goal { Reward::Sparse } else { reward },
                goal,
                settled: settled && !goal,
                record,
                ..options(control)
            };
            Arc::new(ReachTask::new(Config::profile(body).unwrap(), options).unwrap())
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    /// Saved at any moment (first step, end of an episode, later ones) with any choice of options and
    /// body, loaded into an environment that played something else: what follows is the same to the
    /// bit. Catches a field that is not saved: the stream, the equilibrium point, the speeds, what was
    /// asked of the cases; and a check that refuses what some options lead to.
    #[test]
    fn continues_bit_for_bit(task in any_task(), before in 0_usize..70, after in 1_usize..70) {
        let (mut env, mut actions) = played_by(task.clone(), before);
        let bytes = env.save(0).unwrap();
        let mut other = seeded(task, 1, Autoreset::NextStep, 1, 999);
        other.step(&[0.3, 0.3]).unwrap();
        other.load(0, &bytes).unwrap();
        prop_assert_eq!(other.save(0).unwrap(), bytes);
        let senses = |env: &Batch<ReachTask>| env.records().next().unwrap().senses.clone();
        prop_assert_eq!(senses(&other), senses(&env));
        for _ in 0..after {
            let action = actions.draw();
            env.step(&action).unwrap();
            other.step(&action).unwrap();
            prop_assert_eq!(bits(&env), bits(&other));
        }
    }
}

fn refused(env: &mut Batch<ReachTask>, bytes: &[u8]) {
    let before = bits(env);
    let error = env
        .load(0, bytes)
        .expect_err("these bytes should be refused");
    assert!(matches!(error, EnvError::Snapshot { .. }), "{error}");
    assert_eq!(bits(env), before);
}

/// Any byte altered, any number of bytes missing, one too many: refused, and the environment is as
/// it was. Catches a checksum over a part, and a state that is read before it is checked.
#[test]
fn altered_bytes_are_refused() {
    let (mut env, _) = played(options(Control::DeltaPosture), 12);
    let bytes = env.save(0).unwrap();
    env.step(&[0.1, 0.1]).unwrap();
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut altered = bytes.clone();
            altered[at] ^= 1 << bit;
            refused(&mut env, &altered);
        }
        refused(&mut env, &bytes[..at]);
    }
    refused(&mut env, &[&bytes[..], &[0]].concat());
    refused(&mut env, b"BBRS and then something else altogether");
    env.load(0, &bytes).unwrap();
}

/// A snapshot belongs to its config and options, but for the recording of pictures.
/// Catches continuing an episode under another body.
#[test]
fn foreign_snapshots_are_refused() {
    let (mut env, _) = played(options(Control::DeltaPosture), 3);
    let others = [
        control(Control::DeltaPosture),
        options(Control::Posture),
        goal(Control::DeltaPosture),
        ReachOptions {
            settled: true,
            ..options(Control::DeltaPosture)
        },
    ];
    for other in others {
        refused(&mut env, &played(other, 3).0.save(0).unwrap());
    }
    let task = ReachTask::new(
        Config::profile("icub").unwrap(),
        options(Control::DeltaPosture),
    );
    let mut icub = Batch::new(task.unwrap().into(), 1, Autoreset::NextStep, 1).unwrap();
    icub.reset(&[true]).unwrap();
    refused(&mut env, &icub.save(0).unwrap());
    let recording = ReachOptions {
        record: true,
        ..options(Control::DeltaPosture)
    };
    env.load(0, &played(recording, 3).0.save(0).unwrap())
        .unwrap();
}

/// What was asked of the next episode, and not played yet, is asked of it after the snapshot too:
/// before the first reset, in mid-episode, and where an automatic reset will play it. One that cannot
/// be played is refused by the reset, as it would be without the snapshot. Catches a request that
/// is kept beside the state.
#[test]
fn a_pending_request_survives() {
    let asked = |target| CaseRequest {
        target: Some(target),
        ..CaseRequest::default()
    };
    for steps in [None, Some(0), Some(12), Some(30)] {
        let fresh = || Batch::new(task(options(Control::Posture)), 1, Autoreset::NextStep, 1);
        let mut env = match steps {
            None => fresh().unwrap(),
            Some(steps) => played(options(Control::Posture), steps).0,
        };
        for (target, playable) in [
            ([0.1, 0.25], true),
            ([9.0, 9.0], false),
            ([f64::NAN; 2], false),
        ] {
            env.request(0, asked(target)).unwrap();
            let mut other = fresh().unwrap();
            other.load(0, &env.save(0).unwrap()).unwrap();
            assert_eq!(other.reset(&[true]).is_ok(), playable);
            assert_eq!(env.reset(&[true]).is_ok(), playable);
            assert_eq!(bits(&env), bits(&other));
            if playable {
                assert_eq!(other.state(0).unwrap().case.target, target);
            }
        }
    }
    let (mut env, _) = played(options(Control::Posture), 30);
    env.request(0, asked([0.1, 0.25])).unwrap();
    env.load(0, &env.save(0).unwrap()).unwrap();
    env.step(&[0.0; 2]).unwrap();
    assert_eq!(env.state(0).unwrap().case.target, [0.1, 0.25]);
}

/// An environment that was never reset has a snapshot too, and still needs a reset after it.
#[test]
fn fresh_environments_stay_fresh() {
    let mut env = Batch::new(task(options(Control::Torque)), 1, Autoreset::NextStep, 1).unwrap();
    let bytes = env.save(0).unwrap();
    env.load(0, &bytes).unwrap();
    assert_eq!(env.step(&[0.0; 2]), Err(EnvError::NeedsReset { env: 0 }));
}
