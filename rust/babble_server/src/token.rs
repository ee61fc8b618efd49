//! The access token, and the origins whose pages may connect.

use std::fmt;
use std::io;
use std::net::IpAddr;
use std::path::Path;

use axum::http::HeaderMap;
use axum::http::header::AUTHORIZATION;
use axum::http::uri::Authority;
use subtle::ConstantTimeEq;

/// Environment variable with the access token.
const TOKEN_VARIABLE: &str = "GYM_BABBLE_TOKEN";
const TOKEN_LENGTH: usize = 16;

/// A secret that clients show.
#[derive(Clone)]
pub struct Token(String);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    /// The token from a file or the environment, if any.
    ///
    /// # Errors
    /// A file that cannot be read, a token that is too short or cannot stand in a header, or none for an
    /// address that other machines reach.
    pub fn given(file: Option<&Path>, host: IpAddr) -> io::Result<Option<Self>> {
        let invalid = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
        let given = match file {
            Some(path) => Some(std::fs::read_to_string(path).map_err(|error| {
                io::Error::new(error.kind(), format!("{}: {error}", path.display()))
            })?),
            None => std::env::var(TOKEN_VARIABLE).ok(),
        };
        let Some(given) = given else {
            if host.is_loopback() {
                return Ok(None);
            }
            return Err(invalid(format!(
                "host = {host}: other machines reach this address, so it needs an access token in \
                 {TOKEN_VARIABLE} or --token-file"
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

    /// Whether a request shows it; how long the answer takes says nothing of the token but its length.
    pub(crate) fn is_in(&self, headers: &HeaderMap) -> bool {
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

#[cfg(test)]
mod tests {
    use crate::token::{Token, origin};
    use axum::http::header::AUTHORIZATION;
    use axum::http::{HeaderMap, HeaderValue};

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

    #[test]
    fn a_request_shows_the_whole_token_as_bearer() {
        let token = Token("0123456789abcdef".to_owned());
        for (header, expected) in [
            ("Bearer 0123456789abcdef", true),
            ("bearer  0123456789abcdef ", true),
            ("Bearer 0123456789abcde", false),
            ("Bearer 0123456789abcdef0", false),
            ("Bearer 0123456789abcdeF", false),
            ("Basic 0123456789abcdef", false),
            ("0123456789abcdef", false),
            ("Bearer", false),
            ("", false),
        ] {
            let mut headers = HeaderMap::new();
            headers.insert(AUTHORIZATION, HeaderValue::from_static(header));
            assert_eq!(token.is_in(&headers), expected, "{header}");
        }
        assert!(!token.is_in(&HeaderMap::new()));
        assert!(!format!("{token:?}").contains("0123"));
    }
}
