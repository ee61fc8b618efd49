//! Messages that are none: refused with what is wrong, and the session goes on as it was.

mod serving;

use babble_server::binary::request::Envelope;
use proptest::prelude::*;
use rmp_serde::to_vec_named;
use serde_json::{Value, json};
use serving::{Client, Running, actions, fault, reach, read};
use tokio::io::AsyncWriteExt;
use tokio_tungstenite::tungstenite::Message;

/// A request as bytes.
fn message(id: u64, operation: &str, body: &Value) -> Vec<u8> {
    to_vec_named(&(id, operation, body)).unwrap()
}

/// A request whose body is given as bytes.
fn with_body(id: u64, operation: &str, body: &[u8]) -> Vec<u8> {
    let mut bytes = to_vec_named(&(id, operation, ())).unwrap();
    bytes.pop();
    bytes.extend_from_slice(body);
    bytes
}

/// A map with one entry, whose value is given as bytes.
fn entry(name: &str, value: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0x81];
    bytes.extend(rmp_serde::to_vec(name).unwrap());
    bytes.extend_from_slice(value);
    bytes
}

/// Steps and maps, each with what the error says.
fn bad_steps(id: u64) -> Vec<(Vec<u8>, &'static str)> {
    let body = |operation, body: Value| message(id, operation, &body);
    let raw = |operation, body: &[u8]| with_body(id, operation, body);
    vec![
        (body("", json!({})), "operation \"\" is unknown"),
        (body("stepp", json!({})), "known: make, resume, reset"),
        (body("step", json!({})), "missing field `actions`"),
        (body("step", json!(null)), "the body must be a map"),
        (body("step", json!([[0.0]])), "the body must be a map"),
        (
            body("step", json!({"actions": [0.0, 0.0]})),
            "a binary of whole numbers of 4 bytes",
        ),
        (
            body("step", json!({"actions": "xxxxxxxx"})),
            "a binary of whole numbers of 4 bytes",
        ),
        (
            raw("step", &entry("actions", &[0xc4, 3, 0, 0, 0])),
            "invalid length 3",
        ),
        (
            raw("step", &entry("actions", &[0xc4, 4, 0, 0, 0, 0])),
            "expected 2",
        ),
        (
            raw(
                "step",
                &entry("actions", &[0xc4, 8, 0, 0, 0xc0, 0x7f, 0, 0, 0, 0]),
            ),
            "NaN",
        ),
        (
            raw(
                "step",
                &entry("actions", &[0xc4, 8, 0, 0, 0x80, 0x7f, 0, 0, 0, 0]),
            ),
            "inf",
        ),
        // Lengths that are claimed and not sent.
        (
            raw(
                "step",
                &entry("actions", &[0xc6, 0xff, 0xff, 0xff, 0xff, 0]),
            ),
            "step",
        ),
        (
            raw("reset", &entry("seeds", &[0xdd, 0xff, 0xff, 0xff, 0xff])),
            "reset",
        ),
        (
            raw(
                "reset",
                &entry("cases", &[0xdd, 0x7f, 0xff, 0xff, 0xff, 0x80]),
            ),
            "reset",
        ),
        (raw("reset", &[0xdf, 0xff, 0xff, 0xff, 0xff]), "reset"),
        (raw("step", &[0x81]), "step"),
        (raw("step", &[]), "the body must be a map"),
        (raw("step", &[0xc1]), "the body must be a map"),
        (raw("close", &[0x80, 0xc0]), "1 bytes follow the message"),
    ]
}

