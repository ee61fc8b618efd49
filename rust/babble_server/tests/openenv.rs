//! OpenEnv's messages: what is refused, how, and that the episode goes on.

use babble_server::limits::Limits;
use babble_server::openenv::{Mode, Player, Served};
use babble_server::session::Session;
use proptest::prelude::*;
use serde_json::{Value, json};

fn served(env: &str) -> Served {
    Served {
        env: env.to_owned(),
        options: Vec::new(),
        openenv_mode: Mode::Simulation,
    }
}

fn player(env: &str) -> Player {
    let (served, limits) = (served(env), Limits::default());
    let session = Session::make(&served.make(), &limits, 1).unwrap();
    Player::new(served, limits, session)
}

fn ask(player: &mut Player, message: &str) -> Value {
    let reply = player
        .answer(message)
        .expect("a message that does not close");
    let text = reply.result.unwrap_or_else(|refusal| refusal.text());
    serde_json::from_str(&text).unwrap()
}

fn done(player: &mut Player, message: &Value) -> Value {
    let reply = ask(player, &message.to_string());
    assert_ne!(reply["type"], "error", "{message}: {reply}");
    reply["data"].clone()
}

fn reset(seed: u64) -> Value {
    json!({"type": "reset", "data": {"seed": seed}})
}

fn step(action: &[f64]) -> Value {
    json!({"type": "step", "data": {"action": action}})
}

