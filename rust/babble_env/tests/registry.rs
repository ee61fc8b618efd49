//! The registry: every id makes environments that step, options are checked, and a batch behind the
//! object-safe trait is the typed batch to the bit.

#[path = "../examples/make.rs"]
#[expect(dead_code, reason = "its main reads the command line")]
mod make;

use std::sync::Arc;

use babble_env::case::CasePart;
use babble_env::progress::SUCCESS_FACTS;
use babble_env::registry::{TASKS, environment, presets, task};
use babble_env::{
    AnyTask, Autoreset, Batch, CaseValue, CaseValues, Config, EnvError, Executor, GraspTask,
    Options, Purpose, ReachOptions, ReachTask, downcast, make,
};
use serde_json::json;

/// Catches an example that plays beyond the end of an episode, or not the same one from its seed.
#[test]
fn the_example_plays_an_episode_of_every_id() {
    for entry in TASKS {
        for row in entry.environments {
            let (outcome, steps, total) = make::play(row.id, &Options::new()).unwrap();
            assert_ne!(outcome, "running", "{}", row.id);
            assert!((1..=row.max_episode_steps).contains(&steps), "{}", row.id);
            assert_eq!(
                make::play(row.id, &Options::new()).unwrap(),
                (outcome, steps, total)
            );
        }
    }
}

fn paper() -> Config {
    Config::profile("paper").unwrap()
}

fn options(value: &serde_json::Value) -> Options {
    value.as_object().unwrap().clone()
}

fn refusal(id: &str, given: &serde_json::Value) -> String {
    make(id, paper(), &options(given)).unwrap_err().to_string()
}

#[test]
fn every_id_makes_environments_that_step() {
    for entry in TASKS {
        for row in entry.environments {
            let task = make(row.id, paper(), &Options::new()).unwrap();
            let spec = task.spec();
            let mut envs = task
                .batch(2, Autoreset::NextStep, Executor::new(2).unwrap())
                .unwrap();
            envs.reset(&[true, true]).unwrap();
            envs.step(&vec![0.25; 2 * spec.action.labels.len()])
                .unwrap();
            let record = envs.record(1).unwrap();
            let senses: usize = spec.senses.iter().map(|sense| sense.labels.len()).sum();
            assert_eq!(record.senses.len(), senses, "{}", row.id);
            // Gymnasium flattens a Dict in this order.
            assert!(spec.senses.is_sorted_by_key(|sense| sense.name));
            assert!(spec.outcomes.contains(&record.info.outcome.name()));
            assert!(spec.facts.starts_with(&SUCCESS_FACTS), "{}", row.id);
            let goals = [record.achieved.len(), record.desired.len()];
            assert_eq!(goals, [spec.goal_len(); 2], "{}", row.id);
            assert!(record.achieved.iter().all(|x| x.is_finite()));
            assert_eq!(row.max_episode_steps, spec.max_episode_steps, "{}", row.id);
        }
    }
}

/// One id, one time limit: catches an id whose option changes the limit behind Gymnasium's back.
#[test]
fn options_that_decide_the_time_limit_are_the_ids() {
    let refused = refusal("BabbleGrasp-v0", &json!({"region": "full"}));
    assert!(refused.contains("use BabbleGraspFull-v0"), "{refused}");
    let refused = refusal("BabbleReachPattern-v0", &json!({"control": "posture"}));
    assert!(refused.contains("use BabbleReach-v0"), "{refused}");
    for entry in TASKS {
        for row in entry.environments {
            let own = make(row.id, paper(), &Options::new()).unwrap().spec();
            for spec in entry.options {
                let spec = serde_json::to_value(spec).unwrap();
                let name = spec["name"].as_str().unwrap();
                for value in spec["values"].as_array().into_iter().flatten() {
                    let given = options(&json!({ name: value, "reward": "sparse" }));
                    let Ok(task) = make(row.id, paper(), &given) else {
                        continue;
                    };
                    // A whole movement ends by itself.
                    let limit = task.spec().max_episode_steps;
                    assert!(
                        limit == own.max_episode_steps || value == "pattern",
                        "{}",
                        row.id
                    );
                }
            }
        }
    }
}

#[test]
fn every_value_of_every_choice_makes_a_task_or_names_itself() {
    for entry in TASKS {
        for spec in entry.options {
            let spec = serde_json::to_value(spec).unwrap();
            let name = spec["name"].as_str().unwrap();
            for value in spec["values"].as_array().into_iter().flatten() {
                let mut given = options(&json!({ name: value }));
                if value == "goal" {
                    given.extend(presets(&[("reward", "sparse")]));
                }
                entry.make(paper(), &given).unwrap();
            }
        }
    }
}

