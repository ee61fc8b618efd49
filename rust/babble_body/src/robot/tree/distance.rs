//! How far things are from the ball, and in which direction.

use nalgebra::{Vector2, Vector3};

use crate::obstacle::Obstacle;
use crate::robot::links::Solid;

/// From a surface to a point: how far, negative inside, and the direction outwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// \[m\]
    pub(super) distance: f64,
    pub(super) normal: Vector3<f64>,
}

/// From a solid to a point of its link's frame.
pub(super) fn from_solid(solid: &Solid, point: &Vector3<f64>) -> Gap {
    match solid {
        Solid::Capsule { a, b, radius } => {
            let along = b - a;
            let share = (along.dot(&(point - a)) / along.norm_squared()).clamp(0.0, 1.0);
            // A point on the axis is pushed out sideways.
            let side = Vector3::y();
            outwards(point - a - along * share, *radius, side)
        }
        Solid::Cuboid { centre, half } => from_cuboid(&(point - centre), half),
    }
}

fn from_cuboid(point: &Vector3<f64>, half: &Vector3<f64>) -> Gap {
    let nearest = point.zip_map(half, |p, h| p.clamp(-h, h));
    if nearest != *point {
        return outwards(point - nearest, 0.0, Vector3::y());
    }
    // Inside: out through the nearest face.
    let beyond = point.abs() - half;
    let face = beyond.imax();
    let mut normal = Vector3::zeros();
    normal[face] = if point[face] < 0.0 { -1.0 } else { 1.0 };
    Gap {
        distance: beyond[face],
        normal,
    }
}

/// From an upright cylinder around the origin's height to a point.
pub(super) fn from_obstacle(obstacle: &Obstacle, half_height: f64, point: &Vector3<f64>) -> Gap {
    let offset = point.xy() - obstacle.centre;
    let radial = outwards(offset.push(0.0), obstacle.radius, Vector3::x());
    let above = point.z.abs() - half_height;
    let up = Vector3::new(0.0, 0.0, if point.z < 0.0 { -1.0 } else { 1.0 });
    match (radial.distance > 0.0, above > 0.0) {
        (true, true) => outwards(
            radial.normal * radial.distance + up * above,
            0.0,
            radial.normal,
        ),
        (false, false) if radial.distance < above => Gap {
            distance: above,
            normal: up,
        },
        (false, true) => Gap {
            distance: above,
            normal: up,
        },
        _ => radial,
    }
}

/// From a solid, seen from above, to a point of the plane in its link's frame.
pub(super) fn from_shadow(solid: &Solid, foot: Vector2<f64>) -> Gap {
    from_solid(&solid.flat(), &foot.push(0.0))
}

fn outwards(offset: Vector3<f64>, radius: f64, otherwise: Vector3<f64>) -> Gap {
    let length = offset.norm();
    Gap {
        distance: length - radius,
        normal: if length > 0.0 {
            offset / length
        } else {
            otherwise
        },
    }
}
