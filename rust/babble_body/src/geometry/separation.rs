//! Signed distances from surfaces to a point, with their normals.

use nalgebra::{Vector2, Vector3};

use super::obstacle::Obstacle;
use super::solid::Solid;

/// Signed distance from a surface to a point, negative inside, and the outward normal there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Separation {
    /// \[m\]
    pub(crate) distance: f64,
    pub(crate) normal: Vector3<f64>,
}

/// Separation of a point of its link's frame from a solid.
pub(crate) fn from_solid(solid: &Solid, point: &Vector3<f64>) -> Separation {
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

fn from_cuboid(point: &Vector3<f64>, half: &Vector3<f64>) -> Separation {
    let nearest = point.zip_map(half, |p, h| p.clamp(-h, h));
    if nearest != *point {
        return outwards(point - nearest, 0.0, Vector3::y());
    }
    // Inside: out through the nearest face.
    let beyond = point.abs() - half;
    let face = beyond.imax();
    let mut normal = Vector3::zeros();
    normal[face] = if point[face] < 0.0 { -1.0 } else { 1.0 };
    Separation {
        distance: beyond[face],
        normal,
    }
}

/// Separation of a point from an obstacle, which reaches `half_height` above and below the plane \[m\].
pub(crate) fn from_obstacle(
    obstacle: &Obstacle,
    half_height: f64,
    point: &Vector3<f64>,
) -> Separation {
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
        (false, false) if radial.distance < above => Separation {
            distance: above,
            normal: up,
        },
        (false, true) => Separation {
            distance: above,
            normal: up,
        },
        _ => radial,
    }
}

/// Separation of a point of the plane from a solid's projection into it, in its link's frame.
pub(crate) fn from_projected(solid: &Solid, foot: Vector2<f64>) -> Separation {
    from_solid(&solid.projected(), &foot.push(0.0))
}

fn outwards(offset: Vector3<f64>, radius: f64, otherwise: Vector3<f64>) -> Separation {
    let length = offset.norm();
    Separation {
        distance: length - radius,
        normal: if length > 0.0 {
            offset / length
        } else {
            otherwise
        },
    }
}
