//! Each limit is kept, says its name and number, and harms no other client.

mod serving;

use std::io::Write;
use std::time::{Duration, Instant};

use futures_util::SinkExt;
use serde_json::{Value, json};
use serving::{Anything, Client, Fault, PATIENCE, Running, fault, reach, read, request, within};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::{Error, Message};

async fn refused(running: &Running, make: Value) -> Fault {
    let refused = running.connect().await.make(make).await.unwrap_err();
    assert_eq!(refused.kind, "LimitError", "{refused:?}");
    refused
}

fn envs(n: usize) -> Value {
    json!({"env": "BabbleReach-v0", "num_envs": n})
}

#[tokio::test]
async fn sessions_and_environments_are_counted() {
    let running = Running::start(&[
        "--sessions",
        "4",
        "--sessions-per-client",
        "3",
        "--envs-per-session",
        "5",
        "--envs",
        "8",
    ])
    .await;
    let over = refused(&running, envs(6)).await;
    assert_eq!(over.message, "num_envs = 6: this server allows at most 5");
    let first = running.play(envs(5)).await;
    let over = refused(&running, envs(4)).await;
    assert_eq!(
        over.message,
        "environments of all sessions = 9: this server allows at most 8"
    );
    let others = (running.play(envs(1)).await, running.play(envs(1)).await);
    let over = refused(&running, envs(1)).await;
    assert_eq!(
        over.message,
        "sessions of your address = 4: this server allows at most 3"
    );
    // What is refused takes nothing, and what ends gives back.
    let (mut client, _) = first;
    client.ask("close", json!({})).await;
    running.has_sessions(2).await;
    running.play(envs(5)).await;
    drop(others);
    running.ended().await;
    let running = Running::start(&["--sessions", "1"]).await;
    let _one = running.play(reach()).await;
    let over = refused(&running, reach()).await;
    assert_eq!(over.message, "sessions = 2: this server allows at most 1");
    running.ended().await;
}

