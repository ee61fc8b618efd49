//! Trajectories to the bit, on every platform.
//!
//! The snapshot holds a hash of the environment's state after 1, 10, 100 and 1,000 steps. It moves
//! with every change of physics, geometry, eye, random streams or automatic resets. Such a change
//! needs a reason, given in its commit and in the changelog, as users' numbers move with it; one
//! that was not meant to move anything is a mistake.

mod playing;

use std::collections::BTreeMap;

use babble_env::{Autoreset, Batch, Config, Control, GraspOptions, Task};
use playing::grasping::{CONTROLS, before_the_palm, grasp, with_control};
use playing::{Actions, batch, control, seeded};
use xxhash_rust::xxh3::xxh3_64;

/// Hash of the state alone: a config field more moves no trajectory.
fn hash<T: Task>(env: &Batch<T>) -> String {
    let state = postcard::to_stdvec(env.state(0).unwrap()).unwrap();
    format!("{:016x}", xxh3_64(&state))
}

#[test]
fn trajectories_are_golden() {
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
    insta::with_settings!({
        description => "A change here needs a reason in the changelog: see the head of golden.rs.",
        omit_expression => true,
    }, { insta::assert_json_snapshot!(golden) });
}

/// The same of grasping, the physics engine included. The object lies before the palm, the reflex
/// closes the hand and the arm trembles, so that hashes are taken in the middle of contacts.
#[test]
fn grasps_are_golden() {
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
        let mut contacts = 0;
        for step in 1..=1000 {
            let action = actions.draw();
            env.step(&[
                towards + tremble * action[0],
                -towards + tremble * action[1],
                action[2],
                action[3],
            ])
            .unwrap();
            contacts += u32::from(env.state(0).unwrap().touch != [0.0; 3]);
            if [1, 10, 100, 1000].contains(&step) {
                golden.insert(format!("{of} {step:4}"), hash(&env));
            }
        }
        println!("{of}: contact in {contacts} of 1000 steps");
    }
    insta::with_settings!({
        description => "A change here needs a reason in the changelog: see the head of golden.rs.",
        omit_expression => true,
    }, { insta::assert_json_snapshot!(golden) });
}

/// The defaults of both bodies, field by field: they are part of an environment's version.
#[test]
fn default_configs_are_golden() {
    for name in babble_env::config::PROFILES {
        insta::with_settings!({
            description => "A change here is a new version of the environments.",
            omit_expression => true,
        }, { insta::assert_json_snapshot!(name, Config::profile(name).unwrap()) });
    }
}
