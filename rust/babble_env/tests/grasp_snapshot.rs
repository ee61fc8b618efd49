//! A snapshot of grasping continues bit for bit, in the middle of a contact too, or is refused.

mod playing;

use std::sync::Arc;

use babble_env::tasks::grasp::{GraspRequest, Region};
use babble_env::{Autoreset, Batch, Config, Control, EnvError, GraspOptions, GraspTask, Reward};
use playing::grasping::{
    CONTROLS, before_the_palm, goal_form, grasp, grasp_with, script, with_control,
};
use playing::{Actions, batch, bits, seeded};
use proptest::prelude::*;

fn options(control: Control) -> GraspOptions {
    GraspOptions {
        max_episode_steps: 90,
        enclosure_reflex: control == Control::Torque,
        ..with_control(control)
    }
}

/// The script with noise, so that hands miss and objects slip.
fn noisy(env: &Batch<GraspTask>, actions: &mut Actions) -> Vec<f32> {
    let action = script(env.task(), env.state(0).unwrap(), true);
    let noise = actions.draw();
    // In posture control 0.03 of half the shoulder's range is 4°.
    let posture = env.task().options.control == Control::Posture;
    let size = if posture { 0.03 } else { 0.3 };
    let with_noise = action.iter().zip(noise).map(|(a, b)| a + size * b);
    with_noise.collect()
}

/// An environment whose object lies before the palm, after some steps of a noisy script.
fn played(options: GraspOptions, seed: u64, steps: usize) -> (Batch<GraspTask>, Actions) {
    played_by(grasp(options), seed, steps)
}

fn played_by(task: Arc<GraspTask>, seed: u64, steps: usize) -> (Batch<GraspTask>, Actions) {
    let mut env = seeded(task, 1, Autoreset::NextStep, 1, seed);
    let near = before_the_palm(
        env.task(),
        if seed.is_multiple_of(2) { 0.024 } else { 0.05 },
    );
    env.request(0, near).unwrap();
    env.reset(&[true]).unwrap();
    let mut actions = Actions::of_width(1, 4);
    for _ in 0..steps {
        let action = noisy(&env, &mut actions);
        env.step(&action).unwrap();
    }
    (env, actions)
}

/// Any choice of options, on any body and hand, mostly with the default engine.
fn any_task() -> impl Strategy<Value = Arc<GraspTask>> {
    let controls = proptest::sample::select(&CONTROLS);
    let rewards = proptest::sample::select(Reward::ALL);
    let regions = proptest::sample::select(Region::ALL);
    let body = proptest::sample::select(&["paper", "icub"]);
    let fingers = proptest::sample::select(&["virtual", "independent"]);
    let engine = prop_oneof![4 => Just("tree"), 1 => Just("rapier")];
    let flags = any::<[bool; 3]>();
    (controls, rewards, regions, flags, body, fingers, engine).prop_map(
        |(control, reward, region, [goal, reflex, record], body, fingers, engine)| {
            let options = GraspOptions {
                reward: if goal { Reward::Sparse } else { reward },
                goal,
                region,
                enclosure_reflex: reflex,
                record,
                in_hand_starts: if reflex { 0.5 } else { 0.0 },
                ..options(control)
            };
            grasp_with(
                &format!(
                    r#"{{"profile": "{body}",
                        "body": {{"engine": "{engine}", "grip": {{"fingers": "{fingers}"}}}}}}"#
                ),
                options,
            )
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Saved at any moment (before, in and after the grasp, with the support or without, at the end of
    /// an episode or in a later one) with any choice of options, body, hand and engine, loaded into an
    /// environment that played something else: what follows is the same to the bit. Catches what the
    /// physics engine keeps between steps and does not write, and counts of the grasp that are not
    /// saved.
    #[test]
    fn continues_bit_for_bit(task in any_task(), seed in 0_u64..4, before in 0_usize..120, after in 1_usize..40) {
        let (mut env, mut actions) = played_by(task.clone(), seed, before);
        let bytes = env.save(0).unwrap();
        let mut other = seeded(task, 1, Autoreset::NextStep, 1, 999);
        for _ in 0..5 {
            other.step(&[0.3; 4]).unwrap();
        }
        other.load(0, &bytes).unwrap();
        prop_assert_eq!(other.save(0).unwrap(), bytes);
        let shown = |env: &Batch<GraspTask>| {
            let record = env.records().next().unwrap();
            (record.senses.clone(), record.info)
        };
        prop_assert_eq!(shown(&other), shown(&env));
        for _ in 0..after {
            let action = noisy(&env, &mut actions);
            env.step(&action).unwrap();
            other.step(&action).unwrap();
            prop_assert!(bits(&env) == bits(&other));
        }
    }
}

/// The moments that the property above is about do occur: contact, the support gone, the end.
#[test]
fn the_noisy_script_touches_and_grasps() {
    for control in CONTROLS {
        let (mut env, mut actions) = played(options(control), 1, 0);
        let [mut touching, mut tried] = [0; 2];
        for _ in 0..90 {
            let action = noisy(&env, &mut actions);
            env.step(&action).unwrap();
            let state = env.state(0).unwrap();
            touching += u32::from(env.task().robot.touch(&state.world).any());
            tried += u32::from(!env.task().robot.has_support(&state.world));
        }
        assert!(touching > 40 && tried > 5, "{control}: {touching} {tried}");
    }
}

fn refused(env: &mut Batch<GraspTask>, bytes: &[u8]) {
    let before = bits(env);
    let error = env
        .load(0, bytes)
        .expect_err("these bytes should be refused");
    assert!(matches!(error, EnvError::Snapshot { .. }), "{error}");
    assert!(bits(env) == before);
}

/// Bytes altered anywhere, cut short, one too many: refused, and the environment is as it was.
/// Catches a checksum over a part, and a state that is read before it is checked.
#[test]
fn altered_bytes_are_refused() {
    let (mut env, _) = played(options(Control::DeltaPosture), 0, 40);
    let bytes = env.save(0).unwrap();
    env.step(&[0.1; 4]).unwrap();
    for at in 0..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        refused(&mut env, &altered);
        refused(&mut env, &bytes[..at]);
    }
    refused(&mut env, &[&bytes[..], &[0]].concat());
    refused(&mut env, b"BBGS and then something else altogether");
    env.load(0, &bytes).unwrap();
    assert_eq!(env.save(0).unwrap(), bytes);
}

