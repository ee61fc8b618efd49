//! Writes the inputs that fuzzing begins with into `corpus`, for use after a format has changed:
//! `cargo run --bin seeds`.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use babble_agent::grasp::GraspBabbling;
use babble_agent::{
    GraspBrain, GraspNetwork, Learner, Network, ReachBabbling, ReachBrain, ReachNetwork, Variant,
};
use babble_env::tasks::grasp::{GraspRequest, ObjectPlace};
use babble_env::{
    Autoreset, Batch, Config, EnvError, Executor, GraspOptions, GraspTask, ReachOptions, ReachTask,
    Task,
};
use babble_fuzz::snapshots::{body_of, grasping, reaching};
use babble_lab::lesson::lesson;
use babble_lab::{Command, Lab, Policies, ToJson};
use safetensors::SafeTensors;
use serde_json::json;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    // Each control, the goal form, recording, the other body.
    for (choice, steps) in [(0, 0), (1, 3), (2, 6), (3, 1), (12, 5), (24, 4)] {
        let env = begun(reaching(choice), None)?;
        write("reach_snapshot", choice, &played(env, steps, 0.3)?)?;
    }
    // Each control, the goal form, recording, the reflex, rapier; in contact.
    for (choice, steps) in [
        (0, 0),
        (16, 12),
        (17, 8),
        (2, 6),
        (12, 4),
        (48, 10),
        (34, 3),
    ] {
        let task = grasping(choice);
        let start = [0.2, 0.8];
        let near = GraspRequest {
            start: Some(start),
            object: ObjectPlace::At(task.before_palm(start, 0.02, 0.006)),
            diameter: Some(0.04),
            ..GraspRequest::default()
        };
        let env = begun(task, (steps > 0).then_some(near))?;
        write("grasp_snapshot", choice, &played(env, steps, 0.2)?)?;
    }
    for name in ["paper", "icub"] {
        let value: serde_json::Value = serde_json::from_str(&Config::profile(name)?.to_json()?)?;
        let text = if name == "paper" {
            toml::to_string(&value)?
        } else {
            value.to_string()
        };
        put("config", name, text.as_bytes())?;
    }
    let small = "profile = \"icub\"\n[body.arm]\nhalf_width_m = 0.012\n[body.joints.elbow]\nupper_deg = 99\n";
    put("config", "overrides", small.as_bytes())?;
    agents()?;
    requests()?;
    openenv_messages()?;
    lab_records()
}

/// The golden sessions, and the beginnings of lessons.
fn lab_records() -> Result<()> {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rust/babble_lab/tests/golden");
    for name in ["reach", "grasp"] {
        let text = std::fs::read(golden.join(format!("{name}.json")))?;
        put("lab_record", name, &text)?;
    }
    for id in ["equilibrium", "hebb", "chain"] {
        let setup = lesson(id)?.setup.clone();
        let mut lab = Lab::open(setup, Policies::default(), Executor::new(1)?)?;
        if lab.state()?.agents[0].learns {
            lab.apply(&Command::Babble { n: 2 })?;
        }
        lab.apply(&Command::Recall { case: None })?;
        lab.apply(&Command::Step { n: 9 })?;
        put(
            "lab_record",
            id,
            lab.record(Some(id), id)?.to_json()?.as_bytes(),
        )?;
    }
    Ok(())
}

/// A request of each operation.
fn requests() -> Result<()> {
    let env = begun(
        ReachTask::new(Config::profile("paper")?, ReachOptions::default())?,
        None,
    )?;
    let state = serde_bytes::ByteBuf::from(played(env, 3, 0.3)?);
    let number = [0_u8; 16];
    for (operation, body) in [
        (
            "make",
            json!({"env": "BabbleReach-v0", "num_envs": 2, "config": {"body": {"arm": {"density_kg_m3": 900}}}, "options": {"obs": "retina", "record": true}}),
        ),
        (
            "reset",
            json!({"seeds": [1, null], "cases": [{"target": [0.1, 0.3], "obstacle": null}, {}]}),
        ),
        ("save", json!({"envs": [1], "ended": false})),
        ("hash", json!({"env": 1})),
        ("case", json!({"env": 0})),
        ("trail", json!({"env": 0})),
        ("moments", json!({"env": 0})),
        (
            "render",
            json!({"env": 0, "camera": "eye", "width": 32, "height": 32, "png": true}),
        ),
        (
            "scenarios",
            json!({"protocol": "table1", "n": 2, "seed": 3}),
        ),
        ("close", json!({})),
    ] {
        put(
            "request",
            operation,
            &rmp_serde::to_vec_named(&(1, operation, body))?,
        )?;
    }
    let load = rmp_serde::to_vec_named(&(
        1,
        "load",
        [("states", [Some(state), None])]
            .into_iter()
            .collect::<BTreeMap<_, _>>(),
    ))?;
    put("request", "load", &load)?;
    let binary = serde_bytes::Bytes::new(&number);
    for (operation, fields) in [
        ("step", &["actions"][..]),
        ("goal_reward", &["achieved", "desired"]),
    ] {
        let body: BTreeMap<_, _> = fields.iter().map(|&field| (field, binary)).collect();
        put(
            "request",
            operation,
            &rmp_serde::to_vec_named(&(1, operation, body))?,
        )?;
    }
    Ok(())
}

