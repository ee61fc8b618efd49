//! What the eye, and a person, sees of an episode.

use babble_body::robot::World;
use babble_body::visual;
use babble_eye::red_region;
use image::RgbImage;
use nalgebra::{Vector2, Vector3};

use super::sight;
use super::state::{GraspState, Moment};
use super::task::GraspTask;
use crate::error::EnvError;
use crate::picture::{Scene, View, Visible, no_such_frame};

/// A picture of an episode; `frame` picks a recorded moment, none is now.
///
/// # Errors
/// [`EnvError::OutOfBounds`] for an edge or frame that is out of bounds.
pub(super) fn picture(
    task: &GraspTask,
    state: &GraspState,
    view: View,
    size: [u32; 2],
    frame: Option<usize>,
) -> Result<RgbImage, EnvError> {
    let (trail, moment) = match frame {
        None => (&state.trail[..], None),
        Some(frame) => {
            let moment = state
                .trail
                .get(frame)
                .ok_or_else(|| no_such_frame(frame, state.trail.len()))?;
            (&state.trail[..=frame], Some(moment))
        }
    };
    let past = moment.map(|moment| world_at(task, moment));
    let world = past.as_ref().unwrap_or(&state.world);
    let gaze = moment.map_or(state.gaze, |moment| moment.gaze);
    let mut things = sight::scene(task, world, &state.case);
    if view == View::ThirdPerson {
        // The checkered ground stands for the table.
        things.pop();
        let palms: Vec<Vector2<f64>> = trail
            .iter()
            .map(|moment| Vector2::from(moment.palm))
            .collect();
        visual::push_trail(&mut things, &palms);
        push_goal(&mut things, state);
        visual::push_surroundings(&mut things, &task.config.body, gaze, &task.eye);
    }
    let scene = Scene {
        things: &things,
        on_top: &[],
        eye: &task.eye,
        gaze,
    };
    scene.picture(view, size)
}

/// As [`crate::Task::visible`].
pub(super) fn visible(task: &GraspTask, state: &GraspState) -> Visible {
    let body = &task.config.body;
    let scene = sight::scene(task, &state.world, &state.case);
    let red = red_region(&scene, &task.eye.camera(state.gaze));
    let ball = task.robot.visible_object(&state.world, state.case.radius());
    let mut parts = vec![("object", ball)];
    parts.extend(task.robot.visible_parts(&state.world));
    if let Some(obstacle) = &state.case.obstacle {
        parts.push(("obstacle", visual::obstacle(body, obstacle)));
    }
    if let Some(goal) = state.case.goal {
        parts.push(("goal", visual::goal(goal)));
    }
    let palm = task.robot.palm(&state.world).origin;
    Visible::new(&task.eye, state.gaze, red, palm.into(), parts)
}

fn world_at(task: &GraspTask, moment: &Moment) -> World {
    task.robot
        .posed(&moment.joints, &Vector3::from(moment.object))
}

/// Where the object is to be carried, on the ground.
fn push_goal(things: &mut Vec<babble_eye::Primitive>, state: &GraspState) {
    if let Some(goal) = state.case.goal {
        things.push(visual::goal(goal));
    }
}
