//! The trajectories of golden.rs: hashes of the state after 1, 10, 100 and 1,000 steps.

use std::collections::BTreeMap;

use babble_env::{Autoreset, Batch, Control, GraspOptions, Task};
use xxhash_rust::xxh3::xxh3_64;

use super::grasping::{CONTROLS, before_the_palm, grasp, with_control};
use super::{Actions, batch, control, seeded};

/// Hash of the state alone: a config field more moves no trajectory.
fn hash<T: Task>(env: &Batch<T>) -> String {
    let state = postcard::to_stdvec(env.state(0).unwrap()).unwrap();
    format!("{:016x}", xxh3_64(&state))
}

/// Reaching with random actions, in each control.
pub(crate) fn reaching() -> BTreeMap<String, String> {
    let mut golden = BTreeMap::new();
    for &of in Control::ALL {
        let mut env = batch(control(of), 1, Autoreset::NextStep, 1, 1);
        let mut actions = Actions::new(1);
        for step in 1..=1000 {
            env.step(&actions.draw()).unwrap();
            if [1, 10, 100, 1000].contains(&step) {
                golden.insert(format!("{of} {step:4}"), hash(&env));
            }
        }
    }
    golden
}

/// The same of grasping, the physics engine included. The object lies before the palm, the reflex
/// closes the hand and the arm trembles, so that hashes are taken in the middle of contacts.
pub(crate) fn grasping() -> BTreeMap<String, String> {
    let mut golden = BTreeMap::new();
    for of in CONTROLS {
        let options = GraspOptions {
            enclosure_reflex: true,
            ..with_control(of)
        };
        let mut env = seeded(grasp(options), 1, Autoreset::NextStep, 1, 1);
        let near = before_the_palm(env.task(), 0.05);
        env.request(0, near).unwrap();
        env.reset(&[true]).unwrap();
        // In posture control an action is a place to be, not a step.
        let [towards, tremble] = match of {
            Control::Posture => [-0.2, 0.01],
            _ => [0.05, 0.2],
        };
        let mut actions = Actions::of_width(1, 4);
        for step in 1..=1000 {
            let action = actions.draw();
            env.step(&[
                towards + tremble * action[0],
                -towards + tremble * action[1],
                action[2],
                action[3],
            ])
            .unwrap();
            if [1, 10, 100, 1000].contains(&step) {
                golden.insert(format!("{of} {step:4}"), hash(&env));
            }
        }
    }
    golden
}
