//! A session outlives its connection, executes each request once, and ends when it should.

mod serving;

use std::time::Duration;

use babble_server::limits::Limits;
use babble_server::session::Session;
use babble_server::wire::{Make, Reset};
use serde_json::json;
use serving::{Anything, Running, actions, fault, reach, read, within};

const ENVS: usize = 3;
/// Enough for episodes to end.
const STEPS: u64 = 300;

fn batch() -> serde_json::Value {
    json!({"env": "BabbleReach-v0", "num_envs": ENVS, "autoreset": "SameStep"})
}

fn reset() -> serde_json::Value {
    json!({"seeds": [1, 2, 3]})
}

fn action(step: u64) -> f32 {
    ((step * 37 % 101) as f32 / 50.0) - 1.0
}

/// Replies of the same session without a network, as the server would send them.
fn alone() -> Vec<Vec<u8>> {
    let make: Make = serde_json::from_value(batch()).unwrap();
    let mut session = Session::make(&make, &Limits::default(), 1).unwrap();
    let seeds: Reset = serde_json::from_value(reset()).unwrap();
    let mut replies =
        vec![rmp_serde::to_vec_named(&(1, "ok", session.reset(&seeds).unwrap())).unwrap()];
    for id in 2..=STEPS {
        let stepped = session.step(&[action(id); 2 * ENVS]).unwrap();
        replies.push(rmp_serde::to_vec_named(&(id, "ok", stepped)).unwrap());
    }
    replies
}

#[tokio::test]
async fn a_session_that_loses_connections_goes_on_bit_for_bit() {
    let running = Running::start(&[]).await;
    let (mut client, made) = running.play(batch()).await;
    let mut replies = vec![client.ask("reset", reset()).await];
    for id in 2..=STEPS {
        if id % 7 == 0 {
            // The connection breaks before the request, or after it, whose reply is lost.
            if id % 2 == 0 {
                client.send(request(id)).await;
            }
            drop(client);
            client = running.connect().await;
            let resumed = client.resume(&made.key).await.unwrap();
            assert!(resumed.last == id || resumed.last == id - 1, "{resumed:?}");
            assert_eq!(resumed.session, made.session);
        }
        replies.push(client.ask_as(id, "step", actions(ENVS, action(id))).await);
    }
    assert!(replies == alone());
    running.ended().await;
}

fn request(id: u64) -> tokio_tungstenite::tungstenite::Message {
    let bytes = rmp_serde::to_vec_named(&(id, "step", actions(ENVS, action(id)))).unwrap();
    tokio_tungstenite::tungstenite::Message::Binary(bytes.into())
}

#[tokio::test]
async fn a_request_sent_again_is_executed_once() {
    let running = Running::start(&[]).await;
    let (mut client, _) = running.play(reach()).await;
    client.ask("reset", json!({"seeds": [5]})).await;
    let first = client.step(1, 0.3).await;
    for _ in 0..3 {
        // Also with another content: the id decides.
        assert_eq!(client.ask_as(2, "step", actions(1, -0.9)).await, first);
        assert_eq!(client.ask_as(2, "close", json!({})).await, first);
    }
    let hash = client.hash().await;
    for id in [0, 1, 2, 5, u64::MAX] {
        let refused = fault(&client.ask_as(id, "step", actions(1, 0.3)).await);
        assert_eq!(refused.kind, "ProtocolError");
        assert_eq!(refused.message, format!("id = {id}: expected 4"));
    }
    assert_eq!(client.hash().await, hash);
    running.ended().await;
}

#[tokio::test]
async fn a_request_of_a_client_that_is_gone_is_executed() {
    let running = Running::start(&[]).await;
    let grasp = json!({"env": "BabbleGrasp-v0", "num_envs": 8});
    let (mut client, made) = running.play(grasp).await;
    client.id += 1;
    let bytes = rmp_serde::to_vec_named(&(1, "reset", json!({}))).unwrap();
    client
        .send(tokio_tungstenite::tungstenite::Message::Binary(
            bytes.into(),
        ))
        .await;
    // Before the reply: the work goes on without the connection, and resuming waits for it.
    let mut again = running.connect().await;
    let resumed = again.resume(&made.key).await.unwrap();
    if resumed.last == 0 {
        // The message had not been read.
        again.ask("reset", json!({})).await;
    }
    let reply = again.ask_as(1, "reset", json!({})).await;
    read::<Anything>(&reply).1.unwrap();
    running.ended().await;
}

#[tokio::test]
async fn a_session_is_resumed_while_a_half_open_connection_holds_it() {
    let running = Running::start(&[]).await;
    let (mut old, made) = running.play(reach()).await;
    old.ask("reset", json!({})).await;
    let mut new = running.connect().await;
    assert_eq!(new.resume(&made.key).await.unwrap().last, 1);
    // The old one is told, if it is there.
    assert_eq!(old.closed().await, Some(1000));
    new.id = 1;
    read::<Anything>(&new.step(1, 0.0).await).1.unwrap();
    running.has_sessions(1).await;
    running.ended().await;
}

