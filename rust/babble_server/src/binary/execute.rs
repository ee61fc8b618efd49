//! What a request does to a session.

use axum::body::Bytes;

use super::reply::encode;
use super::request::Request;
use crate::fault::{Fault, Kind};
use crate::session::Session;
use crate::wire::{Case, Cases, GoalRewards, Hash, Moments, Nothing, Picture, Raw, Saved, Trail};

/// Plays a request; the reply as bytes, and the error in it.
pub fn execute(session: &mut Session, id: u64, request: Request) -> (Bytes, Option<Fault>) {
    macro_rules! reply {
        ($done:expr) => {{
            let done = $done;
            (encode(Some(id), &done), done.err())
        }};
    }
    match request {
        Request::Make(_) | Request::Resume(_) => {
            let message = "this connection has a session already; close it, or connect again";
            reply!(Err::<Nothing, _>(Fault::new(Kind::SessionError, message)))
        }
        Request::Reset(asked) => reply!(session.reset(&asked)),
        Request::Step(asked) => reply!(session.step(&asked.actions.0)),
        Request::Save(asked) => reply!(session.save(&asked).map(|states| Saved { states })),
        Request::Load(asked) => reply!(session.load(&asked.states).map(|()| Nothing {})),
        Request::Hash(of) => reply!(session.hash(of.env).map(|hash| Hash { hash })),
        Request::Case(of) => reply!(session.case(of.env).map(|case| Case { case })),
        Request::Trail(of) => reply!(
            session
                .trail(of.env)
                .map(|trail| Trail { trail: Raw(trail) })
        ),
        Request::Moments(of) => {
            reply!(session.moments(of.env).map(|moments| Moments { moments }))
        }
        Request::Render(asked) => reply!(session.render(&asked).map(|image| Picture { image })),
        Request::GoalReward(asked) => {
            reply!(session.goal_reward(&asked).map(|reward| GoalRewards {
                reward: Raw(reward)
            }))
        }
        Request::Scenarios(asked) => {
            reply!(session.scenarios(&asked).map(|cases| Cases { cases }))
        }
        Request::Close(_) => reply!(Ok(Nothing {})),
    }
}