/// What is wrong, OpenEnv's code for it, and a word of the message that says so.
const REFUSED: &[(&str, &str, &str)] = &[
    ("", "INVALID_JSON", "EOF"),
    ("{", "INVALID_JSON", "EOF"),
    ("reset", "INVALID_JSON", "expected"),
    (
        r#"{"type": "step", "data": {"action": [NaN, 0]}}"#,
        "INVALID_JSON",
        "column",
    ),
    (
        r#"{"type": "step", "data": {"action": [1e999, 0]}}"#,
        "INVALID_JSON",
        "out of range",
    ),
    ("[]", "VALIDATION_ERROR", "object"),
    ("null", "VALIDATION_ERROR", "object"),
    ("{}", "UNKNOWN_TYPE", "reset, step, state"),
    (r#"{"type": "restart"}"#, "UNKNOWN_TYPE", "restart"),
    (r#"{"type": 3}"#, "UNKNOWN_TYPE", "3"),
    (
        r#"{"type": "reset", "data": {}, "id": 1}"#,
        "VALIDATION_ERROR",
        "id",
    ),
    (
        r#"{"type": "reset", "data": null}"#,
        "VALIDATION_ERROR",
        "object",
    ),
    (
        r#"{"type": "reset", "data": []}"#,
        "VALIDATION_ERROR",
        "object",
    ),
    (
        r#"{"type": "reset", "data": {"sed": 1}}"#,
        "VALIDATION_ERROR",
        "seed",
    ),
    (
        r#"{"type": "reset", "data": {"seed": -1}}"#,
        "VALIDATION_ERROR",
        "-1",
    ),
    (
        r#"{"type": "reset", "data": {"seed": 0.5}}"#,
        "VALIDATION_ERROR",
        "0.5",
    ),
    (
        r#"{"type": "reset", "data": {"seed": 18446744073709551616}}"#,
        "VALIDATION_ERROR",
        "1.8",
    ),
    (
        r#"{"type": "reset", "data": {"env": "BabbleReech-v0"}}"#,
        "VALIDATION_ERROR",
        "BabbleReach-v0",
    ),
    (
        r#"{"type": "reset", "data": {"options": {"contrl": "posture"}}}"#,
        "VALIDATION_ERROR",
        "control",
    ),
    (
        r#"{"type": "reset", "data": {"config": "/etc/passwd"}}"#,
        "VALIDATION_ERROR",
        "paper",
    ),
    (
        r#"{"type": "reset", "data": {"config": {"body": {"arm": 1}}}}"#,
        "VALIDATION_ERROR",
        "arm",
    ),
    (
        r#"{"type": "reset", "data": {"scenario": {"targt": [0, 0]}}}"#,
        "VALIDATION_ERROR",
        "target",
    ),
    (
        r#"{"type": "reset", "data": {"scenario": {"target": [9.0, 9.0]}}}"#,
        "EXECUTION_ERROR",
        "target",
    ),
    (r#"{"type": "step"}"#, "VALIDATION_ERROR", "data"),
    (
        r#"{"type": "step", "data": {}}"#,
        "VALIDATION_ERROR",
        "action",
    ),
    (
        r#"{"type": "step", "data": {"action": [0.5]}}"#,
        "VALIDATION_ERROR",
        "1",
    ),
    (
        r#"{"type": "step", "data": {"action": [0.5, 0.5, 0.5]}}"#,
        "VALIDATION_ERROR",
        "3",
    ),
    (
        r#"{"type": "step", "data": {"action": 0.5}}"#,
        "VALIDATION_ERROR",
        "0.5",
    ),
    (
        r#"{"type": "step", "data": {"action": [true, 0]}}"#,
        "VALIDATION_ERROR",
        "true",
    ),
    (
        r#"{"type": "step", "data": {"action": [0, 0], "speed": 1}}"#,
        "VALIDATION_ERROR",
        "speed",
    ),
    (
        r#"{"type": "state", "data": {}}"#,
        "VALIDATION_ERROR",
        "no data",
    ),
    (r#"{"type": "mcp"}"#, "VALIDATION_ERROR", "data"),
];

/// Catches a bad message that ends the episode, or changes it, or has another code than OpenEnv's.
#[test]
fn bad_messages_are_named_and_change_nothing() {
    let (mut player, mut undisturbed) = (player("BabbleReach-v0"), player("BabbleReach-v0"));
    for player in [&mut player, &mut undisturbed] {
        done(player, &reset(7));
    }
    for (message, code, word) in REFUSED {
        let reply = ask(&mut player, message);
        assert_eq!(reply["type"], "error", "{message}: {reply}");
        assert_eq!(reply["data"]["code"], *code, "{message}: {reply}");
        let text = reply["data"]["message"].as_str().unwrap();
        assert!(text.contains(word), "{message}: {text}");
        let [one, other] =
            [&mut player, &mut undisturbed].map(|player| done(player, &step(&[0.02, -0.01])));
        assert_eq!(one, other, "after {message}");
    }
}

/// A reply would be several times the image's bytes. Catches a limit that counts those alone.
#[test]
fn an_observation_longer_than_a_message_is_refused() {
    let mut player = player("BabbleReach-v0");
    let mut asked = |size: u32| {
        let options = json!({"obs": "retina", "retina_size": size});
        let message = json!({"type": "reset", "data": {"options": options}});
        player.answer(&message.to_string()).unwrap().result
    };
    let most = Limits::default().message_bytes;
    let reply = asked(1000).unwrap();
    assert!(reply.len() <= most && reply.len() > 3 * 1000 * 1000);
    let refused = asked(2048).unwrap_err();
    assert_eq!(refused.kind, babble_server::fault::Kind::LimitError);
    assert!(
        refused.message.contains(&most.to_string()),
        "{}",
        refused.message
    );
}

/// JSON that nests deeply is refused before it can exhaust the stack.
#[test]
fn deep_json_is_refused() {
    let deep = "[".repeat(1_000_000);
    let message = format!(r#"{{"type": "reset", "data": {{"config": {deep}"#);
    let reply = ask(&mut player("BabbleReach-v0"), &message);
    assert_eq!(reply["data"]["code"], "INVALID_JSON");
}

/// Catches a server that steps on after the end, or whose error does not say what to do.
#[test]
fn a_step_outside_an_episode_says_reset() {
    let mut player = player("BabbleReachPattern-v0");
    let early = ask(&mut player, &step(&[0.0, 0.0]).to_string());
    done(&mut player, &reset(1));
    assert_eq!(done(&mut player, &step(&[0.0, 0.0]))["done"], true);
    let late = ask(&mut player, &step(&[0.0, 0.0]).to_string());
    for reply in [early, late] {
        assert_eq!(reply["data"]["code"], "EXECUTION_ERROR");
        assert!(
            reply["data"]["message"]
                .as_str()
                .unwrap()
                .contains("send a reset")
        );
    }
    assert_eq!(
        done(&mut player, &json!({"type": "state"}))["step_count"],
        1
    );
}

/// A reset with `env` makes another environment, which stays; after one that fails all is as it was.
#[test]
fn a_reset_changes_the_environment() {
    let mut player = player("BabbleReach-v0");
    let env = |player: &mut Player| done(player, &json!({"type": "state"}))["env"].clone();
    assert_eq!(env(&mut player), "BabbleReach-v0");
    let data = json!({"env": "BabbleGrasp-v0", "seed": 3, "options": {"control": "posture"}});
    let shown = done(&mut player, &json!({"type": "reset", "data": data}));
    assert_eq!(shown["observation"]["fovea"].as_array().unwrap().len(), 441);
    assert_eq!(env(&mut player), "BabbleGrasp-v0");
    done(&mut player, &reset(4));
    let data = json!({"env": "BabbleReach-v0", "scenario": {"target": [9, 9]}});
    assert_eq!(
        ask(
            &mut player,
            &json!({"type": "reset", "data": data}).to_string()
        )["type"],
        "error"
    );
    let state = done(&mut player, &json!({"type": "state"}));
    assert_eq!(
        (&state["env"], &state["seed"]),
        (&json!("BabbleGrasp-v0"), &json!(4))
    );
    let data = json!({"env": "BabbleReach-v0"});
    done(&mut player, &json!({"type": "reset", "data": data}));
    assert_eq!(env(&mut player), "BabbleReach-v0");
}

/// The case asked for is played, and shown in the state.
#[test]
fn a_reset_asks_for_a_case() {
    let mut player = player("BabbleReach-v0");
    done(&mut player, &reset(5));
    let case = done(&mut player, &json!({"type": "state"}))["case"].clone();
    let data = json!({"seed": 9, "episode_id": "again", "scenario": case});
    done(&mut player, &json!({"type": "reset", "data": data}));
    let state = done(&mut player, &json!({"type": "state"}));
    assert_eq!(state["case"], case);
    assert_eq!(state["episode_id"], "again");
}

/// MCP is answered by JSON-RPC, within OpenEnv's envelope.
#[test]
fn there_are_no_tools() {
    let mut player = player("BabbleReach-v0");
    let mut mcp = |data: Value| done(&mut player, &json!({"type": "mcp", "data": data}));
    let list = mcp(json!({"jsonrpc": "2.0", "id": 4, "method": "tools/list"}));
    assert_eq!(
        list,
        json!({"jsonrpc": "2.0", "id": 4, "result": {"tools": []}})
    );
    for (request, code) in [
        (json!({}), -32600),
        (json!({"jsonrpc": "1.0", "method": "tools/list"}), -32600),
        (
            json!({"jsonrpc": "2.0", "method": "tools/list", "id": [1]}),
            -32600,
        ),
        (json!({"jsonrpc": "2.0", "method": "reset"}), -32601),
        (
            json!({"jsonrpc": "2.0", "method": "tools/call", "params": {"name": "x"}}),
            -32602,
        ),
    ] {
        assert_eq!(mcp(request.clone())["error"]["code"], code, "{request}");
    }
}

/// Parts of messages, put together at random.
fn messages() -> impl Strategy<Value = String> {
    const PARTS: &[&str] = &[
        "{",
        "}",
        "[",
        "]",
        ":",
        ",",
        "\"type\"",
        "\"data\"",
        "\"reset\"",
        "\"step\"",
        "\"state\"",
        "\"mcp\"",
        "\"action\"",
        "\"seed\"",
        "\"scenario\"",
        "\"options\"",
        "\"config\"",
        "null",
        "0",
        "-1",
        "1e308",
        "true",
        "\"\\u0000\"",
    ];
    let random = prop::collection::vec(prop::sample::select(PARTS), 0..24);
    let field =
        prop::sample::select(&["seed", "episode_id", "env", "options", "config", "scenario"][..]);
    let value =
        prop::sample::select(&["null", "1", "\"\"", "[]", "{}", "{\"a\": [1]}", "1e30"][..]);
    prop_oneof![
        random.prop_map(|parts| parts.concat()),
        ".{0,40}",
        (field, value).prop_map(|(field, value)| {
            format!("{{\"type\": \"reset\", \"data\": {{\"{field}\": {value}}}}}")
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Whatever comes, the answer is a message of the protocol, and the next episode can be played.
    #[test]
    fn anything_is_answered(message in messages()) {
        let mut player = player("BabbleReach-v0");
        let reply = ask(&mut player, &message);
        let kind = reply["type"].as_str().unwrap();
        prop_assert!(["observation", "state", "mcp", "error"].contains(&kind), "{}", reply);
        let shown = done(&mut player, &reset(0));
        prop_assert_eq!(&shown["reward"], &Value::Null);
        prop_assert!(done(&mut player, &step(&[0.0, 0.0]))["reward"].is_number());
    }

    /// float32 numbers come out of JSON as they went in, also if a client reads them as float64. All of
    /// them were tried once: one does not.
    #[test]
    fn float32_survives_json(bits in any::<u32>()) {
        let number = f32::from_bits(bits);
        prop_assume!(number.is_finite() && number.abs() != 7.038_531e-26);
        let read: f64 = serde_json::from_str(&serde_json::to_string(&number).unwrap()).unwrap();
        prop_assert_eq!((read as f32).to_bits(), bits);
    }
}