#[tokio::test]
async fn keys_open_their_own_session_alone() {
    let running = Running::start(&[]).await;
    let (_one, made) = running.play(reach()).await;
    let (_two, other) = running.play(reach()).await;
    assert_ne!(made.key, other.key);
    let secret = made.key.split_once('-').unwrap().1;
    assert_eq!(secret.len(), 64);
    let mut client = running.connect().await;
    for wrong in [
        made.session.clone(),
        format!("{}-", made.session),
        format!("{}-{secret}", other.session),
        format!("{}0", made.key),
        made.key[..made.key.len() - 1].to_owned(),
        "-".to_owned(),
        "é-\0".to_owned(),
    ] {
        let refused = client.resume(&wrong).await.unwrap_err();
        assert_eq!(refused.kind, "SessionError", "{wrong}");
    }
    client.resume(&made.key).await.unwrap();
    running.ended().await;
}

#[tokio::test]
async fn a_closed_session_is_freed_at_once_and_a_lost_one_in_time() {
    let running = Running::start(&["--resume-seconds", "0.2"]).await;
    let (mut client, made) = running.play(reach()).await;
    read::<Anything>(&client.ask("close", json!({})).await)
        .1
        .unwrap();
    assert_eq!(client.closed().await, Some(1000));
    running.has_sessions(0).await;
    assert_eq!(
        running
            .connect()
            .await
            .resume(&made.key)
            .await
            .unwrap_err()
            .kind,
        "SessionError"
    );
    let (client, made) = running.play(reach()).await;
    drop(client);
    running.has_sessions(0).await;
    assert_eq!(
        running
            .connect()
            .await
            .resume(&made.key)
            .await
            .unwrap_err()
            .kind,
        "SessionError"
    );
    let text = running.server.metrics.text((0, 0));
    assert!(
        text.contains("sessions_ended_total{reason=\"closed\"} 1"),
        "{text}"
    );
    assert!(
        text.contains("sessions_ended_total{reason=\"not resumed in time\"} 1"),
        "{text}"
    );
    running.ended().await;
}

#[tokio::test]
async fn idle_sessions_and_half_open_connections_are_found() {
    let running = Running::start(&["--idle-seconds", "0.3"]).await;
    let (mut client, _) = running.play(reach()).await;
    assert_eq!(client.closed().await, Some(1000));
    running.has_sessions(0).await;
    running.ended().await;
    // This client reads nothing, so it answers no ping.
    let running = Running::start(&["--ping-seconds", "0.1", "--resume-seconds", "0.1"]).await;
    let (client, _) = running.play(reach()).await;
    running.has_sessions(0).await;
    drop(client);
    running.ended().await;
}

#[tokio::test]
async fn pings_are_answered_during_long_work() {
    use tokio_tungstenite::tungstenite::Message;
    let running = Running::start(&[]).await;
    let (mut client, _) = running
        .play(json!({"env": "BabbleGrasp-v0", "num_envs": 64, "threads": 1}))
        .await;
    let bytes = rmp_serde::to_vec_named(&(1, "reset", json!({}))).unwrap();
    client.send(Message::Binary(bytes.into())).await;
    client.send(Message::Ping("still there?".into())).await;
    let first = within(futures_util::StreamExt::next(&mut client.socket)).await;
    assert!(matches!(first, Some(Ok(Message::Pong(_)))), "{first:?}");
    read::<Anything>(&client.reply().await).1.unwrap();
    running.ended().await;
}

#[tokio::test]
async fn a_stopping_server_ends_what_runs_and_begins_nothing() {
    let mut running = Running::start(&[]).await;
    let (mut client, _) = running
        .play(json!({"env": "BabbleGrasp-v0", "num_envs": 16}))
        .await;
    let (mut quiet, _) = running.play(reach()).await;
    let mut lobby = running.connect().await;
    let bytes = rmp_serde::to_vec_named(&(1, "reset", json!({}))).unwrap();
    client
        .send(tokio_tungstenite::tungstenite::Message::Binary(
            bytes.into(),
        ))
        .await;
    // Until the server has begun with it.
    tokio::time::sleep(Duration::from_millis(20)).await;
    running.drain();
    read::<Anything>(&client.reply().await).1.unwrap();
    for client in [&mut client, &mut quiet, &mut lobby] {
        assert_eq!(client.closed().await, Some(1001));
    }
    let address = running.address;
    running.ended().await;
    assert!(tokio::net::TcpStream::connect(address).await.is_err());
}