/// A message of each type, and resets of another environment and of a case.
fn openenv_messages() -> Result<()> {
    for (name, message) in [
        (
            "reset",
            json!({"type": "reset", "data": {"seed": 3, "episode_id": "a"}}),
        ),
        (
            "another",
            json!({"type": "reset", "data": {"env": "BabbleGrasp-v0", "options": {"obs": "goal", "reward": "sparse"}}}),
        ),
        (
            "config",
            json!({"type": "reset", "data": {"config": {"body": {"arm": {"density_kg_m3": 900}}}}}),
        ),
        (
            "case",
            json!({"type": "reset", "data": {"scenario": {"target": [0.1, 0.3], "obstacle": null}}}),
        ),
        (
            "step",
            json!({"type": "step", "data": {"action": [0.5, -2], "metadata": {}}}),
        ),
        ("state", json!({"type": "state"})),
        (
            "mcp",
            json!({"type": "mcp", "data": {"jsonrpc": "2.0", "id": 1, "method": "tools/list"}}),
        ),
        ("close", json!({"type": "close"})),
    ] {
        put("openenv_message", name, message.to_string().as_bytes())?;
    }
    Ok(())
}

fn begun<T: Task>(task: T, request: Option<T::Request>) -> Result<Batch<T>> {
    let mut env = Batch::new(Arc::new(task), 1, Autoreset::Disabled, 1)?;
    env.seed(0, 1)?;
    if let Some(request) = request {
        env.request(0, request)?;
    }
    env.reset(&[true])?;
    Ok(env)
}

fn played<T: Task>(mut env: Batch<T>, steps: usize, action: f32) -> Result<Vec<u8>> {
    for _ in 0..steps {
        match env.step(&vec![action; env.task().action_len()]) {
            Err(EnvError::NeedsReset { .. }) => break,
            result => result?,
        }
    }
    Ok(env.save(0)?)
}

fn agents() -> Result<()> {
    let reach = ReachTask::new(Config::profile("paper")?, ReachOptions::default())?;
    let grasp = GraspTask::new(Config::profile("icub")?, GraspOptions::default())?;
    for variant in [Variant::Paper, Variant::Conjunctive] {
        let brain = ReachBrain {
            output_neurons: 2,
            obstacle_neurons: 2,
            target_neurons: 2,
            ..ReachBrain::variant(variant)
        };
        let learner = Learner::<ReachNetwork>::new(brain, &reach, 1, ReachBabbling::default())?;
        agent(&variant.to_string(), &learner)?;
    }
    let brain = GraspBrain {
        neurons: 2,
        ..GraspBrain::default()
    };
    agent(
        "grasp",
        &Learner::<GraspNetwork>::new(brain, &grasp, 1, GraspBabbling::InHand)?,
    )
}

/// What is known of an agent beside its weights.
fn agent<N: Network>(name: &str, learner: &Learner<N>) -> Result<()> {
    let file = learner.save()?;
    let (_, header) = SafeTensors::read_metadata(&file)?;
    let text = header.metadata().as_ref().and_then(|all| all.get(N::KEY));
    let (_, fields) = text
        .ok_or("no metadata")?
        .split_once(',')
        .ok_or("no fields")?;
    put("agent_file", name, &with_numbers(&format!("{{{fields}")))
}

/// Two neurons a side, no tensor too long, all weights 0.
fn with_numbers(json: &str) -> Vec<u8> {
    [&[0; 10], json.as_bytes()].concat()
}

fn write(target: &str, choice: u8, snapshot: &[u8]) -> Result<()> {
    let input = [&[choice], body_of(snapshot)].concat();
    put(target, &format!("options_{choice}"), &input)
}

fn put(target: &str, name: &str, input: &[u8]) -> Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(target);
    std::fs::create_dir_all(&folder)?;
    Ok(std::fs::write(folder.join(name), input)?)
}