/// Likewise, of resets.
fn bad_resets(id: u64) -> Vec<(Vec<u8>, &'static str)> {
    let body = |operation, body: Value| message(id, operation, &body);
    let raw = |operation, body: &[u8]| with_body(id, operation, body);
    let nan = |name| entry(name, &[0xcb, 0x7f, 0xf8, 0, 0, 0, 0, 0, 0]);
    let deep: Vec<u8> = [vec![0x91; 200], vec![0xc0]].concat();
    vec![
        (body("reset", json!({"seed": [1]})), "unknown field `seed`"),
        (body("reset", json!({"seeds": [-1]})), "reset"),
        (body("reset", json!({"seeds": [1.5]})), "reset"),
        (
            body("reset", json!({"seeds": [1, 2]})),
            "seeds has 2 values, expected 1",
        ),
        (body("reset", json!({"mask": true})), "a binary"),
        (
            raw("reset", &entry("mask", &[0xc4, 1, 2])),
            "mask has 2, expected 0 or 1",
        ),
        (
            raw("reset", &entry("mask", &[0xc4, 0])),
            "mask has 0 values, expected 1",
        ),
        (
            body("reset", json!({"cases": [{"targett": [0.3, 0.3]}]})),
            "target",
        ),
        (
            body("reset", json!({"cases": [{"target": [0.3]}]})),
            "target",
        ),
        (
            body("reset", json!({"cases": [{"target": "near"}]})),
            "reset",
        ),
        (
            body("reset", json!({"cases": [{"target": [1e300, 0.0]}]})),
            "target",
        ),
        (
            raw(
                "reset",
                &entry("cases", &[&[0x91][..], &nan("target")].concat()),
            ),
            "target",
        ),
        (raw("reset", &entry("cases", &deep)), "reset"),
    ]
}

/// Likewise, of the operations that change nothing.
fn bad_questions(id: u64) -> Vec<(Vec<u8>, &'static str)> {
    let body = |operation, body: Value| message(id, operation, &body);
    let raw = |operation, body: &[u8]| with_body(id, operation, body);
    vec![
        (body("hash", json!({"env": 1})), "env = 1"),
        (body("hash", json!({"env": -1})), "hash"),
        (
            body("hash", json!({"env": 0, "more": 0})),
            "unknown field `more`",
        ),
        (body("save", json!({"envs": [0, 0]})), "states at once = 2"),
        (body("save", json!({"envs": [9]})), "env = 9"),
        (
            body("load", json!({"states": []})),
            "states has 0 values, expected 1",
        ),
        (
            raw("load", &entry("states", &[0x91, 0xc4, 2, 1, 2])),
            "states[0]",
        ),
        (
            body("render", json!({"env": 0, "camera": "eye"})),
            "missing field `width`",
        ),
        (
            body(
                "render",
                json!({"env": 0, "camera": "ey", "width": 9, "height": 9}),
            ),
            "eye",
        ),
        (
            body(
                "render",
                json!({"env": 0, "camera": "eye", "width": 0, "height": 9}),
            ),
            "0",
        ),
        (
            body(
                "render",
                json!({"env": 0, "camera": "eye", "width": 4_294_967_295_u32, "height": 4_294_967_295_u32}),
            ),
            "at most 4194304",
        ),
        (body("goal_reward", json!({})), "missing field `achieved`"),
        (
            raw(
                "goal_reward",
                b"\x82\xa8achieved\xc4\x04\0\0\0\0\xa7desired\xc4\x04\0\0\0\0",
            ),
            "expected a multiple of",
        ),
        (
            body("scenarios", json!({"protocol": "table9", "n": 1})),
            "table",
        ),
        (
            body(
                "scenarios",
                json!({"protocol": "table1", "n": 1_000_000_000}),
            ),
            "n = 1000000000",
        ),
        (
            body("make", json!({"env": "BabbleReach-v0"})),
            "has a session already",
        ),
        (
            body("resume", json!({"key": "s1-0"})),
            "has a session already",
        ),
    ]
}

#[tokio::test]
async fn bad_bodies_count_as_requests_and_change_nothing() {
    let running = Running::start(&[]).await;
    let (mut client, _) = running.play(reach()).await;
    client.ask("reset", json!({"seeds": [3]})).await;
    let before = client.hash().await;
    for (bytes, says) in [bad_steps(1), bad_resets(1), bad_questions(1)].concat() {
        client.id += 1;
        let bytes = renumbered(&bytes, client.id);
        let reply = client.exchange(bytes.clone()).await;
        let (id, refused) = read::<serving::Anything>(&reply);
        let refused = refused.expect_err(says);
        assert_eq!(id, Some(client.id), "{says}");
        assert!(refused.message.contains(says), "{says}: {refused:?}");
        // It is executed once, too.
        assert_eq!(client.exchange(bytes).await, reply);
    }
    assert_eq!(client.hash().await, before);
    read::<serving::Anything>(&client.step(1, 0.5).await)
        .1
        .unwrap();
    running.ended().await;
}

