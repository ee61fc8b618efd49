//! Messages of the server's binary protocol: refused, or played on a session that stays usable.

use std::time::Duration;

use babble_server::binary::execute;
use babble_server::binary::request::{Envelope, Request};
use babble_server::fault::Kind;
use babble_server::limits::Limits;
use babble_server::session::Session;
use babble_server::wire::{Make, Reset};

const ENVS: usize = 2;

/// A binary message. Whether it is a request that can be done.
pub fn request(data: &[u8]) -> bool {
    let Ok(request) = Envelope::read(data).request else {
        return false;
    };
    if let Request::Make(asked) = &request {
        let Ok(mut session) = Session::make(asked, &small(), 1) else {
            return false;
        };
        // The config may leave no room for a case.
        let begun = session.timed(|session| session.reset(&Reset::default()));
        return begun.is_ok();
    }
    let mut session = begun();
    let (_, fault) = session.timed(|session| execute(session, 1, request));
    let kind = fault.map(|fault| fault.kind);
    assert_ne!(kind, Some(Kind::ServerError));
    match session.step(&[0.1; 2 * ENVS]) {
        Ok(_) => {}
        // A state may have ended, or not begun.
        Err(refused) => assert_eq!(refused.kind, Kind::ResetNeeded),
    }
    session.reset(&Reset::default()).expect("it can be reset");
    kind.is_none()
}

/// Less than the defaults, so that no input takes long.
fn small() -> Limits {
    Limits {
        envs_per_session: 8,
        message_bytes: 1 << 20,
        picture_pixels: 1 << 12,
        request_time: Duration::from_secs(2),
        ..Limits::default()
    }
}

fn begun() -> Session {
    let asked = Make {
        env: "BabbleReach-v0".to_owned(),
        num_envs: ENVS,
        autoreset: "Disabled".to_owned(),
        config: serde_json::Value::Null,
        options: serde_json::Map::new(),
        threads: None,
    };
    let mut session = Session::make(&asked, &small(), 1).expect("a session");
    let seeds = Some(vec![Some(1), Some(2)]);
    let begun = session.reset(&Reset {
        seeds,
        ..Reset::default()
    });
    begun.expect("it can be reset");
    session
}
