//! Networks that were trained elsewhere: their files, and what they do.

use babble_agent::tensors::{self, Tensor};
use babble_agent::{AgentError, Plan, Policy, PolicyNetwork, predict};
use babble_env::{Config, Executor};
use serde_json::{Value, json};

/// Numbers in an observation of reaching.
const SENSES: usize = 11;
const HIDDEN: usize = 5;

/// Numbers from −1 to 1 from a small generator.
fn numbers(n: usize, mut seed: u32) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 8_388_608.0 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

fn about(activation: &str, output: &str) -> Value {
    let config: Value =
        serde_json::from_str(&Config::profile("paper").unwrap().to_json().unwrap()).unwrap();
    json!({
        "version": 1, "algorithm": "PPO", "task": "reach", "options": {"control": "posture"}, "config": config,
        "senses": [["arm", 2], ["eye", 2], ["hand", 2], ["obstacle", 2], ["stretch", 2], ["time", 1]],
        "activation": activation, "output": output,
    })
}

/// The shape and the numbers of each tensor of a small network.
fn layers() -> Vec<(&'static str, Vec<usize>, Vec<f32>)> {
    vec![
        (
            "0.weight",
            vec![HIDDEN, SENSES],
            numbers(HIDDEN * SENSES, 1),
        ),
        ("0.bias", vec![HIDDEN], numbers(HIDDEN, 2)),
        ("1.weight", vec![2, HIDDEN], numbers(2 * HIDDEN, 3)),
        ("1.bias", vec![2], numbers(2, 4)),
    ]
}

