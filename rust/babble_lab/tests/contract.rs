//! The page's contract and this crate say the same: values of every type that goes to the page are written
//! as TypeScript, which `npm run types` checks against the contract, field by field.

mod common;

use std::fs;
use std::path::Path;

use babble_lab::{AgentSetup, Command, Fault, Happened, Lab, MapName, lessons, registry};
use common::{GRASP, REACH, babble, case, lab, object, recall, setup, step, test};
use serde::Serialize;
use serde_json::json;

/// A constant of a type of the contract, as TypeScript.
fn constant(name: &str, kind: &str, value: &(impl Serialize + ?Sized)) -> String {
    let json = serde_json::to_string(value).unwrap();
    format!("export const {name}: {kind} = {json};\n")
}

/// A session in which something of everything has happened.
fn session(env: &str, neuron: usize) -> (Lab, Vec<Command>) {
    let mut both = setup(env, &["paper"]);
    both.agents.push(AgentSetup::Random {});
    let mut changed = both.clone();
    changed.config = object(&json!({"body": {"obstacle": {"radius_m": 0.03}}}));
    let mut lab = lab(both);
    let obstacle = case(&json!({"obstacle": null}));
    let commands = vec![
        babble(3),
        test(2),
        Command::Lesion {
            agent: 0,
            map: MapName::Input,
            association: 0,
            neurons: vec![neuron],
        },
        Command::Change { setup: changed },
        Command::Recall {
            case: Some(obstacle),
        },
        step(1_000),
        recall(),
        step(2),
        serde_json::from_value(json!({"do": "answer", "question": "why", "value": "lag"})).unwrap(),
    ];
    for command in &commands {
        lab.apply(command).unwrap();
    }
    (lab, commands)
}

#[test]
fn the_contract_has_the_types_of_this_crate() {
    let mut text = "// Written by rust/babble_lab/tests/contract.rs; BLESS=1 writes it again.\n\
        import type {\n  Command,\n  Fault,\n  Lesson,\n  Progress,\n  Registry,\n  Scene,\n  Setup,\n  \
        Sight,\n  State,\n} from \"../src/engine/contract\";\n\
        import type { BareBrain, BareFilm } from \"../src/engine/answer\";\n\n"
        .to_owned();
    text += &constant("registry", "Registry", &registry().unwrap());
    text += &constant("lesson", "Lesson", &lessons()[5]);
    text += &constant("fault", "Fault", &Fault::config("n", "n = 0"));
    for (env, name) in [(REACH, "reach"), (GRASP, "grasp")] {
        let (lab, commands) = session(env, 220);
        assert!(matches!(lab.history()[5].what, Happened::Stepped { .. }));
        let state = lab.state().unwrap();
        text += &constant(&format!("{name}Setup"), "Setup", &state.setup);
        text += &constant(&format!("{name}State"), "State", &state);
        text += &constant(&format!("{name}Commands"), "Command[]", &commands);
        text += &constant(&format!("{name}Scene"), "Scene", &lab.scene(0).unwrap());
        text += &constant(&format!("{name}Sight"), "Sight", &lab.sight(0).unwrap());
        text += &constant(
            &format!("{name}Brain"),
            "BareBrain",
            &lab.brain(0).unwrap().unwrap(),
        );
        let mut film = lab.film(0, 0).unwrap();
        film.frames.truncate(1);
        text += &constant(&format!("{name}Film"), "BareFilm", &film);
        text += &constant(
            &format!("{name}Progress"),
            "Progress",
            &lessons()[5].progress(lab.history()),
        );
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../lab/tests/contract.ts");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, &text).unwrap();
    }
    assert_eq!(
        fs::read_to_string(&path).unwrap(),
        text,
        "BLESS=1 writes it again"
    );
}
