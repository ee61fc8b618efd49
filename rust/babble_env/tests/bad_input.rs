//! What a batch refuses, and that nothing was stepped when it did.

mod playing;

use babble_env::batch::Record;
use babble_env::tasks::reach::case::obstacle_at;
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Autoreset, Batch, Config, Control, EnvError, Executor, ReachOptions, ReachTask, Reward, Task,
};
use playing::{batch, bits, control, goal, task};

/// NaN, infinite and missing numbers are named with their place; no environment of the batch has
/// moved, and the next good step works. Catches a check in the middle of the step.
#[test]
fn bad_actions_leave_everything_as_it_was() {
    for &of in Control::ALL {
        for threads in [1, 2] {
            let mut env = batch(control(of), 3, Autoreset::NextStep, threads, 0);
            let before = bits(&env);
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let error = env.step(&[0.1, 0.1, 0.1, bad, 0.1, 0.1]).unwrap_err();
                assert!(
                    matches!(error, EnvError::ActionNotFinite { env: 1, index: 1, value }
                        if value.to_bits() == bad.to_bits()),
                    "{error}"
                );
            }
            for got in [0, 5, 7, 12] {
                let expected = EnvError::ActionShape { got, expected: 6 };
                assert_eq!(env.step(&vec![0.0; got]), Err(expected));
            }
            assert_eq!(bits(&env), before);
            env.step(&[0.1; 6]).unwrap();
        }
    }
}

/// Actions beyond −1…1 are played as the bounds are. Catches an arm driven out of its ranges.
#[test]
fn actions_are_clipped() {
    for &of in Control::ALL {
        let [mut inside, mut outside] =
            [(); 2].map(|()| batch(control(of), 1, Autoreset::NextStep, 1, 6));
        for _ in 0..5 {
            inside.step(&[1.0, -1.0]).unwrap();
            outside.step(&[1e30, -7.0]).unwrap();
            assert_eq!(bits(&inside), bits(&outside));
        }
    }
}

#[test]
fn stepping_needs_a_reset_first() {
    let mut env = Batch::new(task(control(Control::Posture)), 2, Autoreset::NextStep, 1).unwrap();
    env.reset(&[true, false]).unwrap();
    let before = bits(&env);
    assert_eq!(env.step(&[0.0; 4]), Err(EnvError::NeedsReset { env: 1 }));
    assert_eq!(bits(&env), before);
}

/// Cases that cannot be played are refused by the reset and named; the episode goes on as if
/// nothing had been asked. Catches a half-done reset.
#[test]
fn impossible_cases_are_named() {
    let mut env = batch(control(Control::DeltaPosture), 1, Autoreset::NextStep, 1, 2);
    let task = env.task().clone();
    let start = env.state(0).unwrap().case.hand;
    let (far, behind, nan) = ([0.5, 0.0], [0.0, -0.38], [f64::NAN, 0.1]);
    let ask = |start, target| CaseRequest {
        start,
        target,
        ..CaseRequest::default()
    };
    let blocked = CaseRequest {
        start: Some(start),
        target: Some(start),
        obstacle: ObstacleRequest::At(obstacle_at(&task, start)),
    };
    let cases = [
        ("start", ask(Some(far), None)),
        ("start", ask(Some(nan), Some(start))),
        ("target", ask(None, Some(behind))),
        ("target", ask(Some(start), Some(far))),
        ("obstacle", blocked),
    ];
    let before = bits(&env);
    for (part, request) in cases {
        env.request(0, request).unwrap();
        let error = env.reset(&[true]).unwrap_err();
        assert!(
            matches!(error, EnvError::Case { what, .. } if what == part),
            "{part}: {error}"
        );
        assert_eq!(bits(&env), before);
    }
    env.step(&[0.0; 2]).unwrap();
}

/// Options that contradict each other or are out of bounds are named.
#[test]
fn impossible_options_are_named() {
    let make = |options| ReachTask::new(Config::profile("paper").unwrap(), options).map(|_| ());
    let base = ReachOptions::default();
    let progress = ReachOptions {
        reward: Reward::Progress,
        ..goal(Control::Posture)
    };
    let settled = ReachOptions {
        settled: true,
        ..goal(Control::Posture)
    };
    for (options, name) in [(progress, "reward"), (settled, "settled")] {
        let error = make(options).unwrap_err();
        assert!(
            matches!(error, EnvError::Option { option, .. } if option == name),
            "{error}"
        );
    }
    for max_episode_steps in [0, 1_000_001] {
        let error = make(ReachOptions {
            max_episode_steps,
            ..base
        })
        .unwrap_err();
        assert!(
            error.to_string().starts_with("max_episode_steps = "),
            "{error}"
        );
    }
    for (n, threads, name) in [(0, 1, "num_envs"), (1, 0, "threads"), (1, 1025, "threads")] {
        let error = Batch::new(task(base), n, Autoreset::NextStep, threads).unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
    assert!(Executor::new(0).is_err());
    assert!(
        "fast"
            .parse::<Control>()
            .unwrap_err()
            .to_string()
            .contains("delta_posture")
    );
    assert!(
        Config::profile("nao")
            .unwrap_err()
            .to_string()
            .contains("icub")
    );
}

/// An environment that does not exist is named by whatever asks for it.
#[test]
fn unknown_environments_are_named() {
    let mut env = batch(control(Control::Posture), 2, Autoreset::NextStep, 1, 0);
    let errors = [
        env.seed(2, 0).unwrap_err(),
        env.save(2).unwrap_err(),
        env.state(9).map(|_| ()).unwrap_err(),
        env.request(2, CaseRequest::default()).unwrap_err(),
    ];
    for error in errors {
        assert!(error.to_string().contains("below 2"), "{error}");
    }
}

/// Whatever is played, observations are finite and inside the bounds that the spec promises.
#[test]
fn observations_keep_to_the_spec() {
    for &of in Control::ALL {
        let mut env = batch(control(of), 8, Autoreset::NextStep, 1, 70);
        let senses = env.task().spec().senses;
        let low: Vec<f64> = senses.iter().flat_map(|entry| entry.low.clone()).collect();
        let high: Vec<f64> = senses.iter().flat_map(|entry| entry.high.clone()).collect();
        let mut actions = playing::Actions::new(8);
        for _ in 0..200 {
            env.step(&actions.draw()).unwrap();
            for Record { senses, .. } in env.records() {
                for (i, &x) in senses.iter().enumerate() {
                    let inside = low[i] as f32 <= x && x <= high[i] as f32;
                    assert!(
                        inside,
                        "{of}: sense {i} = {x} outside of {}…{}",
                        low[i], high[i]
                    );
                }
            }
        }
    }
}
