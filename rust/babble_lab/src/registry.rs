//! What there is to choose from.

use std::collections::BTreeMap;

use babble_agent::erased::brain_of;
use babble_env::registry::{TASKS, TaskEntry, environment};
use babble_env::{AnyTask, Config, config::PROFILES};
use serde::Serialize;
use serde_json::Map;

use crate::fault::Fault;
use crate::setup::{AgentSetup, Setup};
use crate::sliders::{self, Slider};

/// Names that a variant of any task can have.
const VARIANTS: [&str; 3] = ["paper", "conjunctive", "chain"];

/// What there is to choose from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Registry {
    /// The environments.
    pub environments: Vec<Environment>,
    /// Variants of agents that learn by babbling, by task.
    pub variants: BTreeMap<&'static str, Vec<&'static str>>,
    /// Profiles of a config.
    pub profiles: Vec<&'static str>,
    /// What a case consists of, by task.
    pub case_parts: BTreeMap<&'static str, Vec<Part>>,
    /// Numbers to be moved by sliders, by task.
    pub sliders: BTreeMap<&'static str, Vec<Slider>>,
}

/// An environment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Environment {
    /// Its id.
    pub id: &'static str,
    /// Name of its task.
    pub task: &'static str,
    /// What its task is called.
    pub title: &'static str,
}

/// A part of a case, with bounds for the profile `paper`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Its name.
    pub name: &'static str,
    /// What it says.
    pub doc: &'static str,
    /// Unit of its numbers; none for true or false.
    pub unit: Option<&'static str>,
    /// Least value of each number, if it has numbers.
    pub low: Option<Vec<f64>>,
    /// Greatest value of each number.
    pub high: Option<Vec<f64>>,
}

/// The tasks that the lab shows: those in which an agent learns.
fn tasks() -> impl Iterator<Item = &'static TaskEntry> {
    TASKS
        .iter()
        .copied()
        .filter(|task| !variants(task.name).is_empty())
}

fn variants(task: &str) -> Vec<&'static str> {
    let has = |name: &&'static str| brain_of(task, name).is_ok();
    VARIANTS.into_iter().filter(has).collect()
}

/// What there is to choose from.
///
/// # Errors
/// Never in a build whose tests pass: the tasks can be made with their defaults.
pub fn registry() -> Result<Registry, Fault> {
    let mut registry = Registry {
        environments: Vec::new(),
        variants: BTreeMap::new(),
        profiles: PROFILES.to_vec(),
        case_parts: BTreeMap::new(),
        sliders: BTreeMap::new(),
    };
    for task in tasks() {
        let name = task.name;
        let environments = task.environments.iter().map(|row| Environment {
            id: row.id,
            task: name,
            title: task.title,
        });
        registry.environments.extend(environments);
        registry.variants.insert(name, variants(name));
        registry.case_parts.insert(name, parts(task)?);
        registry
            .sliders
            .insert(name, sliders::of(name, &variants(name))?);
    }
    Ok(registry)
}

fn parts(entry: &TaskEntry) -> Result<Vec<Part>, Fault> {
    let task = entry.make(Config::profile("paper")?, &Map::new())?;
    let part = |part: &babble_env::case::CasePart| {
        let bounds = part
            .lengths
            .iter()
            .max()
            .map(|&n| bounds(&*task, part.unit, n.max(1)));
        let (low, high) = bounds.unzip();
        Part {
            name: part.name,
            doc: part.doc,
            unit: (!part.unit.is_empty()).then_some(part.unit),
            low,
            high,
        }
    };
    Ok(entry.case_parts.iter().map(part).collect())
}

/// Bounds of a posture, a length, or a position and a radius.
fn bounds(task: &dyn AnyTask, unit: &str, n: usize) -> (Vec<f64>, Vec<f64>) {
    /// Least and greatest diameter or radius \[m\].
    const SIZE_M: [f64; 2] = [0.005, 0.2];
    let body = &task.config().body;
    let fingers: f64 = body.hand.finger_m.iter().sum();
    let reach = body.arm.upper_arm_m + body.arm.forearm_m + body.hand.palm_m + fingers;
    let place = if unit == "rad" {
        ["shoulder", "elbow"].map(|name| {
            let joint = body.joints.get(name);
            joint.map_or([0.0; 2], |joint| {
                [joint.lower_deg, joint.upper_deg].map(f64::to_radians)
            })
        })
    } else {
        [[-reach, reach]; 2]
    };
    let all = place.into_iter().chain([SIZE_M]);
    let of_part: Vec<[f64; 2]> = match n {
        1 => vec![SIZE_M],
        n => all.take(n).collect(),
    };
    of_part.into_iter().map(|[low, high]| (low, high)).unzip()
}

/// The setup that a session in an environment begins with: the agent of the paper.
///
/// # Errors
/// A [`Fault`] for an unknown environment, or one in which no agent learns.
pub fn default_setup(env: &str) -> Result<Setup, Fault> {
    let (task, row) = environment(env)?;
    let variants = variants(task.name);
    let Some(variant) = variants.first() else {
        return Err(Fault::config("env", format!("no agent babbles in {env}")));
    };
    Ok(Setup {
        env: row.id.to_owned(),
        options: Map::new(),
        profile: PROFILES[0].to_owned(),
        config: Map::new(),
        seed: 0,
        agents: vec![AgentSetup::hebb(variant)],
    })
}
