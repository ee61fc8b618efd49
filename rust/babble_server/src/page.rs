//! The status page.

use std::fmt::{self, Write as _};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use axum::extract::State;
use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{Html, IntoResponse};

use crate::admission::Admitted;
use crate::metrics::Sample;
use crate::server::Server;

/// The page loads nothing but its style from this server, and stands in no frame.
const POLICY: &str = "default-src 'none'; style-src 'self'; frame-ancestors 'none'; \
                      base-uri 'none'; form-action 'none'";
/// Rows of the table; more are only counted.
const ROWS: usize = 200;

/// The style of the page.
pub(crate) async fn style() -> impl IntoResponse {
    ([(CONTENT_TYPE, "text/css")], include_str!("status.css"))
}

/// Sessions, rates and errors, as HTML that loads itself anew.
pub(crate) async fn status(State(server): State<Arc<Server>>) -> impl IntoResponse {
    let mut html = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut html, &server);
    ([(CONTENT_SECURITY_POLICY, POLICY)], Html(html))
}

fn write(html: &mut String, server: &Server) -> fmt::Result {
    let metrics = &server.metrics;
    let (now, recent) = (metrics.now(), metrics.ago(Duration::from_secs(10)));
    let (sessions, envs) = server.admissions.counts();
    let limits = server.limits();
    write!(
        html,
        "<!doctype html><html lang=en><meta charset=utf-8><meta http-equiv=refresh content=5>\
         <meta name=viewport content='width=device-width'><title>gym-babble server</title>\
         <link rel=stylesheet href=/status.css>\
         <h1>gym-babble server</h1><p>Version {}, up for {}. \
         <a href=/metrics>Metrics</a> for Prometheus.</p><dl>",
        env!("CARGO_PKG_VERSION"),
        Span(metrics.started.elapsed()),
    )?;
    let rate = |of: fn(&Sample) -> u64| {
        let seconds = now.at.duration_since(recent.at).as_secs_f64().max(1e-3);
        ((of(&now) - of(&recent)) as f64 / seconds).round() as u64
    };
    let entries = [
        (
            "Sessions",
            format!("{sessions} <small>of {}</small>", limits.sessions),
        ),
        (
            "Environments",
            format!(
                "{} <small>of {}</small>",
                Grouped(envs as u64),
                Grouped(limits.envs as u64)
            ),
        ),
        (
            "Requests a second",
            Grouped(rate(|sample| sample.requests)).to_string(),
        ),
        (
            "Steps a second",
            Grouped(rate(|sample| sample.steps)).to_string(),
        ),
        ("Requests", Grouped(now.requests).to_string()),
        ("Steps", Grouped(now.steps).to_string()),
        ("Errors", Grouped(now.errors).to_string()),
        (
            "Faults of the server",
            Grouped(metrics.faults()).to_string(),
        ),
    ];
    for (name, value) in entries {
        write!(html, "<div><dt>{name}<dd>{value}</div>")?;
    }
    html.push_str("</dl><p>Rates are those of the last ten seconds.</p>");
    table(html, &server.admissions.sessions())
}

fn table(html: &mut String, sessions: &[Arc<Admitted>]) -> fmt::Result {
    if sessions.is_empty() {
        html.push_str("<p>There is no session.</p>");
        return Ok(());
    }
    html.push_str(
        "<div class=wide><table><thead><tr><th>Session<th>Client<th>Environment<th>Count<th>Steps<th>Errors\
         <th>Age<th>Connected<tbody>",
    );
    for session in sessions.iter().take(ROWS) {
        let connected = session.connected.load(Ordering::Relaxed);
        write!(
            html,
            "<tr><td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}",
            session.name,
            session.client,
            session.env(),
            Grouped(session.envs as u64),
            Grouped(session.steps.load(Ordering::Relaxed)),
            Grouped(session.errors.load(Ordering::Relaxed)),
            Span(session.began.elapsed()),
            if connected { "yes" } else { "no" },
        )?;
    }
    html.push_str("</table></div>");
    match sessions.len().saturating_sub(ROWS) {
        0 => Ok(()),
        more => write!(html, "<p>And {more} more.</p>"),
    }
}

/// A number with its thousands apart.
struct Grouped(u64);

impl fmt::Display for Grouped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.0.to_string();
        for (i, digit) in digits.chars().enumerate() {
            if i > 0 && (digits.len() - i).is_multiple_of(3) {
                f.write_char(',')?;
            }
            f.write_char(digit)?;
        }
        Ok(())
    }
}

/// A time in its two largest units.
struct Span(Duration);

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0.as_secs();
        let (days, hours) = (seconds / 86_400, seconds / 3_600 % 24);
        let minutes = seconds / 60 % 60;
        match (days, hours, minutes) {
            (0, 0, 0) => write!(f, "{seconds} s"),
            (0, 0, _) => write!(f, "{minutes} min {} s", seconds % 60),
            (0, _, _) => write!(f, "{hours} h {minutes} min"),
            _ => write!(f, "{days} d {hours} h"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Grouped, Span};
    use std::time::Duration;

    #[test]
    fn numbers_and_times_read_well() {
        for (number, text) in [
            (0, "0"),
            (999, "999"),
            (1_000, "1,000"),
            (12_345_678, "12,345,678"),
        ] {
            assert_eq!(Grouped(number).to_string(), text);
        }
        for (seconds, text) in [
            (59, "59 s"),
            (61, "1 min 1 s"),
            (3_660, "1 h 1 min"),
            (90_000, "1 d 1 h"),
        ] {
            assert_eq!(Span(Duration::from_secs(seconds)).to_string(), text);
        }
    }
}
