//! The paper's tests by name: the same cases for every agent.

use nalgebra::Vector2;

use super::case::ReachCase;
use super::movement::Fidelity;
use super::task::ReachTask;
use crate::error::EnvError;
use crate::executor::Executor;
use crate::stream::{Purpose, Stream};

/// Targets of Fig. 4.
const FIG4_TARGETS: usize = 4;
/// Starts around each target of Fig. 4.
const FIG4_STARTS: usize = 36;
/// Directions from a target in which a start of Fig. 4 may lie.
const FIG4_DIRECTIONS: usize = 720;

/// Cases of Table I: legal movements drawn by the full simulation, as the paper drew its 1,000.
/// Case i depends on `purpose`, `seed` and i alone.
///
/// # Errors
/// [`EnvError::NoLegalCase`] when the config leaves no room, or an error of the executor.
pub fn table1(
    task: &ReachTask,
    n: usize,
    seed: u64,
    purpose: Purpose,
    executor: &mut Executor,
) -> Result<Vec<ReachCase>, EnvError> {
    executor.map(0..n, |i, stop| {
        ReachCase::draw_legal(
            task,
            &mut Stream::new(purpose, seed, i as u64),
            Fidelity::Full,
            stop,
        )
    })
}

/// Cases of Fig. 4: 36 starts on a circle around each of 4 targets, obstacle halfway.
///
/// The paper prints no positions, so a rule chooses them \[C\]. The targets lie in the middle of the
/// arm's work space, at shares (⅓, ⅔) of the joint ranges. The radius is the middle of the config's
/// range of distances. A direction is playable if the arm touches no obstacle at either end, also
/// with obstacle and start exchanged. The starts are spread evenly over the playable ones of 720
/// directions. If fewer than 36 are playable, the list is filled up with `None`.
#[must_use]
pub fn fig4(task: &ReachTask) -> Vec<Option<ReachCase>> {
    (0..FIG4_TARGETS)
        .flat_map(|k| {
            let playable = fig4_playable(task, fig4_target(task, k));
            let spread = playable.len().max(FIG4_STARTS);
            (0..FIG4_STARTS).map(move |j| playable.get(j * spread / FIG4_STARTS).copied())
        })
        .collect()
}

fn fig4_playable(task: &ReachTask, target: Vector2<f64>) -> Vec<ReachCase> {
    let [near, far] = task.config.reach.distance_m;
    let radius = 0.5 * (near + far);
    (0..FIG4_DIRECTIONS)
        .filter_map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / FIG4_DIRECTIONS as f64;
            let (sin, cos) = libm::sincos(angle);
            ReachCase::between(task, target + Vector2::new(cos, sin) * radius, target)
        })
        .filter(|case| case.switched(task).is_some())
        .collect()
}

fn fig4_target(task: &ReachTask, i: usize) -> Vector2<f64> {
    let share = |bit: usize| if bit == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
    task.arm
        .fingertip(task.arm.denormalised([share(i / 2), share(i % 2)]))
}
