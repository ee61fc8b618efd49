//! Laws of a session: the same commands give the same bits, slices merge, undo goes back, faults change
//! nothing.

mod common;

use babble_lab::{AgentSetup, Answer, Command, Happened, MapName, Policies, ToJson, replay};
use common::{GRASP, REACH, babble, lab, recall, setup, step, test};
use serde_json::json;

#[test]
fn slices_of_babbling_are_one_babbling() {
    for (env, variant, n) in [
        (REACH, "paper", 30),
        (GRASP, "paper", 6),
        (GRASP, "chain", 3),
    ] {
        let mut whole = lab(setup(env, &[variant]));
        whole.apply(&babble(n)).unwrap();
        let mut slices = lab(setup(env, &[variant]));
        for some in [1, n / 3, n - 1 - n / 3] {
            slices.apply(&babble(some)).unwrap();
        }
        assert_eq!(slices.hash(), whole.hash(), "{env} {variant}");
        let record = |lab: &babble_lab::Lab| lab.record(None, "").unwrap();
        assert_eq!(record(&slices), record(&whole));
        assert_eq!(slices.history(), whole.history());
    }
}

#[test]
fn undo_takes_back_the_bits_and_the_record() {
    let mut lab = lab(setup(REACH, &["paper", "conjunctive"]));
    let lesion = Command::Lesion {
        agent: 0,
        map: MapName::Input,
        association: 0,
        neurons: vec![220, 221],
    };
    let mut states = vec![lab.state().unwrap()];
    let changed = {
        let mut changed = setup(REACH, &["paper", "conjunctive"]);
        changed.config = common::object(&json!({"body": {"obstacle": {"radius_m": 0.02}}}));
        Command::Change { setup: changed }
    };
    let commands = [
        babble(20),
        recall(),
        step(10),
        lesion,
        test(5),
        changed,
        babble(3),
    ];
    for command in &commands {
        lab.apply(command).unwrap();
        states.push(lab.state().unwrap());
    }
    for before in states.iter().rev().skip(1) {
        lab.undo().unwrap();
        assert_eq!(lab.state().unwrap(), *before);
    }
    assert_eq!(lab.undo().unwrap_err().problem, "there is nothing to undo");
    assert!(lab.history().is_empty());
}

/// Catches slices that are undone one by one, and a run that takes the one before with it, though the record
/// has one command for both.
#[test]
fn undo_takes_back_a_run_and_no_more() {
    let mut lab = lab(setup(REACH, &["paper"]));
    let mut states = vec![lab.state().unwrap()];
    for run in [
        &[babble(3), babble(2), babble(4)][..],
        &[babble(1)],
        &[babble(5), test(4), babble(2)],
    ] {
        lab.apply(&run[0]).unwrap();
        for command in &run[1..] {
            lab.go_on(command).unwrap();
        }
        states.push(lab.state().unwrap());
    }
    assert_eq!((states[2].commands, states[2].undoable), (1, 2));
    let record = lab.record(None, "").unwrap();
    assert_eq!(record.commands, [babble(15), test(4), babble(2)]);
    assert!(lab.go_on(&step(1)).is_err());
    assert_eq!(lab.state().unwrap(), states[3]);
    for before in states.iter().rev().skip(1) {
        lab.undo().unwrap();
        assert_eq!(lab.state().unwrap(), *before);
        let record = lab.record(None, "").unwrap();
        let again = replay(&record, Policies::default(), common::executor()).unwrap();
        assert_eq!(again.hash().unwrap(), record.hash);
    }
    assert!(lab.undo().is_err());
}

#[test]
fn a_record_run_again_gives_its_hash() {
    for (env, variants) in [
        (REACH, &["paper", "conjunctive"][..]),
        (GRASP, &["paper", "chain"]),
    ] {
        let mut lab = lab(setup(env, variants));
        for command in [babble(4), recall(), step(7), step(1_000), test(2), recall()] {
            lab.apply(&command).unwrap();
        }
        let answer = Command::Answer {
            question: "lag".to_owned(),
            value: Answer::Number(0.8),
        };
        lab.apply(&answer).unwrap();
        let text = lab
            .record(Some("equilibrium"), "Ada")
            .unwrap()
            .to_json()
            .unwrap();
        let record = babble_lab::Record::from_json(&text).unwrap();
        let again = replay(&record, Policies::default(), common::executor()).unwrap();
        assert_eq!(again.hash().unwrap(), record.hash, "{env}");
        assert_eq!(again.history(), lab.history());
        let mut forged = record.clone();
        forged.commands[0] = babble(5);
        assert_ne!(
            replay(&forged, Policies::default(), common::executor())
                .unwrap()
                .hash()
                .unwrap(),
            record.hash
        );
    }
}