fn file(about: &Value, layers: &[(&'static str, Vec<usize>, Vec<f32>)]) -> Vec<u8> {
    let tensors: Vec<_> = layers
        .iter()
        .map(|(name, shape, values)| Tensor {
            name: (*name).to_owned(),
            shape: shape.clone(),
            values,
        })
        .collect();
    tensors::write(PolicyNetwork::KEY, about, &tensors).unwrap()
}

/// The action by the formula, in double precision.
fn expected(senses: &[f32], activation: &str, output: &str) -> Vec<f64> {
    let layers = layers();
    let mut x: Vec<f64> = senses.iter().map(|&x| x.into()).collect();
    for pair in layers.as_chunks::<2>().0 {
        let [(name, _, weights), (_, _, biases)] = pair;
        let rows = weights.chunks_exact(x.len()).zip(biases);
        let sums = rows.map(|(row, &bias)| {
            row.iter()
                .zip(&x)
                .map(|(&w, x)| f64::from(w) * x)
                .sum::<f64>()
                + f64::from(bias)
        });
        let sums: Vec<f64> = sums.collect();
        x = match (*name, activation, output) {
            ("0.weight", "relu", _) => sums.iter().map(|x| x.max(0.0)).collect(),
            ("0.weight", ..) | (_, _, "tanh") => sums.iter().map(|x| x.tanh()).collect(),
            _ => sums.iter().map(|x| x.clamp(-1.0, 1.0)).collect(),
        };
    }
    x
}

/// An action is the formula's. Catches swapped axes, an activation of the last layer, and a missing bound.
#[test]
fn an_action_is_the_formulas() {
    let senses = numbers(SENSES * 50, 5);
    for activation in ["relu", "tanh"] {
        for output in ["clip", "tanh"] {
            let network =
                PolicyNetwork::load(&file(&about(activation, output), &layers())).unwrap();
            let executor = &mut Executor::new(1).unwrap();
            let mut plans = Vec::new();
            let actions = predict(&network, &senses, &[true; 50], &mut plans, executor).unwrap();
            assert_eq!(plans, vec![Plan::Steps; 50]);
            for (senses, action) in senses.chunks_exact(SENSES).zip(actions.chunks_exact(2)) {
                for (x, y) in action.iter().zip(expected(senses, activation, output)) {
                    assert!(
                        (f64::from(*x) - y).abs() < 1e-6,
                        "{activation}, {output}: {x} {y}"
                    );
                }
            }
        }
    }
}

/// What is saved is loaded again, to the byte, with what is known of it.
#[test]
fn a_file_is_the_same_after_loading_and_saving() {
    let bytes = file(&about("relu", "clip"), &layers());
    let network = PolicyNetwork::load(&bytes).unwrap();
    assert_eq!(network.about().task, "reach");
    assert_eq!(network.about().options["control"], "posture");
    assert_eq!([network.senses_len(), network.action_len()], [SENSES, 2]);
    let saved = network.save().unwrap();
    assert_eq!(PolicyNetwork::load(&saved).unwrap().save().unwrap(), saved);
}

fn refused(bytes: &[u8]) -> String {
    match PolicyNetwork::load(bytes) {
        Err(error @ (AgentError::File { .. } | AgentError::Env(_))) => error.to_string(),
        other => panic!("expected a refusal, got {other:?}"),
    }
}

/// A file that fits neither itself nor the task is refused, and the error names the place.
#[test]
fn files_that_do_not_fit_are_refused() {
    let right = about("relu", "clip");
    for (at, value, said) in [
        ("/version", json!(2), "version 2 is not 1"),
        ("/task", json!("graps"), "did you mean \"grasp\""),
        ("/task", json!("grasp"), "the task has"),
        ("/options/control", json!("pattrn"), "control"),
        ("/senses/0/0", json!("leg"), "leg"),
        ("/activation", json!("gelu"), "gelu"),
        ("/output", json!("none"), "none"),
    ] {
        let mut wrong = right.clone();
        *wrong.pointer_mut(at).unwrap() = value;
        let problem = refused(&file(&wrong, &layers()));
        assert!(problem.contains(said), "{at}: {problem}");
    }
    for (i, shape, said) in [
        (
            0,
            vec![SENSES, HIDDEN],
            "0.bias has shape [5], expected [11]",
        ),
        (0, vec![HIDDEN * SENSES], "0.weight has 1 axes, expected 2"),
        (1, vec![1, HIDDEN], "0.bias has shape [1, 5]"),
        (2, vec![HIDDEN, 2], "1.bias has shape [2], expected [5]"),
    ] {
        let mut wrong = layers();
        wrong[i].1 = shape;
        let problem = refused(&file(&right, &wrong));
        assert!(problem.contains(said), "{i}: {problem}");
    }
    let mut wrong = layers();
    wrong[2].2[3] = f32::NAN;
    assert!(refused(&file(&right, &wrong)).contains("layer 1 has the weight NaN"));
    assert!(refused(&file(&right, &layers()[..2])).contains("5 outputs, and an action has 2"));
    assert!(refused(&file(&right, &[])).contains("0 layers"));
}

/// A file that is cut short or altered at any byte is refused, or is the same network.
#[test]
fn broken_files_are_refused() {
    let bytes = file(&about("tanh", "tanh"), &layers());
    let whole = PolicyNetwork::load(&bytes).unwrap();
    for at in 0..bytes.len() {
        assert!(PolicyNetwork::load(&bytes[..at]).is_err(), "cut at {at}");
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        if let Ok(network) = PolicyNetwork::load(&altered) {
            assert_eq!(
                network.save().unwrap(),
                whole.save().unwrap(),
                "altered at {at}"
            );
        }
    }
}

/// Weights so large that an action is no number are an error, not an action.
#[test]
fn an_action_that_is_no_number_is_an_error() {
    let mut large = layers();
    large[0].2 = vec![f32::MAX; HIDDEN * SENSES];
    large[2]
        .2
        .iter_mut()
        .enumerate()
        .for_each(|(i, w)| *w = if i % 2 == 0 { f32::MAX } else { f32::MIN });
    let network = PolicyNetwork::load(&file(&about("relu", "clip"), &large)).unwrap();
    let executor = &mut Executor::new(1).unwrap();
    let acted = predict(&network, &[1.0; SENSES], &[true], &mut Vec::new(), executor);
    assert!(
        matches!(acted, Err(AgentError::Config { field: "agent", .. })),
        "{acted:?}"
    );
}
