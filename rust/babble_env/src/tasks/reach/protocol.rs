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
    executor.map(0..n, |i| {
        ReachCase::draw_legal(
            task,
            &mut Stream::new(purpose, seed, i as u64),
            Fidelity::Full,
        )
    })
}

/// Cases of Fig. 4: 36 starts on a circle around each of 4 targets, obstacle halfway. Starts from
/// which there is no case (out of reach, or the arm at either end touches the obstacle) are `None`.
///
/// The targets lie in the middle of the arm's work space at shares (⅓, ⅔) of the joint ranges; the
/// radius is the middle of the config's range of distances \[C\], as the paper prints neither.
#[must_use]
pub fn fig4(task: &ReachTask) -> Vec<Option<ReachCase>> {
    let [near, far] = task.config.reach.distance_m;
    let radius = 0.5 * (near + far);
    let start = |k: usize| {
        let target = fig4_target(task, k / FIG4_STARTS);
        let angle = std::f64::consts::TAU * (k % FIG4_STARTS) as f64 / FIG4_STARTS as f64;
        let (sin, cos) = libm::sincos(angle);
        ReachCase::between(task, target + Vector2::new(cos, sin) * radius, target)
    };
    (0..FIG4_TARGETS * FIG4_STARTS).map(start).collect()
}

fn fig4_target(task: &ReachTask, i: usize) -> Vector2<f64> {
    let share = |bit: usize| if bit == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
    task.arm
        .fingertip(task.arm.denormalised([share(i / 2), share(i % 2)]))
}
