//! Messages of OpenEnv's protocol: answered, and another episode can be played.

use std::time::Duration;

use babble_server::limits::Limits;
use babble_server::openenv::{Mode, Player, Served};
use babble_server::session::Session;

/// A message as text. Whether it is one that can be done.
pub fn message(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let mut player = begun();
    let Some(reply) = player.answer(text) else {
        return true;
    };
    for message in [
        r#"{"type": "reset", "data": {"env": "BabbleReach-v0", "config": "paper"}}"#,
        r#"{"type": "step", "data": {"action": [0.1, 0.1]}}"#,
    ] {
        let reply = player.answer(message).expect("it does not close");
        reply.result.expect("it can be played");
    }
    reply.result.is_ok()
}

fn begun() -> Player {
    let served = Served {
        env: "BabbleReach-v0".to_owned(),
        options: Vec::new(),
        openenv_mode: Mode::Simulation,
    };
    // Less than the default, so that no input takes long.
    let limits = Limits {
        request_time: Duration::from_secs(2),
        message_bytes: 1 << 20,
        ..Limits::default()
    };
    let session = Session::make(&served.make(), &limits, 1).expect("a session");
    let mut player = Player::new(served, limits, session);
    let first = player.answer(r#"{"type": "reset", "data": {"seed": 1}}"#);
    let first = first.expect("it does not close").result;
    first.expect("it can be reset");
    player
}