/// The message with another id, written with nine bytes.
fn renumbered(bytes: &[u8], id: u64) -> Vec<u8> {
    let mut rest = &bytes[1..];
    rmp::decode::read_int::<u64, _>(&mut rest).unwrap();
    let mut renumbered = vec![0x93, 0xcf];
    renumbered.extend(id.to_be_bytes());
    renumbered.extend_from_slice(rest);
    renumbered
}

#[tokio::test]
async fn messages_without_an_id_do_not_count() {
    let running = Running::start(&[]).await;
    let (mut client, _) = running.play(reach()).await;
    client.ask("reset", json!({})).await;
    let whole = message(client.id + 1, "step", &json!({}));
    let bad: Vec<Vec<u8>> = vec![
        vec![],
        vec![0xc1],
        vec![0x93],
        vec![0x92, 1, 0xa4, b's', b't', b'e', b'p'],
        vec![0x94, 1, 0xa1, b's', 0x80, 0x80],
        vec![0x93, 0xff, 0xa1, b's', 0x80],
        vec![0x93, 0xc0, 0xa1, b's', 0x80],
        vec![0x93, 0xcb, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0, 0xa1, b's', 0x80],
        vec![0xdd, 0xff, 0xff, 0xff, 0xff],
        vec![0x81, 1, 2],
        whole[..2].to_vec()[..1].to_vec(),
    ];
    for bytes in bad {
        let (id, refused) = read::<serving::Anything>(&client.exchange(bytes.clone()).await);
        let refused = refused.unwrap_err();
        assert_eq!((id, &*refused.kind), (None, "ProtocolError"), "{bytes:?}");
        assert!(refused.message.contains("array of three"), "{refused:?}");
    }
    client.send(Message::Text("{}".into())).await;
    let refused = fault(&client.reply().await);
    assert!(
        refused.message.contains("binary messages only"),
        "{refused:?}"
    );
    read::<serving::Anything>(&client.step(1, 0.5).await)
        .1
        .unwrap();
    running.ended().await;
}

#[tokio::test]
async fn what_is_made_wrongly_can_be_made_again() {
    let running = Running::start(&[]).await;
    let mut client = running.connect().await;
    let make = |body: Value| message(0, "make", &body);
    let with = |name: &str, value: Value| {
        let mut body = reach();
        body[name] = value;
        make(body)
    };
    let nan = [
        &[0x82, 0xa3][..],
        b"env\xaeBabbleReach-v0\xa6config",
        &entry("physics_step_s", &[0xcb, 0x7f, 0xf8, 0, 0, 0, 0, 0, 0]),
    ]
    .concat();
    for (bytes, says) in [
        (make(json!({})), "missing field `env`"),
        (make(json!({"env": "BabbleReach-v1"})), "BabbleReach-v0"),
        (make(json!({"env": "../BabbleReach-v0"})), "environment"),
        (with("num_envs", json!(0)), "num_envs = 0"),
        (with("num_envs", json!(-1)), "make"),
        (
            with("num_envs", json!(1_000_000_000_000_u64)),
            "at most 4096",
        ),
        (with("autoreset", json!("nextstep")), "NextStep"),
        (with("config", json!("/etc/passwd")), "/etc/passwd"),
        (with("config", json!({"physic": 1})), "physic"),
        (with("config", json!([])), "config"),
        (with_body(0, "make", &nan), "NaN is not finite"),
        (with("options", json!({"reward": 1})), "reward"),
        (with("options", json!({"rewardd": "sparse"})), "reward"),
        (
            with(
                "options",
                json!({"control": "pattern", "max_episode_steps": -1}),
            ),
            "max_episode_steps",
        ),
        (
            with("options", json!({"obs": "retina", "retina_size": 100_000})),
            "retina_size",
        ),
        (with("options", json!([])), "expected a map"),
        (with("threads", json!(-1)), "make"),
        (with("colour", json!("red")), "unknown field `colour`"),
        (message(0, "step", &json!({})), "missing field `actions`"),
        (
            message(0, "hash", &json!({"env": 0})),
            "begin with make or resume",
        ),
        (
            message(0, "resume", &json!({"key": ""})),
            "no session has it",
        ),
        (
            message(0, "resume", &json!({"key": "s1"})),
            "no session has it",
        ),
    ] {
        let refused = fault(&client.exchange(bytes).await);
        assert!(refused.message.contains(says), "{says}: {refused:?}");
    }
    running.has_sessions(0).await;
    client.make(reach()).await.unwrap();
    running.ended().await;
}

