//! The camera of an onlooker, for pictures from outside.

use nalgebra::Vector3;

use crate::camera::Pinhole;

/// Field of view of the shorter edge \[deg\].
const FIELD_DEG: f64 = 42.0;

/// A fixed view of the whole workspace, from behind the body, right and above.
#[must_use]
pub fn third_person(width: usize, height: usize) -> Pinhole {
    let position = Vector3::new(0.24, -0.58, 1.04);
    let middle = Vector3::new(0.0, 0.04, 0.0);
    let edge = width.min(height);
    let view = Pinhole::look_at(position, middle, Vector3::z(), FIELD_DEG, edge, edge);
    view.middle(width, height)
}
