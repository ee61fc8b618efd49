//! How long babbling takes in slices, as the page asks for it: `cargo run --release --example speed`.

use std::time::Instant;

use babble_env::Executor;
use babble_lab::{AgentSetup, Command, Fault, Lab, Policies, Setup, default_setup};

fn main() -> Result<(), Fault> {
    for (env, variant, n, slice) in [
        ("BabbleReach-v0", "paper", 20_000, 200),
        ("BabbleReach-v0", "conjunctive", 20_000, 200),
        ("BabbleGrasp-v0", "paper", 1_000, 10),
        ("BabbleGrasp-v0", "chain", 1_000, 4),
    ] {
        let setup = Setup {
            agents: vec![AgentSetup::hebb(variant)],
            ..default_setup(env)?
        };
        let mut lab = Lab::open(setup, Policies::default(), Executor::new(1)?)?;
        let started = Instant::now();
        for _ in 0..n / slice {
            lab.apply(&Command::Babble { n: slice })?;
        }
        let seconds = started.elapsed().as_secs_f64();
        println!("{env} {variant}: {n} babbles in {seconds:.2} s");
    }
    Ok(())
}
