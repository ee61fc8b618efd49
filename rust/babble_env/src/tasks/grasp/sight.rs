//! What the eye sees of a grasping episode: Eq. 1 on the image, and the fovea's edges.

use babble_body::robot::World;
use babble_body::visual;
use babble_eye::{Gaze, Material, Primitive, SHAPE_LEN, Shape, foveal_shape};
use nalgebra::{Matrix3, Vector3};

use super::case::GraspCase;
use super::task::GraspTask;

/// Neurons of the map of the fovea, 21 × 21.
pub const FOVEA_NEURONS: usize = SHAPE_LEN;

/// Colour of what the object lies on.
const TABLE: Material = Material::plain([196, 196, 188]);
/// Half the edge of the table, beyond all that the arm can reach \[m\].
const TABLE_M: f64 = 0.6;

/// The things that the eye sees, the object first.
pub(super) fn scene(task: &GraspTask, world: &World, case: &GraspCase) -> Vec<Primitive> {
    let mut scene = Vec::with_capacity(32);
    scene.push(task.robot.visible_object(world, case.radius()));
    task.robot.push_visible(world, &mut scene);
    if let Some(obstacle) = &case.obstacle {
        scene.push(visual::obstacle(&task.config.body, obstacle));
    }
    scene.push(table(task));
    scene
}

/// A plain table below arm and hand. The support, which is higher, is not seen: arm and hand pass
/// through it.
fn table(task: &GraspTask) -> Primitive {
    const THICKNESS_M: f64 = 0.02;
    let top = -task.config.body.hand.palm_height_m / 2.0 - 0.005;
    let shape = Shape::Cuboid {
        centre: Vector3::new(0.0, 0.1, top - THICKNESS_M / 2.0),
        rotation: Matrix3::identity(),
        half_extents: Vector3::new(TABLE_M, TABLE_M, THICKNESS_M / 2.0),
    };
    Primitive::new(shape, TABLE)
}

/// The gaze that the reflex of Eq. 1 ends in, and whether it sees the object: straight at the
/// workspace's middle when arm and hand hide all of it.
pub(super) fn foveate(task: &GraspTask, scene: &[Primitive]) -> (Gaze, bool) {
    let rest = task.eye.rest();
    task.eye
        .foveate(scene, rest)
        .map_or((rest, false), |gaze| (gaze, true))
}

/// Lets the eye find the object and fills in the fovea's edges; none where all of it is hidden.
#[must_use]
pub fn see(
    task: &GraspTask,
    world: &World,
    case: &GraspCase,
    fovea: &mut [f32; FOVEA_NEURONS],
) -> Option<Gaze> {
    let scene = scene(task, world, case);
    let gaze = task.eye.foveate(&scene, task.eye.rest()).ok()?;
    look(task, &scene, gaze, fovea);
    Some(gaze)
}

/// Edges in the fovea, where the eye looks.
pub(super) fn look(
    task: &GraspTask,
    scene: &[Primitive],
    gaze: Gaze,
    fovea: &mut [f32; FOVEA_NEURONS],
) {
    foveal_shape(scene, &task.eye.camera(gaze), fovea);
}
