//! The paper's tests by name: the same cases for every agent.

use super::case::{GraspCase, GraspRequest, ObjectPlace};
use super::task::GraspTask;
use crate::error::EnvError;
use crate::executor::{Executor, Stop};
use crate::stream::{Purpose, Stream};

/// Distances of Table II's objects from the shoulder \[m\] and their directions \[deg\] \[C\].
const RADII_M: [f64; 3] = [0.13, 0.21, 0.29];
const POLAR_DEG: [f64; 4] = [-20.0, 40.0, 100.0, 160.0];
/// Values of shoulder and elbow at the start, evenly inside of the joint ranges \[C\].
const STARTS: [usize; 2] = [4, 3];

/// Table II: 12 positions of the object times 12 starts, for each diameter of the config in turn.
/// Where the arm would begin in the object there is none.
#[must_use]
pub fn table2(task: &GraspTask) -> Vec<Option<GraspCase>> {
    grid(task, STARTS[0] * STARTS[1])
}

/// Fig. 7: the same 12 positions times 11 starts, all of Table II's but the last.
#[must_use]
pub fn fig7(task: &GraspTask) -> Vec<Option<GraspCase>> {
    grid(task, STARTS[0] * STARTS[1] - 1)
}

/// `n` random cases of the task's region. Case i depends on `purpose`, `seed` and i alone.
///
/// # Errors
/// [`EnvError::NoGraspCase`] when the config leaves no room, or an error of the executor.
pub fn random(
    task: &GraspTask,
    n: usize,
    seed: u64,
    purpose: Purpose,
    executor: &mut Executor,
) -> Result<Vec<GraspCase>, EnvError> {
    let request = GraspRequest::default();
    executor.map(0..n, |i, stop| {
        request.draw(task, &mut Stream::new(purpose, seed, i as u64), stop)
    })
}

fn grid(task: &GraspTask, starts: usize) -> Vec<Option<GraspCase>> {
    let diameters = &task.config.grasp.diameters_m;
    let positions = RADII_M.len() * POLAR_DEG.len();
    let mut cases = Vec::with_capacity(diameters.len() * positions * starts);
    for &diameter in diameters {
        for position in 0..positions {
            for start in 0..starts {
                cases.push(case(task, diameter, position, start));
            }
        }
    }
    cases
}

fn case(task: &GraspTask, diameter: f64, position: usize, start: usize) -> Option<GraspCase> {
    let radius = RADII_M[position / POLAR_DEG.len()];
    let (sin, cos) = libm::sincos(POLAR_DEG[position % POLAR_DEG.len()].to_radians());
    let share = [start / STARTS[1], start % STARTS[1]];
    let share = [0, 1].map(|i| (share[i] as f64 + 0.5) / STARTS[i] as f64);
    let request = GraspRequest {
        start: Some(task.arm.denormalised(share)),
        object: ObjectPlace::At([radius * cos, radius * sin]),
        diameter: Some(diameter),
        ..GraspRequest::default()
    };
    // Nothing is left to draw but the goal of the goal form.
    let mut stream = Stream::new(Purpose::Test, 0, (position * 100 + start) as u64);
    request.draw(task, &mut stream, &Stop::default()).ok()
}