#[tokio::test]
async fn sessions_begin_at_a_bounded_rate() {
    let running = Running::start(&["--sessions-per-second", "1"]).await;
    let mut client = running.connect().await;
    let mut refusals = 0;
    // Two at once; then a server that is slow may allow one more for each second.
    let began = Instant::now();
    for _ in 0..5 {
        match client.make(reach()).await {
            Ok(_) => client = running.connect().await,
            Err(refused) => {
                assert!(
                    refused.message.contains("new sessions a second"),
                    "{refused:?}"
                );
                refusals += 1;
            }
        }
    }
    assert!(refusals + 2 + began.elapsed().as_secs() >= 5);
    while client.make(reach()).await.is_err() {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    running.ended().await;
}

#[tokio::test]
async fn sessions_share_the_threads_and_their_results_do_not_depend_on_them() {
    let running = Running::start(&["--threads", "3", "--threads-per-session", "2"]).await;
    let make = json!({"env": "BabbleGrasp-v0", "num_envs": 4, "threads": 9});
    let mut replies = Vec::new();
    let mut clients = Vec::new();
    for _ in 0..3 {
        let (mut client, _) = running.play(make.clone()).await;
        replies.push(client.ask("reset", json!({"seeds": [1, 2, 3, 4]})).await);
        clients.push(client);
    }
    assert!(replies.iter().all(|reply| *reply == replies[0]));
    running.ended().await;
}

#[tokio::test]
async fn observations_pictures_and_computing_time_are_bounded() {
    let options = ["--picture-pixels", "100", "--request-seconds", "0.01"];
    let running = Running::start(&options).await;
    let mut large = reach();
    large["options"] = json!({"obs": "retina", "retina_size": 84});
    large["num_envs"] = json!(1_000);
    let over = refused(&running, large).await;
    assert!(over.message.contains("at most 16777216"), "{over:?}");
    let (mut client, _) = running.play(reach()).await;
    client.ask("reset", json!({})).await;
    let hash = client.hash().await;
    let cases = json!({"protocol": "table1", "n": 4_096});
    let late = fault(&client.ask("scenarios", cases).await);
    assert_eq!(late.kind, "LimitError");
    assert!(late.message.contains("took longer"), "{late:?}");
    let picture = json!({"env": 0, "camera": "eye", "width": 10, "height": 11});
    let over = fault(&client.ask("render", picture).await);
    assert_eq!(
        over.message,
        "width × height = 110: this server allows at most 100"
    );
    assert_eq!(client.hash().await, hash);
    read::<Anything>(&client.step(1, 0.5).await).1.unwrap();
    running.ended().await;
}

#[tokio::test]
async fn a_client_that_never_reads_is_dropped_and_holds_up_nobody() {
    let running = Running::start(&["--ping-seconds", "0.2", "--resume-seconds", "0.1"]).await;
    let make = json!({"env": "BabbleReach-v0", "num_envs": 256, "options": {"obs": "retina"}});
    let (mut client, _) = running.play(make).await;
    // Replies of 5 MB each, which nobody reads: only one is on its way.
    for id in 1..50 {
        let bytes = rmp_serde::to_vec_named(&(id, "reset", json!({}))).unwrap();
        let sent = client.socket.send(Message::Binary(bytes.into()));
        if !matches!(timeout(Duration::from_millis(100), sent).await, Ok(Ok(()))) {
            break;
        }
    }
    let (mut other, _) = running.play(reach()).await;
    read::<Anything>(&other.ask("reset", json!({})).await)
        .1
        .unwrap();
    other.ask("close", json!({})).await;
    running.has_sessions(0).await;
    running.ended().await;
}

/// The system ends such a connection, where it can.
#[cfg(target_os = "linux")]
#[tokio::test]
async fn a_reader_of_pages_that_never_reads_is_dropped() {
    let running = Running::start(&["--ping-seconds", "0.2"]).await;
    let free = running.server.connections.available_permits();
    let mut stream = TcpStream::connect(running.address).await.unwrap();
    // Requests until the server has no more room for replies, and then none for requests.
    let began = Instant::now();
    let page = b"GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n".repeat(100);
    loop {
        assert!(began.elapsed() < PATIENCE, "the connection goes on");
        let written = timeout(Duration::from_millis(100), stream.write_all(&page)).await;
        if let Ok(Err(_reset)) = written {
            break;
        }
    }
    // The listener holds one for the next client.
    while running.server.connections.available_permits() + 1 < free {
        assert!(began.elapsed() < PATIENCE, "its place is kept");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    running.ended().await;
}

#[tokio::test]
async fn what_cannot_be_interrupted_is_short() {
    let running = Running::start(&[]).await;
    let slow = json!({"control_period_s": 0.001, "physics_steps": 1_000});
    for (make, says) in [
        (
            json!({"env": "BabbleReachPattern-v0", "config": {"reach": slow}}),
            "physics steps of one step = ",
        ),
        (
            json!({
                "env": "BabbleGrasp-v0",
                "config": {"body": {"engine": "rapier"}},
                "options": {"max_episode_steps": 1_001},
            }),
            "physics steps that loading a state repeats = 10010",
        ),
    ] {
        let over = refused(&running, make).await;
        assert!(over.message.contains(says), "{over:?}");
    }
    running.has_sessions(0).await;
    running.ended().await;
}

/// What the server answers to bytes before it closes the connection.
async fn answer(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    // A reset is an end, too.
    let _ = within(stream.read_to_end(&mut bytes)).await;
    String::from_utf8_lossy(&bytes).into_owned()
}

#[tokio::test]
async fn slow_handshakes_are_ended() {
    let running = Running::start(&["--handshake-seconds", "0.2"]).await;
    // Nothing, half a head, and a head that drips in.
    for head in ["", "GET / HTTP/1.1\r\nHost: localhost\r\n"] {
        let mut stream = TcpStream::connect(running.address).await.unwrap();
        stream.write_all(head.as_bytes()).await.unwrap();
        let answered = answer(&mut stream).await;
        assert!(!answered.contains("200 OK"), "{answered}");
    }
    let mut stream = TcpStream::connect(running.address).await.unwrap();
    let began = Instant::now();
    while stream.write_all(b"G").await.is_ok() {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    // A WebSocket that asks for nothing.
    let mut client = running.connect().await;
    assert_eq!(client.closed().await, Some(1000));
    running.ended().await;
}

async fn get(running: &Running, path: &str, headers: &str) -> String {
    let mut stream = TcpStream::connect(running.address).await.unwrap();
    let head = format!("GET {path} HTTP/1.1\r\nConnection: close\r\n{headers}\r\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    answer(&mut stream).await
}

#[tokio::test]
async fn the_status_page_names_the_environment_that_is_played() {
    let running = Running::start(&[]).await;
    let url = format!("ws://{}/ws", running.address);
    let mut client = Client::connect_with(running.address, url.into_client_request().unwrap())
        .await
        .unwrap();
    for env in ["BabbleReach-v0", "BabbleGrasp-v0"] {
        let reset = json!({"type": "reset", "data": {"env": env}});
        client.send(Message::Text(reset.to_string().into())).await;
        let shown = client.next().await.unwrap().unwrap().into_text().unwrap();
        assert!(shown.contains("observation"), "{shown}");
        let page = get(&running, "/", "Host: localhost\r\n").await;
        assert!(page.contains(&format!("<td>{env}<td>1<td>")), "{page}");
    }
    running.ended().await;
}

#[tokio::test]
async fn long_heads_are_refused() {
    let running = Running::start(&[]).await;
    let head = format!("Host: localhost\r\nX: {}\r\n", "x".repeat(100_000));
    let answered = get(&running, "/", &head).await;
    assert!(!answered.contains("200 OK"), "{answered}");
    running.ended().await;
}

#[tokio::test]
async fn on_loopback_the_name_of_the_server_and_the_origin_of_a_page_are_checked() {
    let running = Running::start(&["--allow-origin", "https://lab.example.org"]).await;
    let host = format!("Host: {}\r\n", running.address);
    for (headers, status) in [
        (host.clone(), "200 OK"),
        ("Host: localhost\r\n".to_owned(), "200 OK"),
        (
            format!("{host}Origin: http://{}\r\n", running.address),
            "200 OK",
        ),
        (
            format!("{host}Origin: https://lab.example.org\r\n"),
            "200 OK",
        ),
        (
            format!("{host}Origin: https://example.org\r\n"),
            "403 Forbidden",
        ),
        (format!("{host}Origin: null\r\n"), "403 Forbidden"),
        ("Host: lab.example.org\r\n".to_owned(), "403 Forbidden"),
        (String::new(), "403 Forbidden"),
    ] {
        for path in ["/", "/metrics"] {
            let answered = get(&running, path, &headers).await;
            assert!(
                answered.starts_with(&format!("HTTP/1.1 {status}")),
                "{headers}: {answered}"
            );
        }
    }
    for (origin, is_let_in) in [
        ("https://example.org", false),
        ("https://lab.example.org", true),
    ] {
        let mut page = request(running.address);
        page.headers_mut()
            .insert("origin", HeaderValue::from_static(origin));
        let connected = Client::connect_with(running.address, page).await;
        assert_eq!(connected.is_ok(), is_let_in, "{origin}");
    }
    running.ended().await;
}

#[tokio::test]
async fn with_a_token_every_request_needs_it() {
    let mut file = tempfile();
    writeln!(file.1, "0123456789abcdef-token").unwrap();
    let running = Running::start(&["--host", "0.0.0.0", "--token-file", &file.0]).await;
    let address = std::net::SocketAddr::from(([127, 0, 0, 1], running.address.port()));
    for (header, is_let_in) in [
        (None, false),
        (Some("Bearer 0123456789abcdef-toke"), false),
        (Some("Bearer 0123456789abcdef-token"), true),
    ] {
        let mut with = request(address);
        if let Some(header) = header {
            with.headers_mut()
                .insert("authorization", HeaderValue::from_static(header));
        }
        match Client::connect_with(address, with).await {
            Ok(mut client) => {
                client.make(reach()).await.unwrap();
                assert!(is_let_in);
            }
            Err(Error::Http(response)) => {
                assert_eq!((response.status().as_u16(), is_let_in), (401, false));
            }
            Err(other) => panic!("{other}"),
        }
        let header = header.map_or(String::new(), |header| {
            format!("Authorization: {header}\r\n")
        });
        // From another machine, by any name.
        let page = get(&running, "/", &format!("Host: lab.example.org\r\n{header}")).await;
        assert_eq!(page.starts_with("HTTP/1.1 200"), is_let_in, "{page}");
    }
    running.ended().await;
    std::fs::remove_file(&file.0).unwrap();
}

#[tokio::test]
async fn other_addresses_need_a_good_token() {
    use babble_server::options::Cli;
    use babble_server::serve::Listening;
    use clap::Parser;
    let mut file = tempfile();
    write!(file.1, "short").unwrap();
    for (options, says) in [
        (
            vec!["--host", "0.0.0.0"],
            "needs an access token in GYM_BABBLE_TOKEN or --token-file",
        ),
        (vec!["--host", "::", "--port", "0"], "needs an access token"),
        (
            vec!["--token-file", &file.0],
            "the access token has 5 characters",
        ),
        (vec!["--token-file", "/no/such/file"], "/no/such/file"),
    ] {
        let cli = Cli::parse_from(std::iter::once("gym-babble-server").chain(options));
        let error = Listening::bind(cli.options).await.unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    std::fs::remove_file(&file.0).unwrap();
}

/// Name of a new file, and the file.
fn tempfile() -> (String, std::fs::File) {
    let name = format!(
        "gym-babble-{}-{:?}",
        std::process::id(),
        std::thread::current().id()
    );
    let path = std::env::temp_dir().join(name.replace(['(', ')'], ""));
    (
        path.to_str().unwrap().to_owned(),
        std::fs::File::create(path).unwrap(),
    )
}

#[tokio::test]
async fn everything_ends_and_is_given_back() {
    let running = Running::start(&["--resume-seconds", "0.1"]).await;
    let free = running.server.connections.available_permits();
    for _ in 0..50 {
        let (mut client, _) = running.play(reach()).await;
        client.ask("reset", json!({})).await;
    }
    running.has_sessions(0).await;
    let began = Instant::now();
    // The listener holds one for the next client.
    while running.server.connections.available_permits() + 1 < free {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    running.ended().await;
}