#[test]
fn options_are_checked_by_name_kind_and_bound() {
    let id = "BabbleReach-v0";
    for (given, named) in [
        (json!({"contol": "torque"}), "did you mean \"control\"?"),
        (json!({"region": "full"}), "unknown option \"region\""),
        (
            json!({"control": "telepathy"}),
            "delta_posture, posture, torque, pattern",
        ),
        (json!({"control": 3}), "control = 3 is not one of"),
        (
            json!({"settled": "no"}),
            "settled = \"no\" is not True or False",
        ),
        (
            json!({"max_episode_steps": 0}),
            "whole number in [1, 1000000] control steps",
        ),
        (json!({"max_episode_steps": 2.5}), "max_episode_steps = 2.5"),
        (
            json!({"max_episode_steps": null}),
            "max_episode_steps = null",
        ),
        (json!({"obs": "goal"}), "sparse when obs"),
    ] {
        let said = refusal(id, &given);
        assert!(said.contains(named), "{given}: {said}");
    }
    for (given, named) in [
        (
            json!({"control": "pattern"}),
            "delta_posture, posture, torque",
        ),
        (
            json!({"diameters": []}),
            "diameters = [] is not a list of 1 to 1000 numbers in [0.005, 0.2] m",
        ),
        (json!({"diameters": [0.03, 0.3]}), "diameters = [0.03,0.3]"),
    ] {
        let said = refusal("BabbleGrasp-v0", &given);
        assert!(said.contains(named), "{given}: {said}");
    }
}

#[test]
fn unknown_names_are_answered_with_the_nearest_ones() {
    let said = environment("BabbleReach-v1").unwrap_err().to_string();
    assert!(said.contains("did you mean \"BabbleReach-v0\"?"), "{said}");
    let said = task("walk").unwrap_err().to_string();
    assert!(said.contains("there are reach, grasp"), "{said}");
    let reaching = make("BabbleReach-v0", paper(), &Options::new()).unwrap();
    let mut executor = Executor::new(1).unwrap();
    let said = reaching.cases("table3", 1, 0, Purpose::Test, &mut executor);
    assert!(
        said.unwrap_err()
            .to_string()
            .contains("did you mean \"table1\"?")
    );
}

#[test]
fn a_batch_behind_the_trait_is_the_typed_batch_to_the_bit() {
    let erased = make("BabbleReach-v0", paper(), &Options::new()).unwrap();
    let typed = Arc::new(ReachTask::new(paper(), ReachOptions::default()).unwrap());
    let executor = || Executor::new(2).unwrap();
    let mut any = erased.batch(3, Autoreset::SameStep, executor()).unwrap();
    let mut batch = Batch::with_executor(typed, 3, Autoreset::SameStep, executor()).unwrap();
    for i in 0..3 {
        any.seed(i, 11 + i as u64).unwrap();
        batch.seed(i, 11 + i as u64).unwrap();
    }
    any.reset(&[true; 3]).unwrap();
    batch.reset(&[true; 3]).unwrap();
    for k in 0..300 {
        let actions: Vec<f32> = (0..6)
            .map(|i| ((k * 7 + i * 3) % 11) as f32 / 5.0 - 1.0)
            .collect();
        any.step(&actions).unwrap();
        batch.step(&actions).unwrap();
    }
    for (i, record) in batch.records().enumerate() {
        assert_eq!(any.record(i).unwrap(), record);
        assert_eq!(any.save(i).unwrap(), batch.save(i).unwrap());
    }
}

#[test]
fn a_task_is_given_back_as_its_own_type_alone() {
    let erased: Arc<dyn AnyTask> = make("BabbleGrasp-v0", paper(), &Options::new()).unwrap();
    assert!(downcast::<GraspTask>(&erased).is_some());
    assert!(downcast::<ReachTask>(&erased).is_none());
}

#[test]
fn a_case_shown_is_a_case_that_can_be_asked_for() {
    for id in ["BabbleReach-v0", "BabbleGrasp-v0"] {
        let task = make(id, paper(), &Options::new()).unwrap();
        let parts: &'static [CasePart] = task.case_parts();
        let mut envs = task
            .batch(2, Autoreset::Disabled, Executor::new(1).unwrap())
            .unwrap();
        envs.seed(0, 3).unwrap();
        envs.reset(&[true, false]).unwrap();
        let shown = envs.case(0).unwrap();
        let given = shown.iter().map(|(name, value)| (name, value.clone()));
        envs.request(1, &CaseValues::read(parts, given).unwrap())
            .unwrap();
        envs.reset(&[false, true]).unwrap();
        assert_eq!(envs.case(1).unwrap(), shown, "{id}");
    }
}

#[test]
fn parts_of_a_case_are_checked_by_name_and_count() {
    let parts = task("grasp").unwrap().case_parts;
    let refused = |name, value| CaseValues::read(parts, [(name, value)]).unwrap_err();
    let pair = CaseValue::Numbers(vec![0.1, 0.2]);
    assert!(matches!(
        refused("objekt", pair.clone()),
        EnvError::UnknownName { .. }
    ));
    let said = refused("diameter", pair).to_string();
    assert!(said.contains("expected a number [m]"), "{said}");
    let said = refused("obstacle", CaseValue::Numbers(vec![1.0; 4])).to_string();
    assert!(
        said.contains("expected 2 numbers or 3 numbers [m]"),
        "{said}"
    );
}
