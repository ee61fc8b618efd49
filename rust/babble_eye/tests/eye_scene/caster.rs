//! A ray caster over all primitives, in world coordinates and f64: slow,
//! plain, and with no formula in common with the rasteriser.

use babble_eye::{Pinhole, Primitive, Shape};
use nalgebra::Vector3;

type V = Vector3<f64>;

/// Primitive and depth seen at pixel coordinates (u, v).
pub fn cast(scene: &[Primitive], camera: &Pinhole, [u, v]: [f64; 2]) -> Option<(usize, f64)> {
    let x = (u - 0.5 * camera.width as f64) / camera.focal_px;
    let y = (0.5 * camera.height as f64 - v) / camera.focal_px;
    let ray = camera.rotation.transpose() * Vector3::new(x, y, 1.0);
    scene
        .iter()
        .enumerate()
        .filter_map(|(index, primitive)| {
            let [enter, leave] = through(&primitive.shape, &camera.position, &ray);
            (enter > 0.0 && enter <= leave).then_some((index, enter))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether a solid lies on the way from a point in a direction.
pub fn blocked(scene: &[Primitive], from: &V, direction: &V) -> bool {
    scene.iter().any(|primitive| {
        let [enter, leave] = through(&primitive.shape, from, direction);
        enter > 0.0 && enter <= leave
    })
}

const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Where the line `origin + t ray` enters and leaves a convex shape.
fn through(shape: &Shape, origin: &V, ray: &V) -> [f64; 2] {
    match shape {
        Shape::Sphere { centre, radius } => ball(&(origin - centre), ray, *radius),
        Shape::Capsule { a, b, radius } => [
            ball(&(origin - a), ray, *radius),
            ball(&(origin - b), ray, *radius),
            cylinder(&(origin - a), ray, &(b - a), *radius),
        ]
        .into_iter()
        .filter(|[enter, leave]| enter <= leave)
        .fold(NOWHERE, |all, part| {
            [all[0].min(part[0]), all[1].max(part[1])]
        }),
        Shape::Cylinder { a, b, radius } => cylinder(&(origin - a), ray, &(b - a), *radius),
        Shape::Cuboid {
            centre,
            rotation,
            half_extents,
        } => {
            let (from, along) = (rotation.tr_mul(&(origin - centre)), rotation.tr_mul(ray));
            (0..3)
                .map(|k| slab(from[k], along[k], -half_extents[k], half_extents[k]))
                .reduce(common)
                .unwrap_or(NOWHERE)
        }
        Shape::Ground {
            height,
            centre,
            half_extents,
            ..
        } => {
            let t = (height - origin.z) / ray.z;
            let inside =
                (0..2).all(|k| (origin[k] + t * ray[k] - centre[k]).abs() <= half_extents[k]);
            if inside && ray.z < 0.0 {
                [t, t]
            } else {
                NOWHERE
            }
        }
    }
}

fn ball(from: &V, ray: &V, radius: f64) -> [f64; 2] {
    roots(
        ray.norm_squared(),
        from.dot(ray),
        from.norm_squared() - radius * radius,
    )
}

fn cylinder(from: &V, ray: &V, axis: &V, radius: f64) -> [f64; 2] {
    let unit = axis.normalize();
    let (along_from, along_ray) = (from.dot(&unit), ray.dot(&unit));
    let (across_from, across_ray) = (from - unit * along_from, ray - unit * along_ray);
    common(
        ball(&across_from, &across_ray, radius),
        slab(along_from, along_ray, 0.0, axis.norm()),
    )
}

/// Where a t² + 2 b t + c ≤ 0.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let root = (b * b - a * c).sqrt();
    if root.is_nan() {
        NOWHERE
    } else {
        [(-b - root) / a, (-b + root) / a]
    }
}

fn slab(from: f64, along: f64, low: f64, high: f64) -> [f64; 2] {
    let (p, q) = ((low - from) / along, (high - from) / along);
    [p.min(q), p.max(q)]
}

fn common(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}