/// A snapshot belongs to its task, config and options, but for the recording of pictures. Catches
/// continuing a grasp under another body, or as a movement of reaching.
#[test]
fn foreign_snapshots_are_refused() {
    let base = options(Control::DeltaPosture);
    let (mut env, _) = played(base, 0, 3);
    let others = [
        with_control(Control::DeltaPosture),
        options(Control::Posture),
        GraspOptions {
            max_episode_steps: 90,
            ..goal_form(Control::DeltaPosture)
        },
        GraspOptions {
            enclosure_reflex: true,
            ..base
        },
    ];
    for other in others {
        refused(&mut env, &played(other, 0, 3).0.save(0).unwrap());
    }
    for config in [
        r#"{"profile": "icub"}"#,
        r#"{"grasp": {"hold_steps": 21}}"#,
        r#"{"body": {"object": {"friction": 0.7}}}"#,
    ] {
        let task = GraspTask::new(Config::from_json(config).unwrap(), base).unwrap();
        let other = seeded(task.into(), 1, Autoreset::NextStep, 1, 0);
        refused(&mut env, &other.save(0).unwrap());
    }
    let reaching = batch(
        playing::control(Control::Posture),
        1,
        Autoreset::NextStep,
        1,
        0,
    );
    refused(&mut env, &reaching.save(0).unwrap());
    // Numbers of reaching are none of grasping's business.
    let recording = GraspOptions {
        record: true,
        ..base
    };
    env.load(0, &played(recording, 0, 3).0.save(0).unwrap())
        .unwrap();
    let config = Config::from_json(r#"{"reach": {"success_radius_m": 0.03}}"#).unwrap();
    let task = GraspTask::new(config, base).unwrap();
    let other = seeded(task.into(), 1, Autoreset::NextStep, 1, 0);
    env.load(0, &other.save(0).unwrap()).unwrap();
}

/// An environment that was never reset has a snapshot too, and still needs a reset after it; what
/// was asked of the cases goes with a snapshot.
#[test]
fn fresh_environments_and_requests_are_kept() {
    let task = grasp(options(Control::Torque));
    let mut env = Batch::new(task.clone(), 1, Autoreset::NextStep, 1).unwrap();
    let bytes = env.save(0).unwrap();
    env.load(0, &bytes).unwrap();
    assert_eq!(env.step(&[0.0; 4]), Err(EnvError::NeedsReset { env: 0 }));
    let (near, _) = played(options(Control::Torque), 0, 5);
    env.load(0, &near.save(0).unwrap()).unwrap();
    env.reset(&[true]).unwrap();
    let request = env.state(0).unwrap().lifecycle.request;
    assert_eq!(request, before_the_palm(&task, 0.024));
    assert_ne!(request, GraspRequest::default());
}
