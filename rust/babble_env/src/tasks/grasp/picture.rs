//! What the eye, and a person, sees of an episode.

use babble_body::robot::World;
use babble_body::visual;
use babble_eye::{Gaze, Primitive, red_region};
use image::RgbImage;
use nalgebra::{Vector2, Vector3};

use super::case::GraspCase;
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
    let scene = sight::scene(task, &state.world, &state.case);
    visible_in(task, &state.world, &state.case, &scene, state.gaze)
}

/// What there is to see of a world, with the things that the eye sees of it and its gaze.
pub(super) fn visible_in(
    task: &GraspTask,
    world: &World,
    case: &GraspCase,
    scene: &[Primitive],
    gaze: Gaze,
) -> Visible {
    let red = red_region(scene, &task.eye.camera(gaze));
    let ball = task.robot.visible_object(world, case.radius());
    let mut parts = vec![("object", ball)];
    parts.extend(task.robot.visible_parts(world));
    if let Some(obstacle) = &case.obstacle {
        parts.push(("obstacle", visual::obstacle(&task.config.body, obstacle)));
    }
    if let Some(goal) = case.goal {
        parts.push(("goal", visual::goal(goal)));
    }
    let palm = task.robot.palm(world).origin;
    Visible::new(&task.eye, gaze, red, palm.into(), parts)
}

fn world_at(task: &GraspTask, moment: &Moment) -> World {
    task.robot
        .posed(&moment.joints, &Vector3::from(moment.object))
}

/// Where the object is to be carried, on the ground.
fn push_goal(things: &mut Vec<Primitive>, state: &GraspState) {
    if let Some(goal) = state.case.goal {
        things.push(visual::goal(goal));
    }
}
