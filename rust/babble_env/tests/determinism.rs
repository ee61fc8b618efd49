//! The same bits for any number of threads, and for a batch and single environments.

mod playing;

use babble_env::{Autoreset, Control, ReachOptions};
use playing::{Actions, batch, bits, control};

const N: usize = 24;

/// Short episodes, so that many begin anew.
fn short(of: Control) -> ReachOptions {
    ReachOptions {
        max_episode_steps: 40,
        ..control(of)
    }
}

fn steps(of: Control) -> usize {
    if of == Control::Pattern { 12 } else { 150 }
}

/// 1, 2 and 8 threads give the same bits, resets and automatic resets included. Catches a stream
/// shared between environments, and a result that depends on who finishes first.
#[test]
fn threads_change_nothing() {
    for &of in Control::ALL {
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            let mut batches = [1, 2, 8].map(|threads| batch(short(of), N, autoreset, threads, 5));
            let mut actions = Actions::new(N);
            for _ in 0..steps(of) {
                let actions = actions.draw();
                for batch in &mut batches {
                    batch.step(&actions).unwrap();
                }
            }
            let [one, two, eight] = batches.each_ref().map(bits);
            assert!(one == two && one == eight, "{of} {autoreset}");
        }
    }
}

/// Environment i of a batch is the environment that runs alone with its seed and actions, at every
/// step. Catches actions dealt to the wrong environment and state that is shared between them.
#[test]
fn batch_is_many_singles() {
    for &of in Control::ALL {
        for &autoreset in &[Autoreset::NextStep, Autoreset::SameStep] {
            let mut together = batch(short(of), N, autoreset, 2, 9);
            let mut alone: Vec<_> = (0..N as u64)
                .map(|i| batch(short(of), 1, autoreset, 1, 9 + i))
                .collect();
            let mut actions = Actions::new(N);
            for _ in 0..steps(of) {
                let actions = actions.draw();
                together.step(&actions).unwrap();
                for (i, single) in alone.iter_mut().enumerate() {
                    single.step(&actions[2 * i..][..2]).unwrap();
                    assert_eq!(single.save(0).unwrap(), together.save(i).unwrap());
                    assert_eq!(single.records().next(), together.records().nth(i));
                }
            }
        }
    }
}

/// An environment seeded anew repeats itself, whatever it played before. Catches state that
/// survives a reset.
#[test]
fn seed_forgets_the_past() {
    for &of in Control::ALL {
        let mut fresh = batch(short(of), 1, Autoreset::NextStep, 1, 3);
        let mut used = batch(short(of), 1, Autoreset::NextStep, 1, 1000);
        let mut actions = Actions::new(1);
        for _ in 0..steps(of) {
            used.step(&actions.draw()).unwrap();
        }
        used.seed(0, 3).unwrap();
        used.reset(&[true]).unwrap();
        for _ in 0..steps(of) {
            assert_eq!(bits(&fresh), bits(&used));
            let action = actions.draw();
            fresh.step(&action).unwrap();
            used.step(&action).unwrap();
        }
    }
}
