//! Grasping gives the same bits for any number of threads, in a batch and alone, and after any past;
//! and begins anew as every task does.

mod playing;

use std::sync::Arc;

use babble_env::batch::Record;
use babble_env::{Autoreset, Batch, Control, GraspOptions, GraspTask};
use playing::grasping::{CONTROLS, before_the_palm, grasp, with_control};
use playing::{Actions, bits, ended, record};

const N: usize = 8;
const STEPS: usize = 40;

/// Short episodes, so that many begin anew, with the reflex, so that hands close.
fn short(control: Control) -> Arc<GraspTask> {
    grasp(GraspOptions {
        max_episode_steps: 25,
        enclosure_reflex: true,
        in_hand_starts: 0.3,
        ..with_control(control)
    })
}

/// n environments with the seeds `seed`, …; in every second one the object lies before the palm.
fn batch(
    task: Arc<GraspTask>,
    n: usize,
    autoreset: Autoreset,
    threads: usize,
    seed: u64,
) -> Batch<GraspTask> {
    let near = before_the_palm(&task, 0.05);
    let mut batch = Batch::new(task, n, autoreset, threads).unwrap();
    for i in 0..n {
        let seed = seed + i as u64;
        batch.seed(i, seed).unwrap();
        if seed.is_multiple_of(2) {
            batch.request(i, near).unwrap();
        }
    }
    batch.reset(&vec![true; n]).unwrap();
    batch
}

/// 1, 2 and 8 threads give the same bits, resets and automatic resets included. Catches physics that
/// is shared between environments, and a result that depends on who finishes first.
#[test]
fn threads_change_nothing() {
    for control in CONTROLS {
        let task = short(control);
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            let mut batches =
                [1, 2, 8].map(|threads| batch(task.clone(), N, autoreset, threads, 5));
            let mut actions = Actions::of_width(N, 4);
            let mut touched = false;
            for _ in 0..STEPS {
                let actions = actions.draw();
                for batch in &mut batches {
                    batch.step(&actions).unwrap();
                }
                touched |= (0..N).any(|i| batches[0].state(i).unwrap().palm_reach);
            }
            let [one, two, eight] = batches.each_ref().map(bits);
            assert!(one == two && one == eight, "{control} {autoreset}");
            assert!(touched, "{control} {autoreset}");
        }
    }
}

/// Environment i of a batch is the environment that runs alone with its seed and actions, at every
/// step. Catches actions dealt to the wrong environment, and buffers of one that another warms.
#[test]
fn batch_is_many_singles() {
    for control in CONTROLS {
        let task = short(control);
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            let mut together = batch(task.clone(), 4, autoreset, 2, 9);
            let mut alone: Vec<_> = (0..4)
                .map(|i| batch(task.clone(), 1, autoreset, 1, 9 + i))
                .collect();
            let mut actions = Actions::of_width(4, 4);
            for _ in 0..STEPS {
                let actions = actions.draw();
                together.step(&actions).unwrap();
                for (i, single) in alone.iter_mut().enumerate() {
                    single.step(&actions[4 * i..][..4]).unwrap();
                    assert!(single.save(0).unwrap() == together.save(i).unwrap());
                    assert_eq!(single.records().next(), together.records().nth(i));
                }
            }
        }
    }
}

/// An environment seeded anew repeats itself, whatever it played before. Catches contacts and solver
/// state that survive a reset.
#[test]
fn seed_forgets_the_past() {
    for control in CONTROLS {
        let task = short(control);
        let mut fresh = batch(task.clone(), 1, Autoreset::NextStep, 1, 3);
        let mut used = batch(task.clone(), 1, Autoreset::NextStep, 1, 1000);
        let mut actions = Actions::of_width(1, 4);
        for _ in 0..STEPS {
            used.step(&actions.draw()).unwrap();
        }
        for env in [&mut fresh, &mut used] {
            env.seed(0, 3).unwrap();
            env.request(0, before_the_palm(&task, 0.03)).unwrap();
            env.reset(&[true]).unwrap();
        }
        for _ in 0..STEPS {
            assert!(bits(&fresh) == bits(&used));
            let action = actions.draw();
            fresh.step(&action).unwrap();
            used.step(&action).unwrap();
        }
    }
}

/// What a person sees who resets by hand: the record after each reset and each step.
fn by_hand(task: &Arc<GraspTask>, episodes: usize) -> Vec<Vec<Record>> {
    let mut env = batch(task.clone(), 1, Autoreset::Disabled, 1, 21);
    let mut actions = Actions::of_width(1, 4);
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
/// next episode, without reward, its action ignored. Within the step: reward and end are those of
/// the ending step, the observation is the next episode's first, and the final one is kept aside.
/// Catches a reset that plays the action, and an end that is forgotten.
#[test]
fn automatic_resets_are_those_by_hand() {
    let task = short(Control::DeltaPosture);
    let episodes = by_hand(&task, 4);
    let mut env = batch(task.clone(), 1, Autoreset::NextStep, 1, 21);
    let mut actions = Actions::of_width(1, 4);
    for episode in &episodes {
        assert_eq!(record(&env), episode[0]);
        for expected in &episode[1..] {
            env.step(&actions.draw()).unwrap();
            assert_eq!(record(&env), *expected);
        }
        env.step(&[1.0, -1.0, 1.0, -1.0]).unwrap();
    }
    let mut env = batch(task, 1, Autoreset::SameStep, 1, 21);
    let mut actions = Actions::of_width(1, 4);
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
        let shown = Record {
            step: end.step,
            ..next[0].clone()
        };
        assert_eq!(record(&env), shown);
    }
}
