//! What the eye, and a person, sees of an episode.

use babble_body::eye::{Gaze, Pinhole, Primitive, is_red, render_rgb, render_smooth, third_person};
use babble_body::pose;
use image::RgbImage;
use image::imageops::thumbnail;
use nalgebra::Vector2;

use crate::case::ReachCase;
use crate::choice::named_enum;
use crate::error::EnvError;
use crate::reach::ReachState;
use crate::task::ReachTask;

named_enum!(
    /// Where a picture is taken from.
    View, "camera",
    /// From the front right and above.
    ThirdPerson = "third_person",
    /// Through the eye.
    Eye = "eye"
);

/// Smallest and largest edge of a picture \[pixel\].
const EDGE: std::ops::RangeInclusive<u32> = 16..=4096;

/// Fewest rays along an edge of the eye's image: with fewer the target falls between them, and a
/// pixel is the mean of several rays.
const EYE_RAYS: u32 = 160;

/// A picture of an episode.
///
/// `frame` picks a moment of the recorded trail; none is now.
///
/// # Errors
/// [`EnvError::OutOfBounds`] for an edge or frame that is out of bounds.
pub fn picture(
    task: &ReachTask,
    state: &ReachState,
    view: View,
    [width, height]: [u32; 2],
    frame: Option<usize>,
) -> Result<RgbImage, EnvError> {
    for (option, edge) in [("width", width), ("height", height)] {
        if !EDGE.contains(&edge) {
            return Err(EnvError::OutOfBounds {
                option,
                value: edge.to_string(),
                bound: format!("in [{}, {}] pixels", EDGE.start(), EDGE.end()),
            });
        }
    }
    let (q, trail) = moment(state, frame)?;
    let scene = scene(task, &state.case, state.gaze, q, trail, view);
    Ok(match view {
        View::ThirdPerson => render_smooth(&scene, &third_person(width as usize, height as usize)),
        View::Eye => {
            let edge = width.min(height);
            let rays = EYE_RAYS.div_ceil(edge);
            let camera = task
                .eye
                .camera_sized(state.gaze, (edge * rays) as usize)
                .middle((width * rays) as usize, (height * rays) as usize);
            let mut image = render_rgb(&scene, &camera);
            draw_target_on_top(&mut image, &scene[..1], &camera);
            if rays == 1 {
                image
            } else {
                thumbnail(&image, width, height)
            }
        }
    })
}

/// Nothing hides the target from the eye, so that an image's red pixels are those that its reflex
/// saw ([`ReachTask::foveate`]).
fn draw_target_on_top(image: &mut RgbImage, target: &[Primitive], camera: &Pinhole) {
    let alone = render_rgb(target, camera);
    for (pixel, red) in image
        .pixels_mut()
        .zip(alone.pixels())
        .filter(|(_, p)| is_red(p.0))
    {
        *pixel = *red;
    }
}

fn moment(state: &ReachState, frame: Option<usize>) -> Result<([f64; 2], &[[f64; 2]]), EnvError> {
    let Some(frame) = frame else {
        return Ok((state.arm.q, &state.trail));
    };
    let q = state
        .trail
        .get(frame)
        .ok_or_else(|| EnvError::OutOfBounds {
            option: "frame",
            value: frame.to_string(),
            bound: format!("below {}", state.trail.len()),
        })?;
    Ok((*q, &state.trail[..=frame]))
}

fn scene(
    task: &ReachTask,
    case: &ReachCase,
    gaze: Gaze,
    q: [f64; 2],
    trail: &[[f64; 2]],
    view: View,
) -> Vec<Primitive> {
    let body = &task.config.body;
    let mut scene = vec![pose::target(body, case.target)];
    if let Some(obstacle) = &case.obstacle {
        scene.push(pose::obstacle(body, obstacle));
    }
    pose::push_robot(&mut scene, body, q);
    if view == View::ThirdPerson {
        let tips: Vec<Vector2<f64>> = trail.iter().map(|&q| task.arm.fingertip(q)).collect();
        pose::push_trail(&mut scene, &tips);
        pose::push_surroundings(&mut scene, body, gaze, &task.eye);
    } else {
        scene.push(pose::ground(-body.obstacle.height_m / 2.0));
    }
    scene
}
