//! Who may come in: the access token, the origin of a page, and the name that the server is called by.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{HOST, HeaderValue, ORIGIN, WWW_AUTHENTICATE};
use axum::http::uri::Authority;
use axum::http::{HeaderName, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tokio::time::timeout;

use crate::server::Server;

/// The one path that needs no token: whoever starts servers asks it whether they live.
const HEALTH: &str = "/health";

/// Lets a request in, or says why not.
pub(crate) async fn check(
    State(server): State<Arc<Server>>,
    request: Request,
    next: Next,
) -> Response {
    if let Err((status, message)) = allowed(&server, &request) {
        server.metrics.refused(message);
        tracing::info!(path = request.uri().path(), message, "refused");
        let challenge = (WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        return match status {
            StatusCode::UNAUTHORIZED => (status, [challenge], format!("{message}\n")),
            _ => (status, [NO_SNIFF], format!("{message}\n")),
        }
        .into_response();
    }
    let limits = server.limits();
    let longest = limits.request_time + limits.handshake_time;
    let Ok(mut response) = timeout(longest, next.run(request)).await else {
        return (StatusCode::REQUEST_TIMEOUT, "the request took too long\n").into_response();
    };
    let headers = response.headers_mut();
    for (name, value) in [NO_SNIFF, NO_REFERRER, NO_STORE] {
        headers.insert(name, value);
    }
    response
}

type Header = (HeaderName, HeaderValue);
const NO_SNIFF: Header = (
    axum::http::header::X_CONTENT_TYPE_OPTIONS,
    HeaderValue::from_static("nosniff"),
);
const NO_REFERRER: Header = (
    axum::http::header::REFERRER_POLICY,
    HeaderValue::from_static("no-referrer"),
);
const NO_STORE: Header = (
    axum::http::header::CACHE_CONTROL,
    HeaderValue::from_static("no-store"),
);

fn allowed(server: &Server, request: &Request) -> Result<(), (StatusCode, &'static str)> {
    if request.uri().path() == HEALTH {
        return Ok(());
    }
    let headers = request.headers();
    let host = headers.get(HOST).and_then(|host| host.to_str().ok());
    if let Some(token) = &server.token {
        if !token.is_in(headers) {
            let message = "this server needs its access token in the header Authorization: Bearer";
            return Err((StatusCode::UNAUTHORIZED, message));
        }
    } else if !host.is_some_and(is_loopback) {
        let message = "the header Host names another machine than this one";
        return Err((StatusCode::FORBIDDEN, message));
    }
    match headers.get(ORIGIN) {
        Some(origin) if !is_allowed(origin, host, &server.options.allow_origin) => {
            let message =
                "pages of this Origin may not connect; start the server with --allow-origin";
            Err((StatusCode::FORBIDDEN, message))
        }
        _ => Ok(()),
    }
}

/// A page of another machine can have its name point here, but not change what browsers call it.
fn is_loopback(host: &str) -> bool {
    let Ok(authority) = host.parse::<Authority>() else {
        return false;
    };
    let name = authority.host().trim_matches(['[', ']']);
    name.eq_ignore_ascii_case("localhost")
        || name
            .parse::<IpAddr>()
            .is_ok_and(|address| address.is_loopback())
}

fn is_allowed(origin: &HeaderValue, host: Option<&str>, allowed: &[String]) -> bool {
    let Ok(origin) = origin.to_str() else {
        return false;
    };
    let authority = origin.split_once("://").map(|(_, rest)| rest);
    let is_own = authority.is_some() && authority == host;
    is_own
        || allowed
            .iter()
            .any(|other| origin.eq_ignore_ascii_case(other))
}

#[cfg(test)]
mod tests {
    use crate::gate::{is_allowed, is_loopback};
    use crate::token::origin;
    use axum::http::HeaderValue;

    #[test]
    fn only_names_of_this_machine_are_loopback() {
        for host in [
            "localhost",
            "LOCALHOST:1",
            "127.0.0.1:8741",
            "127.9.9.9",
            "[::1]:80",
            "[::1]",
        ] {
            assert!(is_loopback(host), "{host}");
        }
        for host in [
            "",
            "example.org",
            "localhost.example.org",
            "10.0.0.1:8741",
            "127.0.0.1.example.org",
            "::1",
        ] {
            assert!(!is_loopback(host), "{host}");
        }
    }

    #[test]
    fn pages_of_the_server_and_of_allowed_origins_may_connect() {
        let allowed = [origin("https://Example.org:8443").unwrap()];
        let host = Some("localhost:8741");
        for (page, expected) in [
            ("http://localhost:8741", true),
            ("https://localhost:8741", true),
            ("https://example.org:8443", true),
            ("https://example.org", false),
            ("http://localhost:80", false),
            ("localhost:8741", false),
            ("null", false),
            ("", false),
        ] {
            let header = HeaderValue::from_static(page);
            assert_eq!(is_allowed(&header, host, &allowed), expected, "{page}");
        }
        assert!(!is_allowed(&HeaderValue::from_static("null"), None, &[]));
    }
}
