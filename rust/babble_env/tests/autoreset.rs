//! When an ended episode begins anew.

mod playing;

use babble_env::batch::Record;
use babble_env::{Autoreset, Batch, Control, EnvError, ReachOptions, ReachTask};
use playing::{Actions, batch, bits, control};

fn options(of: Control) -> ReachOptions {
    ReachOptions {
        max_episode_steps: 15,
        ..control(of)
    }
}

fn ended(record: &Record) -> bool {
    record.step.terminated || record.step.truncated
}

fn record(batch: &Batch<ReachTask>) -> Record {
    batch.records().next().unwrap().clone()
}

/// What a person sees who resets by hand: the record after each reset and each step.
fn by_hand(of: Control, episodes: usize) -> Vec<Vec<Record>> {
    let mut env = batch(options(of), 1, Autoreset::Disabled, 1, 21);
    let mut actions = Actions::new(1);
    let mut played = Vec::new();
    for _ in 0..episodes {
        let mut episode = vec![record(&env)];
        while !ended(&episode[episode.len() - 1]) {
            env.step(&actions.draw()).unwrap();
            episode.push(record(&env));
        }
        played.push(episode);
        env.reset(&[true]).unwrap();
    }
    played
}

/// At the next step: the ending step shows the end, the one after it the first observation of the
/// same new episode that a reset by hand gives, without reward, its action ignored. Catches a
/// reset within the ending step, one that plays the action, and an ended episode that is lost.
#[test]
fn next_step_resets_one_step_later() {
    for &of in Control::ALL {
        let mut env = batch(options(of), 1, Autoreset::NextStep, 1, 21);
        let mut actions = Actions::new(1);
        for episode in by_hand(of, 12) {
            assert_eq!(record(&env), episode[0]);
            for expected in &episode[1..] {
                env.step(&actions.draw()).unwrap();
                assert_eq!(record(&env), *expected);
                assert!(env.final_episodes().next().unwrap().is_none());
            }
            env.step(&[1.0, -1.0]).unwrap();
            let last = env.final_episodes().next().unwrap();
            let last = last.expect("the episode that the reset replaced");
            assert_eq!(last.record, episode[episode.len() - 1]);
        }
    }
}

/// Within the step: reward and end are those of the ending step, the observation is the new
/// episode's first, and the final one is kept aside until the next step. Catches an observation of
/// the wrong episode and an end that is forgotten.
#[test]
fn same_step_resets_at_once_and_keeps_the_end() {
    for &of in Control::ALL {
        let mut env = batch(options(of), 1, Autoreset::SameStep, 1, 21);
        let mut actions = Actions::new(1);
        let episodes = by_hand(of, 12);
        for (episode, next) in episodes.iter().zip(&episodes[1..]) {
            let (end, middle) = episode[1..].split_last().unwrap();
            for expected in middle {
                env.step(&actions.draw()).unwrap();
                assert_eq!(record(&env), *expected);
                assert!(env.final_episodes().next().unwrap().is_none());
            }
            env.step(&actions.draw()).unwrap();
            let last = env
                .final_episodes()
                .next()
                .unwrap()
                .expect("the episode that ended");
            assert_eq!(last.record, *end);
            assert_eq!(last.state.progress.outcome, end.info.outcome);
            let shown = record(&env);
            assert_eq!(shown.step, end.step);
            assert_eq!(
                shown,
                Record {
                    step: end.step,
                    ..next[0].clone()
                }
            );
        }
    }
}

/// Never: a step after the end is refused for the whole batch, names the environment and leaves
/// all as it was; after a reset of that one alone all step on.
#[test]
fn disabled_waits_for_the_user() {
    let mut env = batch(options(Control::DeltaPosture), 3, Autoreset::Disabled, 1, 4);
    for i in 0..15 {
        env.step(&[0.0; 6]).unwrap();
        if i == 7 {
            env.reset(&[true, false, true]).unwrap();
        }
    }
    assert_eq!(
        env.records().map(ended).collect::<Vec<_>>(),
        [false, true, false]
    );
    let before = bits(&env);
    assert_eq!(env.step(&[0.5; 6]), Err(EnvError::NeedsReset { env: 1 }));
    assert_eq!(bits(&env), before);
    env.reset(&[false, true, false]).unwrap();
    let after = bits(&env);
    assert_eq!((&after.0[0], &after.0[2]), (&before.0[0], &before.0[2]));
    env.step(&[0.5; 6]).unwrap();
}
