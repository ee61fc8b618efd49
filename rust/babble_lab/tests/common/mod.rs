//! Sessions and commands for the tests.
#![allow(dead_code, reason = "each test file uses some of it")]

use babble_env::Executor;
use babble_lab::{AgentSetup, Case, Command, Lab, Policies, Setup, default_setup};
use serde_json::{Map, Value};

pub(crate) const REACH: &str = "BabbleReach-v0";
pub(crate) const GRASP: &str = "BabbleGrasp-v0";

pub(crate) fn executor() -> Executor {
    Executor::new(1).unwrap()
}

/// The policies that come with the package.
pub(crate) fn policies() -> Policies {
    let mut all = Policies::default();
    let files = [
        (
            "reach",
            include_bytes!("../../../../gym_babble/lab/policies/reach.safetensors").as_slice(),
        ),
        (
            "grasp",
            include_bytes!("../../../../gym_babble/lab/policies/grasp.safetensors"),
        ),
    ];
    for (name, bytes) in files {
        all.add(name, bytes).unwrap();
    }
    all
}

pub(crate) fn lab(setup: Setup) -> Lab {
    Lab::open(setup, policies(), executor()).unwrap()
}

/// The default setup with learners of these variants.
pub(crate) fn setup(env: &str, variants: &[&str]) -> Setup {
    Setup {
        agents: variants.iter().map(|name| AgentSetup::hebb(name)).collect(),
        ..default_setup(env).unwrap()
    }
}

pub(crate) fn hebb(variant: &str, brain: &Value) -> AgentSetup {
    AgentSetup::Hebb {
        variant: variant.to_owned(),
        brain: object(brain),
        rule: None,
    }
}

pub(crate) fn object(value: &Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

pub(crate) fn case(value: &Value) -> Case {
    serde_json::from_value(value.clone()).unwrap()
}

pub(crate) fn babble(n: u64) -> Command {
    Command::Babble { n }
}

pub(crate) fn step(n: u64) -> Command {
    Command::Step { n }
}

pub(crate) fn test(n: u64) -> Command {
    Command::Test { n }
}

pub(crate) fn recall() -> Command {
    Command::Recall { case: None }
}
