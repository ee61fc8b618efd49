//! Trajectories to the bit, on every platform.
//!
//! The snapshot holds a hash of the environment's state after 1, 10, 100 and 1,000 steps. It moves
//! with every change of physics, geometry, eye, random streams or automatic resets. Such a change
//! needs a reason, given in its commit and in the changelog, as users' numbers move with it; one
//! that was not meant to move anything is a mistake.

mod playing;

use babble_env::Config;
use playing::golden;

#[test]
fn trajectories_are_golden() {
    insta::with_settings!({
        description => "A change here needs a reason in the changelog: see the head of golden.rs.",
        omit_expression => true,
    }, { insta::assert_json_snapshot!(golden::reaching()) });
}

#[test]
fn grasps_are_golden() {
    insta::with_settings!({
        description => "A change here needs a reason in the changelog: see the head of golden.rs.",
        omit_expression => true,
    }, { insta::assert_json_snapshot!(golden::grasping()) });
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
