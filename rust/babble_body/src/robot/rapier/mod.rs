//! rapier3d as the engine: general, in single precision, and the reference of the one made for this
//! robot.

mod build;
mod input_log;
mod model;
mod seam;
mod simulation;
mod step;

pub(super) use model::Rapier;
pub(super) use step::RapierState;
