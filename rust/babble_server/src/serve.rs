//! Listening, and stopping.

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{interval, sleep, timeout};
use tower::ServiceExt;

use crate::app;
use crate::connection::UNANSWERED;
use crate::options::Options;
use crate::server::{Peer, Server, told};

/// Bytes of the head of an HTTP request, and of what is read of a body at once.
const HEAD_BYTES: usize = 64 << 10;

/// A server that has its port.
#[derive(Debug)]
pub struct Listening {
    listener: TcpListener,
    server: Arc<Server>,
    app: Router,
}

impl Listening {
    /// Takes the port.
    ///
    /// # Errors
    /// An address that cannot be listened on, options that the served environment does not have; as
    /// [`Server::new`].
    pub async fn bind(options: Options) -> io::Result<Self> {
        let server = Arc::new(Server::new(options)?);
        let app = app::routes(Arc::clone(&server)).map_err(io::Error::other)?;
        let address = SocketAddr::new(server.options.host, server.options.port);
        let listener = TcpListener::bind(address).await.map_err(|error| {
            io::Error::new(error.kind(), format!("cannot listen on {address}: {error}"))
        })?;
        Ok(Self {
            listener,
            server,
            app,
        })
    }

    /// Address that clients connect to.
    ///
    /// # Errors
    /// The system does not say.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// What all connections share.
    #[must_use]
    pub const fn server(&self) -> &Arc<Server> {
        &self.server
    }

    /// Serves until `stop` ends, and then until the running requests are done.
    pub async fn serve(self, stop: impl Future<Output = ()>) {
        let Self {
            listener,
            server,
            app,
        } = self;
        let sampler = tokio::spawn(sample(Arc::clone(&server)));
        tokio::pin!(stop);
        loop {
            tokio::select! {
                accepted = accept(&listener, &server) => match accepted {
                    Ok((stream, peer)) => {
                        tokio::spawn(connect(stream, peer, app.clone(), Arc::clone(&server)));
                    }
                    // Out of descriptors, or a connection that broke at once: go on.
                    Err(error) => {
                        tracing::warn!(%error, "cannot accept a connection");
                        sleep(Duration::from_millis(50)).await;
                    }
                },
                () = &mut stop => break,
            }
        }
        drop(listener);
        sampler.abort();
        let (sessions, _) = server.admissions.counts();
        tracing::info!(sessions, "stopping");
        server.draining.send_replace(true);
        let drained = timeout(server.options.drain_time, server.drained()).await;
        tracing::info!(drained = drained.is_ok(), "stopped");
    }
}

/// Keeps the counters of each second, for the rates of the status page.
async fn sample(server: Arc<Server>) {
    let mut second = interval(Duration::from_secs(1));
    loop {
        second.tick().await;
        server.metrics.sample();
    }
}

async fn accept(listener: &TcpListener, server: &Server) -> io::Result<(TcpStream, Peer)> {
    let permit = Arc::clone(&server.connections).acquire_owned().await;
    let permit = permit.map_err(io::Error::other)?;
    let (stream, address) = listener.accept().await?;
    stream.set_nodelay(true)?;
    // A client that takes none of what is sent to it is dropped by the system, where it can.
    #[cfg(target_os = "linux")]
    socket2::SockRef::from(&stream)
        .set_tcp_user_timeout(Some(UNANSWERED * server.limits().ping_time))?;
    let peer = Peer {
        address: address.ip().to_canonical(),
        permit: Arc::new(permit),
    };
    Ok((stream, peer))
}

/// Serves one connection until it ends or becomes a WebSocket.
async fn connect(stream: TcpStream, peer: Peer, app: Router, server: Arc<Server>) {
    let service = service_fn(|request: hyper::Request<Incoming>| {
        let mut request = request.map(Body::new);
        request.extensions_mut().insert(peer.clone());
        let app = app.clone();
        async move {
            Ok::<_, Infallible>(
                app.oneshot(request)
                    .await
                    .unwrap_or_else(|never| match never {}),
            )
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .max_buf_size(HEAD_BYTES)
        .max_header_size(HEAD_BYTES)
        .header_read_timeout(server.limits().handshake_time)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    tokio::pin!(connection);
    let mut draining = server.draining.subscribe();
    let ended = tokio::select! {
        ended = &mut connection => ended,
        () = told(&mut draining, |&draining| draining) => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = ended {
        tracing::debug!(%error, "connection");
    }
}

/// Ends when the process gets SIGTERM or SIGINT.
pub(crate) fn asked_to_stop() -> io::Result<impl Future<Output = ()>> {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let (mut terminate, mut interrupt) = (
            signal(SignalKind::terminate())?,
            signal(SignalKind::interrupt())?,
        );
        Ok(async move {
            tokio::select! {
                _ = terminate.recv() => {}
                _ = interrupt.recv() => {}
            }
        })
    }
    #[cfg(not(unix))]
    Ok(async {
        // Without a handler there is no way to stop but to kill.
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    })
}
