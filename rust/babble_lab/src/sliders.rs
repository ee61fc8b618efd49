//! Numbers of body, task, maps and rule that the page shows as sliders.

use std::collections::BTreeMap;

use babble_agent::erased::brain_of;
use babble_env::registry;
use babble_env::{Config, config::PROFILES};
use serde::Serialize;
use serde_json::{Value, json};

use crate::fault::Fault;

/// A number to be moved, or a choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Slider {
    /// A name for it.
    pub id: &'static str,
    /// Which part of a setup it changes: `config`, `brain` or `options`.
    #[serde(rename = "where")]
    pub place: Place,
    /// Path of the field there.
    pub path: &'static [&'static str],
    /// Symbol in the equations; empty if it has none.
    pub symbol: &'static str,
    /// What it is, in plain words.
    pub label: &'static str,
    /// Unit of the number.
    pub unit: &'static str,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// From one value to the next.
    pub step: f64,
    /// Whether equal ways of the slider are equal ratios.
    pub logarithmic: bool,
    /// Whether the value stands in a list of one.
    pub list: bool,
    /// Its values where a setup says nothing: of a brain by variant, for those that have the number;
    /// else by profile.
    pub defaults: BTreeMap<&'static str, Value>,
    /// The values, if they are no numbers.
    pub choices: Option<Vec<Value>>,
}

/// Which part of a setup a slider changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Body and task.
    Config,
    /// Maps and rule of an agent.
    Brain,
    /// Options of the environment.
    Options,
}

/// How a slider moves.
enum Range {
    Linear([f64; 3]),
    Logarithmic([f64; 2]),
    Choices(&'static [&'static str]),
    Flag,
}

use Place::{Brain, Config as Body, Options};
use Range::{Choices, Flag, Linear, Logarithmic};

/// Id, place, path, symbol, label, unit, range.
type Row = (
    &'static str,
    Place,
    &'static [&'static str],
    &'static str,
    &'static str,
    &'static str,
    Range,
);

#[rustfmt::skip]
const REACH: [Row; 10] = [
    ("kp", Body, &["body", "muscles", "kp"], "K_P", "stiffness of the arm's muscles", "N·m/rad", Logarithmic([5.0, 500.0])),
    ("kd", Body, &["body", "muscles", "kd"], "K_D", "damping of the arm's muscles", "N·m·s/rad", Logarithmic([4.0, 400.0])),
    ("movement", Body, &["reach", "movement_s"], "T", "time of a movement", "s", Linear([1.0, 20.0, 0.5])),
    ("obstacle", Body, &["body", "obstacle", "radius_m"], "r", "radius of the obstacle", "m", Linear([0.01, 0.05, 0.0025])),
    ("frame", Body, &["body", "eye", "frame"], "", "camera frame: which axis the eye turns about first", "", Choices(&["helmholtz", "fick"])),
    ("neurons", Brain, &["output_neurons"], "n", "neurons along each side of the output map", "", Linear([7.0, 31.0, 2.0])),
    ("sigma", Brain, &["sigma"], "σ", "width of the tuning curves", "spacings of neurons", Linear([0.3, 2.0, 0.05])),
    ("eta", Brain, &["rule", "eta"], "η", "learning rate", "", Logarithmic([0.01, 1.0])),
    ("w_max", Brain, &["rule", "w_max"], "w_max", "bound of the weights", "", Logarithmic([0.02, 2.0])),
    ("xi", Brain, &["rule", "xi"], "ξ", "share of the old value in the running averages", "", Linear([0.0, 0.95, 0.05])),
];

#[rustfmt::skip]
const GRASP: [Row; 13] = [
    ("kp", Body, &["body", "grip", "arm_muscles", "kp"], "K_P", "stiffness of the arm's muscles", "N·m/rad", Logarithmic([20.0, 2000.0])),
    ("kd", Body, &["body", "grip", "arm_muscles", "kd"], "K_D", "damping of the arm's muscles", "N·m·s/rad", Logarithmic([20.0, 2000.0])),
    ("hand_kp", Body, &["body", "grip", "hand_muscles", "kp"], "K_P hand", "stiffness of the hand's muscles", "N·m/rad", Logarithmic([0.05, 5.0])),
    ("friction", Body, &["body", "object", "friction"], "μ", "friction between hand and object", "", Linear([0.0, 2.0, 0.05])),
    ("diameter", Body, &["grasp", "diameters_m"], "d", "diameter of the objects", "m", Linear([0.015, 0.08, 0.001])),
    ("frame", Body, &["body", "eye", "frame"], "", "camera frame: which axis the eye turns about first", "", Choices(&["helmholtz", "fick"])),
    ("reflex", Options, &["enclosure_reflex"], "", "the hand closes by reflex when the palm is touched", "", Flag),
    ("neurons", Brain, &["neurons"], "n", "neurons along each side of the maps", "", Linear([7.0, 31.0, 2.0])),
    ("sigma", Brain, &["sigma"], "σ", "width of the tuning curves", "spacings of neurons", Linear([0.3, 2.0, 0.05])),
    ("eta", Brain, &["rule", "eta"], "η", "learning rate", "", Logarithmic([0.01, 1.0])),
    ("w_max", Brain, &["rule", "w_max"], "w_max", "bound of the weights", "", Logarithmic([0.02, 2.0])),
    ("xi", Brain, &["rule", "xi"], "ξ", "share of the old value in the running averages", "", Linear([0.0, 0.95, 0.05])),
    ("squeeze", Brain, &["squeeze_deg"], "", "how much further than recalled the hand closes", "deg", Linear([0.0, 60.0, 1.0])),
];