#[test]
fn agents_side_by_side_play_the_same_case_and_do_not_mix() {
    let mut both = lab(setup(GRASP, &["paper", "chain"]));
    let mut alone = lab(setup(GRASP, &["chain"]));
    for command in [babble(3), recall(), step(300), recall(), step(5)] {
        both.apply(&command).unwrap();
        alone.apply(&command).unwrap();
    }
    let (both, alone) = (both.state().unwrap(), alone.state().unwrap());
    assert_eq!(both.agents[1], alone.agents[0]);
    let (both, alone) = (both.episode.unwrap(), alone.episode.unwrap());
    assert_eq!(both.case, alone.case);
    assert_eq!(both.outcome[1], alone.outcome[0]);
    assert_eq!(both.reward[1].to_bits(), alone.reward[0].to_bits());
}

#[test]
fn a_silenced_neuron_has_no_weights_even_after_more_babbles() {
    let lesion = Command::Lesion {
        agent: 0,
        map: MapName::Output,
        association: 0,
        neurons: vec![40, 220],
    };
    let (mut cut, mut whole) = (lab(setup(REACH, &["paper"])), lab(setup(REACH, &["paper"])));
    cut.apply(&babble(20)).unwrap();
    cut.apply(&lesion).unwrap();
    cut.apply(&babble(20)).unwrap();
    whole.apply(&babble(40)).unwrap();
    let weights = |lab: &babble_lab::Lab, neuron| {
        lab.weights(0, 0, MapName::Output, neuron).unwrap().activity
    };
    for neuron in 0..441 {
        if [40, 220].contains(&neuron) {
            assert!(weights(&cut, neuron).iter().all(|&w| w == 0.0));
        } else {
            assert_eq!(weights(&cut, neuron), weights(&whole, neuron));
        }
    }
    assert!(weights(&whole, 220).iter().any(|&w| w != 0.0));
    assert_eq!(cut.state().unwrap().agents[0].silenced, 2);
    assert_eq!(
        cut.brain(0).unwrap().unwrap().associations[0].silenced_outputs,
        [40, 220]
    );
}

#[test]
fn a_changed_body_keeps_what_was_learnt_and_a_changed_brain_does_not() {
    let mut lab = lab(setup(REACH, &["paper", "paper"]));
    lab.apply(&babble(10)).unwrap();
    let mut changed = setup(REACH, &["paper", "paper"]);
    changed.config = common::object(&json!({"body": {"muscles": {"kp": 100.0}}}));
    changed.agents[1] = common::hebb("paper", &json!({"sigma": 1.0}));
    lab.apply(&Command::Change {
        setup: changed.clone(),
    })
    .unwrap();
    let learnt: Vec<u64> = lab
        .state()
        .unwrap()
        .agents
        .iter()
        .map(|a| a.learnt)
        .collect();
    assert_eq!(learnt, [10, 0]);
    changed.seed = 1;
    lab.apply(&Command::Change { setup: changed }).unwrap();
    assert_eq!(lab.state().unwrap().agents[0].learnt, 0);
    assert!(matches!(
        lab.history().last().unwrap().what,
        Happened::Changed
    ));
}

#[test]
fn a_fault_names_the_field_and_changes_nothing() {
    let mut lab = lab(setup(REACH, &["paper"]));
    lab.apply(&babble(3)).unwrap();
    let before = lab.state().unwrap();
    let mut wrong = setup(REACH, &["paper"]);
    wrong.config = common::object(&json!({"body": {"muscles": {"kp": -1.0}}}));
    let far = common::case(&json!({"target": [3.0, 3.0]}));
    let commands = [
        (Command::Change { setup: wrong }, "body.muscles.kp"),
        (Command::Recall { case: Some(far) }, "target"),
        (babble(0), "n"),
        (babble(100_001), "n"),
        (
            Command::Lesion {
                agent: 0,
                map: MapName::Input,
                association: 0,
                neurons: vec![441],
            },
            "neurons",
        ),
    ];
    for (command, field) in commands {
        let fault = lab.apply(&command).unwrap_err();
        assert_eq!(fault.field.as_deref(), Some(field), "{}", fault.problem);
        assert_eq!(lab.state().unwrap(), before);
    }
    let fault = lab.apply(&step(1)).unwrap_err();
    assert_eq!(fault.kind, "ResetNeeded");
}

