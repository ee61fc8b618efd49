//! OpenEnv's messages, played on one environment. It knows no network.

use serde::Serialize;

use super::Served;
use super::mcp;
use super::message::{Code, Refusal, Request, Reset, text};
use super::observation::Observed;
use crate::fault::{Fault, Kind};
use crate::limits::Limits;
use crate::session::Session;
use crate::wire::{self, CaseMap, Make, Shown};

/// Letters of a float32 number and a comma.
const MOST_NUMBER: usize = 16;
/// Letters of a pixel, as in `[255,255,255],`.
const MOST_PIXEL: usize = 14;

/// One environment, and its episode.
#[derive(Debug)]
pub struct Player {
    served: Served,
    limits: Limits,
    /// What the session was made of.
    made: Make,
    session: Session,
    episode: Option<Episode>,
}

/// The running episode, or the one that ended last.
#[derive(Debug)]
struct Episode {
    id: String,
    steps: u64,
    seed: Option<u64>,
}

/// The data of a state.
#[derive(Debug, Serialize)]
struct State<'a> {
    episode_id: Option<&'a str>,
    step_count: u64,
    env: &'a str,
    seed: Option<u64>,
    case: Option<CaseMap>,
}

/// Reply to a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Name of what was asked, in counters.
    pub operation: &'static str,
    /// A message of the server.
    pub result: Result<String, Refusal>,
}

impl Player {
    /// Plays a session that [`Served::make`] describes.
    #[must_use]
    pub fn new(served: Served, limits: Limits, session: Session) -> Self {
        Self {
            made: served.make(),
            served,
            limits,
            session,
            episode: None,
        }
    }

    /// Id of the environment.
    #[must_use]
    pub fn env(&self) -> &str {
        &self.session.env
    }

    /// Steps of the episode so far.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.episode.as_ref().map_or(0, |episode| episode.steps)
    }

    /// Does what a message asks, within the time of a request. No reply: the client ends the session.
    pub fn answer(&mut self, message: &str) -> Option<Reply> {
        let request = Request::read(message);
        let operation = request.as_ref().map_or("unknown", Request::operation);
        let result = match request {
            Ok(Request::Close) => return None,
            Ok(Request::Reset(asked)) => self.reset(asked).map(|shown| self.observed(&shown, true)),
            Ok(Request::Step(action)) => {
                self.step(&action).map(|shown| self.observed(&shown, false))
            }
            Ok(Request::State) => self.state(),
            Ok(Request::Mcp(request)) => Ok(text("mcp", &mcp::answer(request))),
            Err(refusal) => Err(refusal),
        };
        Some(Reply { operation, result })
    }

    /// Begins an episode and shows it, for a request over HTTP.
    ///
    /// # Errors
    /// [`Refusal`] as for a message.
    pub(super) fn first(&mut self, asked: Reset) -> Result<String, Refusal> {
        let shown = self.reset(asked)?;
        let observed = Observed::new(&self.session, &shown, true);
        serde_json::to_string(&observed)
            .map_err(|error| Refusal::new(Code::ExecutionError, error.to_string()))
    }

    /// The state as an object of JSON.
    pub(super) fn state_json(&self) -> Result<String, Refusal> {
        serde_json::to_string(&self.state_now()?)
            .map_err(|error| Refusal::new(Code::ExecutionError, error.to_string()))
    }

    /// After an error all is as it was, except that a seed may have been used.
    fn reset(&mut self, asked: Reset) -> Result<Shown, Refusal> {
        let begin = wire::Reset {
            mask: None,
            seeds: asked.seed.map(|seed| vec![Some(seed)]),
            cases: asked.scenario.map(|case| vec![Some(case)]),
        };
        let names_env = asked.env.is_some() || asked.options.is_some() || asked.config.is_some();
        let make = if names_env {
            self.served.make_of(asked.env, asked.options, asked.config)
        } else {
            self.made.clone()
        };
        let shown = if make == self.made {
            self.session.timed(|session| session.reset(&begin))?
        } else {
            let mut other = Session::make(&make, &self.limits, 1)?;
            check_size(&other, &self.limits)?;
            let shown = other.timed(|session| session.reset(&begin))?;
            (self.session, self.made) = (other, make);
            shown
        };
        self.episode = Some(Episode {
            id: match asked.episode_id {
                Some(id) => id,
                None => new_id()?,
            },
            steps: 0,
            seed: asked.seed,
        });
        Ok(shown.now)
    }

    fn step(&mut self, action: &[f32]) -> Result<Shown, Refusal> {
        let stepped = self.session.timed(|session| session.step(action));
        let shown = stepped.map_err(|fault| match (fault.kind, &self.episode) {
            (Kind::ResetNeeded, None) => Refusal::new(
                Code::ExecutionError,
                "no episode has begun: send a reset first",
            ),
            (Kind::ResetNeeded, Some(_)) => {
                let message = "the episode has ended: send a reset to begin another";
                Refusal::new(Code::ExecutionError, message)
            }
            _ => Refusal::from(fault),
        })?;
        if let Some(episode) = &mut self.episode {
            episode.steps += 1;
        }
        Ok(shown.now)
    }

    fn observed(&self, shown: &Shown, is_reset: bool) -> String {
        text(
            "observation",
            &Observed::new(&self.session, shown, is_reset),
        )
    }

    fn state(&self) -> Result<String, Refusal> {
        Ok(text("state", &self.state_now()?))
    }

    fn state_now(&self) -> Result<State<'_>, Refusal> {
        let episode = self.episode.as_ref();
        Ok(State {
            episode_id: episode.map(|episode| &episode.id[..]),
            step_count: self.steps(),
            env: &self.session.env,
            seed: episode.and_then(|episode| episode.seed),
            case: episode.map(|_| self.session.case(0)).transpose()?,
        })
    }
}

/// Checks that a reply of this environment is no longer than a message may be.
///
/// # Errors
/// [`Fault`] that names the limit.
pub(super) fn check_size(session: &Session, limits: &Limits) -> Result<(), Fault> {
    let senses = session.spec.senses.iter();
    let numbers: usize = senses.map(|sense| sense.labels.len()).sum();
    let pixels = session.retina().map_or(0, |size| size as usize).pow(2);
    let longest = MOST_NUMBER * numbers + MOST_PIXEL * pixels;
    if longest > limits.message_bytes {
        let (what, most) = ("bytes of an observation in JSON", limits.message_bytes);
        return Err(Fault::limit(what, longest, most));
    }
    Ok(())
}

/// A random id in the form of a UUID.
fn new_id() -> Result<String, Fault> {
    let word =
        || getrandom::u64().map_err(|error| Fault::new(Kind::ServerError, error.to_string()));
    // Version 4 and variant 1 of RFC 9562.
    let [a, b] = [
        word()? & !0xf000 | 0x4000,
        word()? & !(0xc << 60) | 0x8 << 60,
    ];
    Ok(format!(
        "{:08x}-{:04x}-{:04x}-{:04x}-{:012x}",
        a >> 32,
        a >> 16 & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    ))
}
