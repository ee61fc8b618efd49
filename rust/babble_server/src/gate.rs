//! Who may come in: the access token, the origin of a page, and the name that the server is called by.

use std::fmt;
use std::io;
use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, HOST, HeaderValue, ORIGIN, WWW_AUTHENTICATE};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use subtle::ConstantTimeEq;
use tokio::time::timeout;

use crate::options::Options;
use crate::server::Server;

/// Environment variable with the access token.
const TOKEN_VARIABLE: &str = "GYM_BABBLE_TOKEN";
const TOKEN_LENGTH: usize = 16;
/// The one path that needs no token: whoever starts servers asks it whether they live.
const HEALTH: &str = "/health";

/// A secret that clients show.
#[derive(Clone)]
pub struct Token(String);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    /// The token that the program was given, if any.
    ///
    /// # Errors
    /// A file that cannot be read, a token that is too short or cannot stand in a header, or none for an
    /// address that other machines reach.
    pub fn given(options: &Options) -> io::Result<Option<Self>> {
        let invalid = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
        let given = match &options.token_file {
            Some(path) => Some(std::fs::read_to_string(path).map_err(|error| {
                io::Error::new(error.kind(), format!("{}: {error}", path.display()))
            })?),
            None => std::env::var(TOKEN_VARIABLE).ok(),
        };
        let Some(given) = given else {
            if options.host.is_loopback() {
                return Ok(None);
            }
            return Err(invalid(format!(
                "host = {}: other machines reach this address, so it needs an access token in \
                 {TOKEN_VARIABLE} or --token-file",
                options.host
            )));
        };
        let token = given.trim();
        if token.len() < TOKEN_LENGTH || !token.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(invalid(format!(
                "the access token has {} characters: expected at least {TOKEN_LENGTH}, printable \
                 ASCII without spaces",
                token.chars().count()
            )));
        }
        Ok(Some(Self(token.to_owned())))
    }

    fn is_in(&self, headers: &HeaderMap) -> bool {
        let shown = headers
            .get(AUTHORIZATION)
            .and_then(|value| value.to_str().ok())
            .and_then(|value| value.split_once(' '))
            .filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"))
            .map_or("", |(_, token)| token.trim());
        self.0.as_bytes().ct_eq(shown.as_bytes()).into()
    }
}

/// Checks that an origin to allow is one.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn origin(text: &str) -> Result<String, String> {
    let authority = text.split_once("://").map(|(_, rest)| rest);
    match authority.and_then(|rest| rest.parse::<Authority>().ok()) {
        Some(authority) if !authority.as_str().contains('@') => Ok(text.to_ascii_lowercase()),
        _ => Err("expected scheme, host and port alone, as in https://example.org:8443".to_owned()),
    }
}

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
    use super::{is_allowed, is_loopback, origin};
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

    #[test]
    fn an_origin_has_no_path() {
        for wrong in [
            "example.org",
            "https://",
            "https://example.org/",
            "https://a@example.org",
            "null",
        ] {
            assert!(origin(wrong).is_err(), "{wrong}");
        }
    }
}