#[tokio::test]
async fn a_message_that_is_too_long_ends_the_connection_and_not_the_session() {
    let running = Running::start(&["--message-bytes", "100000"]).await;
    let (mut client, made) = running.play(reach()).await;
    client.ask("reset", json!({})).await;
    client.send(Message::Binary(vec![0; 100_001].into())).await;
    assert_eq!(client.closed().await, Some(1009));
    let mut again = running.connect().await;
    assert_eq!(again.resume(&made.key).await.unwrap().last, 1);
    running.ended().await;
}

#[tokio::test]
async fn frames_that_are_none_end_the_connection_and_not_the_session() {
    let running = Running::start(&[]).await;
    for bytes in [
        &[0x82, 1, 0x80][..],                                          // Unmasked.
        &[0x83, 0x80, 0, 0, 0, 0],       // An opcode that is reserved.
        &[0xf2, 0x80, 0, 0, 0, 0],       // Reserved bits.
        &[0x89, 0xfe, 1, 0, 0, 0, 0, 0], // A ping of 256 bytes.
        &[0x82, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff], // 2⁶⁴ − 1 bytes.
    ] {
        let (client, made) = running.play(reach()).await;
        let mut stream = client.socket.into_inner();
        stream.write_all(bytes).await.unwrap();
        let mut again = running.connect().await;
        assert_eq!(again.resume(&made.key).await.unwrap().last, 0);
    }
    running.ended().await;
}

#[tokio::test]
async fn a_message_in_many_frames_is_one() {
    let running = Running::start(&[]).await;
    let (mut client, _) = running.play(reach()).await;
    client.ask("reset", json!({})).await;
    let mut other = running.play(reach()).await.0;
    other.ask("reset", json!({})).await;
    let bytes = to_vec_named(&(2, "step", actions(1, 0.1))).unwrap();
    send_in_frames(&mut client, &bytes).await;
    let (id, stepped) = read::<serving::Anything>(&client.reply().await);
    assert_eq!((id, stepped.is_ok()), (Some(2), true));
    running.ended().await;
}

async fn send_in_frames(client: &mut Client, bytes: &[u8]) {
    use tokio_tungstenite::tungstenite::protocol::frame::Frame;
    use tokio_tungstenite::tungstenite::protocol::frame::coding::{Data, OpCode};
    for (i, part) in bytes.chunks(3).enumerate() {
        let kind = if i == 0 { Data::Binary } else { Data::Continue };
        let last = 3 * i + part.len() == bytes.len();
        let frame = Frame::message(part.to_vec(), OpCode::Data(kind), last);
        client.send(Message::Frame(frame)).await;
    }
}

/// Every request with bodies that are right.
fn good() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = [
        ("make", json!({"env": "BabbleReach-v0", "num_envs": 3, "config": {"a": [1.5, "b", null]}, "options": {"obs": "goal"}, "threads": 2})),
        ("resume", json!({"key": "s1-00"})),
        ("reset", json!({"seeds": [1, null], "cases": [{"target": [0.1, 0.2], "obstacle": null}, null]})),
        ("save", json!({"envs": [0, 1], "ended": true})),
        ("load", json!({"states": [null]})),
        ("hash", json!({"env": 1})),
        ("render", json!({"env": 0, "camera": "eye", "width": 3, "height": 4, "moment": 1, "png": true})),
        ("scenarios", json!({"protocol": "table1", "n": 3, "seed": 4, "split": "test"})),
        ("close", json!({})),
    ]
    .iter()
    .map(|(operation, body)| message(7, operation, body))
    .collect();
    all.push(to_vec_named(&(7, "step", actions(3, 0.5))).unwrap());
    all
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let envelope = Envelope::read(&bytes);
        prop_assert!(envelope.id.is_some() || envelope.request.is_err());
    }

    #[test]
    fn a_changed_message_is_read_or_refused(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
    ) {
        let good = good();
        let mut bytes = which.get(&good).clone();
        prop_assert!(Envelope::read(&bytes).request.is_ok());
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let changed = Envelope::read(&bytes);
        prop_assert!(changed.id.is_some() || changed.request.is_err());
        // No beginning of a message is a message.
        let whole = which.get(&good);
        let cut = Envelope::read(&whole[..cut.index(whole.len())]);
        prop_assert!(cut.request.is_err());
    }
}
