//! Setups, commands and records from anybody: no text makes the lab panic or work for hours, and what is
//! refused is named.

mod common;

use babble_lab::{Command, Lab, Policies, Record, Setup, ToJson, default_setup, registry, replay};
use common::{GRASP, REACH, babble, executor, lab, object, policies, recall, setup, step};
use proptest::prelude::*;
use serde_json::{Map, Value, json};

/// A JSON of some depth whose names are partly those of a setup.
fn value() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(|x| json!(x)),
        any::<u64>().prop_map(Value::from),
        "[a-z_]{0,9}".prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 12, 4, |inner| {
        let name = prop_oneof![
            Just("body".to_owned()),
            Just("eye".to_owned()),
            Just("muscles".to_owned()),
            Just("rule".to_owned()),
            Just("sigma".to_owned()),
            "[a-z_]{1,9}",
        ];
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::vec((name, inner), 0..4)
                .prop_map(|all| Value::Object(all.into_iter().collect())),
        ]
    })
}

fn fields() -> impl Strategy<Value = Map<String, Value>> {
    value().prop_map(|value| value.as_object().cloned().unwrap_or_default())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn any_text_is_a_command_or_a_fault(text in ".{0,200}") {
        let _ = Command::from_json(&text);
        let _ = Setup::from_json(&text);
        let _ = Record::from_json(&text);
    }

    #[test]
    fn any_setup_opens_or_is_refused_with_a_sentence(
        config in fields(), options in fields(), brain in fields(), seed in any::<u64>(),
    ) {
        let mut setup = setup(REACH, &["paper"]);
        setup.config = config;
        setup.options = options;
        setup.seed = seed;
        setup.agents[0] = common::hebb("conjunctive", &Value::Object(brain));
        if let Err(fault) = Lab::open(setup, Policies::default(), executor()) {
            prop_assert!(!fault.problem.is_empty());
        }
    }

    #[test]
    fn a_setup_is_the_same_after_json(config in fields(), brain in fields(), seed in 0..=1_u64 << 53) {
        let mut setup = setup(GRASP, &["chain"]);
        setup.config = config;
        setup.seed = seed;
        setup.agents.push(common::hebb("paper", &Value::Object(brain)));
        let text = serde_json::to_string(&setup).unwrap();
        prop_assert_eq!(Setup::from_json(&text).unwrap(), setup);
    }
}

/// A record of these commands, whatever comes out.
fn record(setup: &Setup, commands: Vec<Command>) -> Record {
    Record {
        commands,
        ..lab(setup.clone()).record(None, "nobody").unwrap()
    }
}

#[test]
fn a_record_that_would_work_for_hours_is_refused() {
    // Maps of 10,000 neurons; 100,000 babbles again and again; the slowest movements.
    let brain = json!({"output_neurons": 101, "obstacle_neurons": 101});
    let mut large = setup(REACH, &["paper"]);
    large.agents[0] = common::hebb("paper", &brain);
    let fault = Lab::open(large, Policies::default(), executor()).unwrap_err();
    assert_eq!(fault.field.as_deref(), Some("brain"), "{}", fault.problem);
    let long = record(&setup(REACH, &["paper"]), vec![step(1_000_001)]);
    let fault = replay(&long, policies(), executor()).unwrap_err();
    assert!(fault.problem.contains("1000000"), "{}", fault.problem);
    let mut slow = setup(GRASP, &["paper"]);
    slow.config = object(&json!({"grasp": {"physics_steps": 250}}));
    let mut slow = lab(slow);
    let fault = slow.apply(&babble(100_000)).unwrap_err();
    assert!(fault.problem.contains("1800 s"), "{}", fault.problem);
    assert!(slow.apply(&Command::Test { n: 10_000 }).is_err());
    let deep = format!("{}1{}", "[".repeat(10_000), "]".repeat(10_000));
    assert!(Record::from_json(&deep).is_err());
    let long_text = " ".repeat(5 << 20);
    assert!(
        Record::from_json(&long_text)
            .unwrap_err()
            .problem
            .contains("bytes")
    );
}

#[test]
fn an_option_of_the_record_that_is_not_known_is_named() {
    let text = record(&setup(REACH, &["paper"]), vec![babble(1), recall()]);
    let mut json: Value = serde_json::from_str(&text.to_json().unwrap()).unwrap();
    json["extra"] = json!(1);
    let fault = Record::from_json(&json.to_string()).unwrap_err();
    assert!(fault.problem.contains("extra"), "{}", fault.problem);
    json.as_object_mut().unwrap().remove("extra");
    json["version"] = json!(2);
    let fault = Record::from_json(&json.to_string()).unwrap_err();
    assert_eq!(fault.field.as_deref(), Some("version"));
}

#[test]
fn every_end_of_every_slider_opens() {
    let registry = registry().unwrap();
    for environment in &registry.environments {
        let sliders = &registry.sliders[environment.task];
        for variant in &registry.variants[environment.task] {
            for slider in sliders {
                let mut bounds = vec![json!(slider.low), json!(slider.high)];
                bounds.extend(slider.defaults.values().cloned());
                for value in slider.choices.clone().unwrap_or(bounds) {
                    opens(environment.id, variant, slider, value);
                }
            }
        }
    }
}

/// Opens a session with a slider moved to a value.
fn opens(env: &str, variant: &str, slider: &babble_lab::Slider, value: Value) {
    let value = if slider.list { json!([value]) } else { value };
    // A whole number of neurons is one in JSON, too.
    let whole = value
        .as_f64()
        .filter(|x| slider.id == "neurons" && x.fract() == 0.0);
    let value = whole.map_or(value, |x| json!(x as u64));
    let nested = |value| {
        slider
            .path
            .iter()
            .rev()
            .fold(value, |value, name| json!({ *name: value }))
    };
    let mut setup = Setup {
        agents: vec![common::hebb(variant, &json!({}))],
        ..default_setup(env).unwrap()
    };
    let part = object(&nested(value));
    match serde_json::to_value(slider.place)
        .unwrap()
        .as_str()
        .unwrap()
    {
        "config" => setup.config = part,
        "options" => setup.options = part,
        _ if !slider.defaults.contains_key(variant) => return,
        _ => setup.agents[0] = common::hebb(variant, &Value::Object(part)),
    }
    if let Err(fault) = Lab::open(setup, Policies::default(), executor()) {
        panic!("{env} {variant} {}: {}", slider.id, fault.problem);
    }
}
