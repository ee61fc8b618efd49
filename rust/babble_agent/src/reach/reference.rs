//! Choices of a movement that need no learning, and how a movement is played in other controls.

use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::{SENSES, at};
use babble_env::{EnvError, Outcome, ReachCase, ReachTask};

/// Values of b1 that the oracle tries: 0.01, 0.02, … 0.99.
const ORACLE_VALUES: u32 = 99;
/// Distance of the scripted b1 from ½.
const SCRIPTED_CURVE: f64 = 0.25;

/// The case that an agent can tell from its senses: start from the arm's proprioception, target
/// from the eye's, obstacle from its angles in the camera frame.
///
/// # Errors
/// [`EnvError::Case`] when the senses point nowhere in the plane of motion.
pub fn case_from_senses(task: &ReachTask, senses: &[f32; SENSES]) -> Result<ReachCase, EnvError> {
    let pair = |at: usize| [f64::from(senses[at]), f64::from(senses[at + 1])];
    let nowhere = |what| EnvError::Case {
        what,
        problem: "the gaze does not meet the plane".to_owned(),
    };
    let gaze = task.eye.from_normalised(pair(at::EYE));
    let target = task
        .eye
        .target_in_plane(gaze, 0.0)
        .ok_or_else(|| nowhere("target"))?;
    let start = task.arm.denormalised(pair(at::ARM));
    let absent = ReachTask::obstacle_angles(&task.eye.camera(gaze), None).map(|x| x as f32);
    let obstacle = if senses[at::OBSTACLE..at::STRETCH] == absent {
        None
    } else {
        let centre = task
            .eye
            .point_in_plane(gaze, pair(at::OBSTACLE), 0.0)
            .ok_or_else(|| nowhere("obstacle"))?;
        Some(babble_env::tasks::reach::case::obstacle_at(task, centre))
    };
    Ok(ReachCase {
        start,
        hand: task.arm.fingertip(start).into(),
        target,
        obstacle,
    })
}

/// A bulge towards the shoulder, where the arm folds away from the obstacle: |b1 − ½| = 0.25.
#[must_use]
pub fn scripted(case: &ReachCase) -> [f64; 2] {
    let [x, y] = [0, 1].map(|i| case.target[i] - case.hand[i]);
    // The shoulder is at the origin; b1 > ½ curves to the left of the way.
    let shoulder_is_left = x * -case.hand[1] - y * -case.hand[0] > 0.0;
    let b1 = if shoulder_is_left {
        0.5 + SCRIPTED_CURVE
    } else {
        0.5 - SCRIPTED_CURVE
    };
    [b1, 1.0 - b1]
}

/// The movement that succeeds, found by simulating up to 99 of them, from the middle of the longest
/// run of values that do; a straight one if none does.
///
/// # Errors
/// [`EnvError::Brain`] never, as all values tried are in (0, 1).
pub fn oracle(task: &ReachTask, case: &ReachCase) -> Result<[f64; 2], EnvError> {
    let mut best = (0, 0);
    let mut run = 0;
    for k in 1..=ORACLE_VALUES {
        let b1 = f64::from(k) / f64::from(ORACLE_VALUES + 1);
        let path = MovementPath::new(task, case, [b1, 1.0 - b1])?;
        let succeeds = path.is_legal(task, case, Fidelity::QuasiStatic)
            && path.play(task, case, Fidelity::Full, |_| {}).outcome == Outcome::Success;
        run = if succeeds { run + 1 } else { 0 };
        if run > best.0 {
            best = (run, k);
        }
    }
    let (length, last) = best;
    if length == 0 {
        return Ok([0.5, 0.5]);
    }
    let b1 = (f64::from(last) - 0.5 * f64::from(length - 1)) / f64::from(ORACLE_VALUES + 1);
    Ok([b1, 1.0 - b1])
}

/// Equilibrium points of a whole movement, one a control step, as shares of the joint ranges; from
/// where the path leaves the joint ranges the last posture inside is held.
///
/// # Errors
/// [`EnvError`] for b outside of (0, 1).
pub fn plan(task: &ReachTask, case: &ReachCase, b: [f64; 2]) -> Result<Vec<[f32; 2]>, EnvError> {
    let path = MovementPath::new(task, case, b)?;
    let steps = task.config.reach.movement_steps();
    let mut shares: Vec<[f32; 2]> = path
        .postures()
        .iter()
        .map(|&q| task.arm.normalised(q).map(|x| x as f32))
        .collect();
    let last = shares
        .last()
        .copied()
        .unwrap_or(task.arm.normalised(case.start).map(|x| x as f32));
    shares.resize(steps, last);
    Ok(shares)
}
