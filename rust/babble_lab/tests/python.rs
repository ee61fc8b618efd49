//! "Open in Python": the lines name all that the setup does, and a rule becomes a function of arrays.

mod common;

use babble_lab::AgentSetup;
use common::{GRASP, REACH, babble, lab, object, setup};
use serde_json::json;

#[test]
fn the_lines_make_the_same_agent() {
    let mut other = setup(REACH, &["paper"]);
    other.profile = "icub".to_owned();
    other.config = object(&json!({"body": {"eye": {"frame": "helmholtz"}}}));
    other.options = object(&json!({"settled": true}));
    other.seed = 3;
    other.agents[0] = AgentSetup::Hebb {
        variant: "conjunctive".to_owned(),
        brain: object(&json!({"sigma": 1.0, "rule": {"eta": 0.5}})),
        rule: Some("eta*(a-ā)*max(g,0)*(w_max^2-w^2)".to_owned()),
    };
    let mut lab = lab(other);
    lab.apply(&babble(5)).unwrap();
    assert_eq!(lab.python(0).unwrap(), include_str!("golden/opened.txt"));
}

#[test]
fn agents_that_do_not_learn_have_lines_too() {
    for (agent, line) in [
        (AgentSetup::Random {}, "gym_babble.Random(env, seed=0)"),
        (AgentSetup::Oracle {}, "gym_babble.Oracle(env)"),
        (AgentSetup::Scripted {}, "gym_babble.Scripted(env)"),
        (
            AgentSetup::Policy {
                name: "grasp".to_owned(),
            },
            "gym_babble.load_agent(\"grasp.safetensors\", env)",
        ),
    ] {
        let mut setup = setup(GRASP, &["paper"]);
        setup.agents[0] = agent;
        let lines = lab(setup).python(0).unwrap();
        assert!(lines.contains(line), "{lines}");
    }
}
