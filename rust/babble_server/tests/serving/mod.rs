//! A server in the test's process, and a client of the binary protocol.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part")]

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use babble_server::options::Cli;
use babble_server::serve::Listening;
use babble_server::server::Server;
use clap::Parser;
use futures_util::{SinkExt, StreamExt};
use rmp_serde::{from_slice, to_vec_named};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::handshake::client::Request;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{self, Message};
use tokio_tungstenite::{WebSocketStream, client_async_with_config};

/// Longest wait for what has to happen.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A running server.
pub struct Running {
    pub address: SocketAddr,
    pub server: Arc<Server>,
    stop: Option<oneshot::Sender<()>>,
    serving: JoinHandle<()>,
}

impl Running {
    /// Starts one with options of the command line.
    pub async fn start(options: &[&str]) -> Self {
        let name = ["gym-babble-server", "--port", "0"];
        let cli = Cli::parse_from(name.iter().chain(options));
        let listening = Listening::bind(cli.options).await.unwrap();
        let (stop, stopped) = oneshot::channel();
        Self {
            address: listening.address().unwrap(),
            server: Arc::clone(listening.server()),
            stop: Some(stop),
            serving: tokio::spawn(listening.serve(async {
                let _ = stopped.await;
            })),
        }
    }

    /// Begins to stop it.
    pub fn drain(&mut self) {
        let _ = self.stop.take().unwrap().send(());
    }

    /// Waits until it has stopped.
    pub async fn ended(mut self) {
        if self.stop.is_some() {
            self.drain();
        }
        within(self.serving).await.unwrap();
    }

    /// Waits until it has so many sessions.
    pub async fn has_sessions(&self, expected: usize) {
        let began = Instant::now();
        while self.server.admissions.counts().0 != expected {
            assert!(began.elapsed() < PATIENCE, "{:?}", self.server.admissions);
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }

    pub async fn connect(&self) -> Client {
        Client::connect(self.address).await
    }

    /// A client with a session of its own.
    pub async fn play(&self, make: Value) -> (Client, Made) {
        let mut client = self.connect().await;
        let made = client.make(make).await.unwrap();
        (client, made)
    }
}

/// What has to happen soon.
pub async fn within<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, future)
        .await
        .expect("in time")
}

/// The parts of a reply to `make` that tests look at.
#[derive(Debug, Clone, Deserialize)]
pub struct Made {
    pub session: String,
    pub key: String,
    pub last: u64,
}

/// An error as a client gets it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Fault {
    pub kind: String,
    pub message: String,
}

#[derive(Debug, Deserialize)]
struct Hash {
    hash: u64,
}

/// A client of the binary protocol.
pub struct Client {
    pub socket: WebSocketStream<TcpStream>,
    /// Id of the last request.
    pub id: u64,
}

/// A request to connect, with the subprotocol.
pub fn request(address: SocketAddr) -> Request {
    let mut request = format!("ws://{address}/ws").into_client_request().unwrap();
    let protocol = HeaderValue::from_static("gym-babble.v1");
    request
        .headers_mut()
        .insert("sec-websocket-protocol", protocol);
    request
}

impl Client {
    pub async fn connect(address: SocketAddr) -> Self {
        Self::connect_with(address, request(address)).await.unwrap()
    }

    pub async fn connect_with(
        address: SocketAddr,
        request: Request,
    ) -> Result<Self, tungstenite::Error> {
        let stream = TcpStream::connect(address).await.unwrap();
        stream.set_nodelay(true).unwrap();
        let config = WebSocketConfig::default()
            .max_message_size(None)
            .max_frame_size(None);
        let (socket, _) = within(client_async_with_config(request, stream, Some(config))).await?;
        Ok(Self { socket, id: 0 })
    }

    pub async fn send(&mut self, message: Message) {
        within(self.socket.send(message)).await.unwrap();
    }

    /// The next message but pings.
    pub async fn next(&mut self) -> Option<Result<Message, tungstenite::Error>> {
        loop {
            match within(self.socket.next()).await {
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                other => return other,
            }
        }
    }

    /// The next reply as bytes.
    pub async fn reply(&mut self) -> Vec<u8> {
        match self.next().await {
            Some(Ok(Message::Binary(bytes))) => bytes.to_vec(),
            other => panic!("{other:?}"),
        }
    }

    /// Code with which the server closes, or none if the connection just ends.
    pub async fn closed(&mut self) -> Option<u16> {
        loop {
            match self.next().await {
                Some(Ok(Message::Close(frame))) => return frame.map(|frame| frame.code.into()),
                Some(Ok(_)) => {}
                Some(Err(_)) | None => return None,
            }
        }
    }

    /// The reply to bytes.
    pub async fn exchange(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        self.send(Message::Binary(bytes.into())).await;
        self.reply().await
    }

    /// The reply to a request with an id, as bytes.
    pub async fn ask_as(&mut self, id: u64, operation: &str, body: impl Serialize) -> Vec<u8> {
        self.exchange(to_vec_named(&(id, operation, body)).unwrap())
            .await
    }

    /// The reply to the next request, as bytes.
    pub async fn ask(&mut self, operation: &str, body: impl Serialize) -> Vec<u8> {
        self.id += 1;
        self.ask_as(self.id, operation, body).await
    }

    pub async fn make(&mut self, make: Value) -> Result<Made, Fault> {
        read(&self.ask_as(0, "make", make).await).1
    }

    pub async fn resume(&mut self, key: &str) -> Result<Made, Fault> {
        read(&self.ask_as(0, "resume", json!({"key": key})).await).1
    }

    /// Steps all environments with the same number for each action.
    pub async fn step(&mut self, envs: usize, action: f32) -> Vec<u8> {
        self.ask("step", actions(envs, action)).await
    }

    pub async fn hash(&mut self) -> u64 {
        let reply = self.ask("hash", json!({"env": 0})).await;
        read::<Hash>(&reply).1.unwrap().hash
    }
}

/// Body of a step in reaching, whose actions are two numbers.
pub fn actions(envs: usize, action: f32) -> impl Serialize {
    #[derive(Serialize)]
    struct Step {
        #[serde(with = "serde_bytes")]
        actions: Vec<u8>,
    }
    Step {
        actions: action.to_le_bytes().repeat(2 * envs),
    }
}

/// Id and body of a reply.
pub fn read<T: DeserializeOwned>(reply: &[u8]) -> (Option<u64>, Result<T, Fault>) {
    if let Ok((id, status, fault)) = from_slice::<(Option<u64>, String, Fault)>(reply) {
        assert_eq!(status, "error");
        return (id, Err(fault));
    }
    let (id, status, body) = from_slice::<(Option<u64>, String, T)>(reply).unwrap();
    assert_eq!(status, "ok");
    (id, Ok(body))
}

/// Whatever the body of a reply is, if it is no error.
#[derive(Debug, Deserialize)]
pub struct Anything {}

/// The error in a reply.
pub fn fault(reply: &[u8]) -> Fault {
    read::<Anything>(reply).1.unwrap_err()
}

/// The smallest session.
pub fn reach() -> Value {
    json!({"env": "BabbleReach-v0"})
}
