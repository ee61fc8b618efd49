//! The scene of a picture of reaching.

use babble_body::visual::{self, Part};
use babble_eye::{Gaze, Primitive, red_region};
use image::RgbImage;
use nalgebra::Vector2;

use super::case::ReachCase;
use super::state::ReachState;
use super::task::ReachTask;
use crate::error::EnvError;
use crate::picture::{Scene, View, Visible, no_such_frame};

/// As [`crate::Task::picture`].
pub(super) fn picture(
    task: &ReachTask,
    state: &ReachState,
    view: View,
    size: [u32; 2],
    frame: Option<usize>,
) -> Result<RgbImage, EnvError> {
    let (q, trail) = moment(state, frame)?;
    let things = things(task, state, q, trail, view);
    // Nothing hides the target from the eye, so that an image's red pixels are those that its
    // reflex saw (`ReachTask::foveate`).
    let scene = Scene {
        on_top: &things[..1],
        things: &things,
        eye: &task.eye,
        gaze: state.gaze,
    };
    scene.picture(view, size)
}

fn moment(state: &ReachState, frame: Option<usize>) -> Result<([f64; 2], &[[f64; 2]]), EnvError> {
    let Some(frame) = frame else {
        return Ok((state.arm.q, &state.trail));
    };
    let q = state
        .trail
        .get(frame)
        .ok_or_else(|| no_such_frame(frame, state.trail.len()))?;
    Ok((*q, &state.trail[..=frame]))
}

/// As [`crate::Task::visible`].
pub(super) fn visible(task: &ReachTask, state: &ReachState) -> Visible {
    task.visible_at(&state.case, state.gaze, state.arm.q)
}

impl ReachTask {
    /// What there is to see of a case with the eye at a gaze and the arm in a posture \[rad\].
    #[must_use]
    pub fn visible_at(&self, case: &ReachCase, gaze: Gaze, q: [f64; 2]) -> Visible {
        let target = visual::target(&self.config.body, case.target);
        let [x, y] = self.arm.fingertip(q).into();
        let red = red_region(&[target], &self.eye.camera(gaze));
        Visible::new(&self.eye, gaze, red, [x, y, 0.0], parts(self, case, q))
    }
}

/// The target first, then all else that is solid.
fn parts(task: &ReachTask, case: &ReachCase, q: [f64; 2]) -> Vec<Part> {
    let body = &task.config.body;
    let mut parts = vec![("target", visual::target(body, case.target))];
    if let Some(obstacle) = &case.obstacle {
        parts.push(("obstacle", visual::obstacle(body, obstacle)));
    }
    parts.extend(visual::robot(body, q));
    parts
}

/// The target first, then all else.
fn things(
    task: &ReachTask,
    state: &ReachState,
    q: [f64; 2],
    trail: &[[f64; 2]],
    view: View,
) -> Vec<Primitive> {
    let body = &task.config.body;
    let parts = parts(task, &state.case, q).into_iter();
    let mut things: Vec<Primitive> = parts.map(|(_, thing)| thing).collect();
    if view == View::ThirdPerson {
        let tips: Vec<Vector2<f64>> = trail.iter().map(|&q| task.arm.fingertip(q)).collect();
        visual::push_trail(&mut things, &tips);
        visual::push_surroundings(&mut things, body, state.gaze, &task.eye);
    } else {
        things.push(visual::ground(body));
    }
    things
}
