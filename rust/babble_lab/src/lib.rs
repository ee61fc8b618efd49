#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods, clippy::disallowed_types)]

mod agent;
mod brain;
mod command;
mod cost;
pub mod expression;
mod fault;
mod film;
mod hash;
pub mod history;
mod json;
mod lab;
pub mod lesson;
mod making;
mod palm;
mod policies;
mod python;
mod record;
pub mod registry;
mod scene;
mod setup;
mod sliders;
mod snapshot;
mod stage;
mod state;
mod test_cases;
mod verdict;

pub use brain::{AssociationView, Axis, Brain, DecidedNumber, MapActivity};
pub use command::{Answer, Case, Command, MapName};
pub use fault::Fault;
pub use film::Film;
pub use history::{Event, Happened};
pub use json::{ToJson, check_rule};
pub use lab::Lab;
pub use lesson::{Lesson, lessons};
pub use policies::Policies;
pub use record::{Record, replay};
pub use registry::{Registry, default_setup, registry};
pub use scene::{GazeLine, Scene, Shape, Sight, Solid};
pub use setup::{AgentSetup, Setup};
pub use sliders::Slider;
pub use state::{AgentState, CurvePoint, EpisodeState, Outcomes, State};
pub use verdict::{Verdict, verdict};