#[test]
fn an_agent_from_a_file_goes_on_with_the_same_bits() {
    let mut changed = setup(REACH, &["conjunctive"]);
    changed.config = common::object(&json!({"body": {"muscles": {"kp": 100.0}}}));
    changed.seed = 7;
    let mut first = lab(changed);
    first.apply(&babble(10)).unwrap();
    let file = first.save_agent(0).unwrap();
    let mut other = lab(setup(REACH, &["paper"]));
    other.load_agent(0, &file).unwrap();
    assert_eq!(other.state().unwrap().setup, first.state().unwrap().setup);
    for lab in [&mut first, &mut other] {
        lab.apply(&babble(10)).unwrap();
    }
    assert_eq!(other.save_agent(0).unwrap(), first.save_agent(0).unwrap());
    let record = other.record(None, "").unwrap();
    assert_eq!(
        replay(&record, Policies::default(), common::executor())
            .unwrap_err()
            .field
            .as_deref(),
        Some("loaded")
    );
}

#[test]
fn a_rule_of_ones_own_learns_in_slices_as_at_once() {
    let own = |n: &[u64]| {
        let mut setup = setup(REACH, &["paper"]);
        let rule = "eta * (a - a_mean) * (g - g_mean) * (w_max - abs(w))".to_owned();
        setup.agents[0] = AgentSetup::Hebb {
            variant: "paper".to_owned(),
            brain: common::object(&json!({"rule": {"eta": 0.5}})),
            rule: Some(rule),
        };
        let mut lab = lab(setup);
        for &n in n {
            lab.apply(&babble(n)).unwrap();
        }
        lab
    };
    assert_eq!(own(&[1, 150, 49]).hash(), own(&[200]).hash());
    assert_ne!(own(&[200]).hash(), own(&[199]).hash());
}

#[test]
fn a_rule_that_makes_no_sense_is_named_with_its_place() {
    let mut wrong = setup(REACH, &["paper"]);
    wrong.agents[0] = AgentSetup::Hebb {
        variant: "paper".to_owned(),
        brain: serde_json::Map::new(),
        rule: Some("eta * gmean".to_owned()),
    };
    let fault = babble_lab::Lab::open(wrong, Policies::default(), common::executor()).unwrap_err();
    assert_eq!(fault.field.as_deref(), Some("agents[0].rule"));
    assert!(fault.problem.contains("g_mean"), "{}", fault.problem);
}

#[test]
fn a_policy_acts_beside_a_learner_and_its_file_is_named_in_the_record() {
    for (env, name) in [(REACH, "reach"), (GRASP, "grasp")] {
        let mut beside = setup(env, &["paper"]);
        beside.agents.push(AgentSetup::Policy {
            name: name.to_owned(),
        });
        let mut lab = lab(beside);
        for command in [babble(2), test(10), recall(), step(1_000)] {
            lab.apply(&command).unwrap();
        }
        let state = lab.state().unwrap();
        assert!(state.curve[0].successes[1] >= 8, "{env}: {:?}", state.curve);
        let record = lab.record(None, "").unwrap();
        let again = replay(&record, common::policies(), common::executor()).unwrap();
        assert_eq!(again.hash().unwrap(), record.hash);
        let fault = replay(&record, Policies::default(), common::executor()).unwrap_err();
        assert_eq!(fault.field.as_deref(), Some("policies"));
    }
}

#[test]
fn a_policy_of_another_task_or_control_is_refused() {
    let with = |env: &str, name: &str| {
        let mut setup = setup(env, &["paper"]);
        setup.agents[0] = AgentSetup::Policy {
            name: name.to_owned(),
        };
        setup
    };
    let mut other = with(REACH, "reach");
    other.options = common::object(&json!({"control": "posture"}));
    for (setup, field) in [
        (with(REACH, "grasp"), "name"),
        (with(REACH, "nobody"), "name"),
        (other, "options.control"),
    ] {
        let fault = babble_lab::Lab::open(setup, common::policies(), common::executor());
        assert_eq!(fault.unwrap_err().field.as_deref(), Some(field));
    }
}