/// The sliders of a task; `variants` are those that a learner of it can have.
///
/// # Errors
/// Never in a build whose tests pass: every path exists.
pub(crate) fn of(task: &str, variants: &[&'static str]) -> Result<Vec<Slider>, Fault> {
    let rows = if task == "reach" {
        &REACH[..]
    } else {
        &GRASP[..]
    };
    rows.iter().map(|row| slider(task, variants, row)).collect()
}

fn slider(task: &str, variants: &[&'static str], row: &Row) -> Result<Slider, Fault> {
    let &(id, place, path, symbol, label, unit, ref range) = row;
    let mut defaults = defaults(task, variants, place, path)?;
    let list = defaults.values().any(Value::is_array);
    if list {
        for value in defaults.values_mut() {
            *value = value[0].take();
        }
    }
    let ([low, high, step], choices) = match range {
        Linear(numbers) => (*numbers, None),
        Logarithmic([low, high]) => ([*low, *high, *low / 10.0], None),
        Choices(names) => (
            [0.0; 3],
            Some(names.iter().map(|&name| json!(name)).collect()),
        ),
        Flag => ([0.0; 3], Some(vec![json!(false), json!(true)])),
    };
    Ok(Slider {
        id,
        place,
        path,
        symbol,
        label,
        unit,
        low,
        high,
        step,
        logarithmic: matches!(range, Logarithmic(_)),
        list,
        defaults,
        choices,
    })
}

/// The values of a field where a setup says nothing, by variant or profile.
fn defaults(
    task: &str,
    variants: &[&'static str],
    place: Place,
    path: &[&str],
) -> Result<BTreeMap<&'static str, Value>, Fault> {
    let pointer = format!("/{}", path.join("/"));
    let mut defaults = BTreeMap::new();
    match place {
        Body => {
            for profile in PROFILES {
                let config = serde_json::to_value(Config::profile(profile)?)?;
                defaults.extend(
                    config
                        .pointer(&pointer)
                        .map(|value| (profile, value.clone())),
                );
            }
        }
        Options => {
            let specs = registry::task(task)?.options;
            for spec in specs.iter().filter(|spec| spec.name == path[0]) {
                let value = serde_json::to_value(spec.default)?;
                defaults.extend(PROFILES.map(|profile| (profile, value.clone())));
            }
        }
        Brain => {
            for &variant in variants {
                let brain = brain_of(task, variant)?;
                defaults.extend(
                    brain
                        .pointer(&pointer)
                        .map(|value| (variant, value.clone())),
                );
            }
        }
    }
    Ok(defaults)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_reaches_its_values_in_every_profile_and_variant() -> Result<(), Fault> {
        let tasks = [
            ("reach", ["paper", "conjunctive"]),
            ("grasp", ["paper", "chain"]),
        ];
        for (task, variants) in tasks {
            for slider in of(task, &variants)? {
                assert!(!slider.defaults.is_empty(), "{}", slider.id);
                for value in slider.defaults.values() {
                    let within = value
                        .as_f64()
                        .is_some_and(|x| (slider.low..=slider.high).contains(&x));
                    let chosen = slider
                        .choices
                        .as_ref()
                        .is_some_and(|all| all.contains(value));
                    assert!(within || chosen, "{task} {} = {value}", slider.id);
                }
            }
        }
        Ok(())
    }

    #[test]
    fn a_profile_has_values_of_its_own() -> Result<(), Fault> {
        let sliders = of("reach", &["paper"])?;
        let frame = sliders.iter().find(|slider| slider.id == "frame");
        let frames = frame.map(|slider| [&slider.defaults["paper"], &slider.defaults["icub"]]);
        assert_eq!(frames, Some([&json!("helmholtz"), &json!("fick")]));
        Ok(())
    }
}
