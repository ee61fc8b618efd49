//! A user of Rust alone makes an environment by its id, and plays agents in it.

#[path = "../examples/play.rs"]
mod play;

use babble_agent::{Random, reference};
use babble_env::{Config, Executor, Options, make};

/// Catches an agent that cannot act in what the registry makes, or acts without looking: the script
/// solves every case here, and random actions do not.
#[test]
fn the_script_solves_what_random_actions_do_not() {
    let executor = &mut Executor::new(2).unwrap();
    for id in ["BabbleReachPattern-v0", "BabbleGrasp-v0"] {
        let task = make(id, Config::profile("paper").unwrap(), &Options::default()).unwrap();
        let mut succeed = |name| {
            let random = Random::new(0, 0);
            let policy = reference(name, &task, &random).unwrap();
            play::play(&task, &*policy, executor).unwrap()
        };
        assert!(succeed("scripted") > play::EPISODES * 9 / 10, "{id}");
        assert!(succeed("random") < play::EPISODES / 2, "{id}");
    }
}

/// Catches a Hebb agent or an oracle that cannot be made or played without Python.
#[test]
fn the_example_plays_every_agent() {
    play::main().unwrap();
}
