//! Balls along the palm: where one meets it, and the case in which it meets it elsewhere.

use std::sync::Arc;

use babble_env::{AnyTask, CaseValues, GraspCase, GraspTask, downcast};

use crate::command::Case;
use crate::fault::Fault;

/// Distances from the wrist to which a ball can be moved \[m\]: nearer it meets the forearm too, and farther
/// the fingers.
const PALM_M: [f64; 2] = [0.016, 0.054];
/// How far the elbow is extended before it bends until the palm touches \[deg\].
const WITHDRAWN_DEG: f64 = 30.0;
/// Least and greatest elbow when the palm touches: balls of all sizes are then clear of the upper arm \[deg\].
const ELBOW_DEG: [f64; 2] = [50.0, 100.0];

/// How far from the wrist the ball of a case meets the palm when the elbow alone bends \[m\]; none in
/// reaching, or if it does not meet it.
pub(crate) fn place(task: &Arc<dyn AnyTask>, values: &CaseValues) -> Option<f64> {
    downcast::<GraspTask>(task)?.palm_place(&GraspCase {
        start: values.numbers("start")?,
        object: values.numbers("object")?,
        diameter: values.number("diameter")?,
        goal: None,
        obstacle: None,
    })
}

/// The case with the ball so far from the wrist \[m\] when the elbow alone bends until the palm touches it.
///
/// # Errors
/// A [`Fault`] for a distance out of bounds, or another task.
pub(crate) fn moved(
    task: &Arc<dyn AnyTask>,
    values: &CaseValues,
    wrist_m: f64,
) -> Result<Case, Fault> {
    let [low, high] = PALM_M;
    if !(low..=high).contains(&wrist_m) {
        let problem = format!("{wrist_m} m from the wrist is not in [{low}, {high}] m");
        return Err(Fault::config("wrist", problem));
    }
    let no_palm = || Fault::config("env", "balls meet the palm in grasping alone");
    let task = downcast::<GraspTask>(task).ok_or_else(no_palm)?;
    let numbers = || values.numbers::<2>("start").zip(values.number("diameter"));
    let ([shoulder, elbow], diameter) = numbers().ok_or_else(no_palm)?;
    let withdrawn = WITHDRAWN_DEG.to_radians();
    let [least, most] = ELBOW_DEG.map(f64::to_radians);
    let touching = (elbow + withdrawn).clamp(least, most);
    let object = task.along_palm([shoulder, touching], diameter / 2.0, wrist_m);
    let mut case = Case::new();
    let start = [shoulder, touching - withdrawn];
    case.insert("start".to_owned(), start.into());
    case.insert("object".to_owned(), object.into());
    case.insert("diameter".to_owned(), diameter.into());
    Ok(case)
}
