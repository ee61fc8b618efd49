//! Writes the golden records again, after a change that was meant to change bits:
//! `cargo run -p babble_lab --example golden_records`.

use std::error::Error;
use std::fs;
use std::path::Path;

use babble_env::Executor;
use babble_lab::{Command, Lab, Policies, Setup, ToJson};
use serde_json::{Value, json};

/// A learner of a variant, or one that learns by an expression.
fn hebb(variant: &str, rule: &Value) -> Value {
    json!({"kind": "hebb", "variant": variant, "brain": {}, "rule": rule})
}

fn setup(env: &str, agents: &Value) -> Value {
    json!({"env": env, "options": {}, "profile": "paper", "config": {}, "seed": 5, "agents": agents})
}

fn script(setup: &Value, changes: &Value, case: &Value) -> Vec<Value> {
    let mut changed = setup.clone();
    changed["config"] = changes.clone();
    vec![
        json!({"do": "babble", "n": 12}),
        json!({"do": "recall", "case": null}),
        json!({"do": "step", "n": 400}),
        json!({"do": "test", "n": 4}),
        json!({"do": "lesion", "agent": 0, "map": "input", "association": 0, "neurons": [200, 220]}),
        json!({"do": "lesion", "agent": 0, "map": "output", "association": 0, "neurons": [100, 101]}),
        json!({"do": "babble", "n": 5}),
        json!({"do": "change", "setup": changed}),
        json!({"do": "babble", "n": 3}),
        json!({"do": "recall", "case": case}),
        json!({"do": "step", "n": 30}),
        json!({"do": "answer", "question": "lag", "value": 0.8}),
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let rule = json!("eta * (a - a_mean) * (g - g_mean) * (w_max^2 - w^2) - 0.001 * tanh(w)");
    let reach = setup(
        "BabbleReach-v0",
        &json!([hebb("conjunctive", &Value::Null), hebb("paper", &rule)]),
    );
    let grasp = setup(
        "BabbleGrasp-v0",
        &json!([hebb("chain", &Value::Null), hebb("paper", &Value::Null)]),
    );
    let frame = json!({"body": {"eye": {"frame": "fick"}, "muscles": {"kp": 60.0}}});
    let friction = json!({"body": {"object": {"friction": 0.7}}});
    let target = json!({"target": [-0.12, 0.22]});
    let object = json!({"object": [-0.1, 0.2], "diameter": 0.05});
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    for (name, setup, changes, case) in [
        ("reach", reach, frame, target),
        ("grasp", grasp, friction, object),
    ] {
        let begin: Setup = serde_json::from_value(setup.clone())?;
        let mut lab = Lab::open(begin, Policies::default(), Executor::new(1)?)?;
        for command in script(&setup, &changes, &case) {
            lab.apply(&serde_json::from_value::<Command>(command)?)?;
        }
        let text = lab.record(None, "golden")?.to_json()?;
        fs::write(folder.join(format!("{name}.json")), text + "\n")?;
    }
    Ok(())
}
