//! A scene to look at: arm, hand, target, obstacle and trail on the ground.

#![allow(dead_code, unreachable_pub, reason = "each test binary uses its part")]

pub mod caster;

use babble_eye::{Material, Primitive, Shape};
use nalgebra::{Matrix3, Rotation3, Vector3};

type V = Vector3<f64>;

const ARM: Material = Material::plain([222, 218, 208]);
const HAND: Material = Material::plain([240, 205, 160]);
const OBSTACLE: Material = Material::plain([122, 148, 180]);
const TRAIL: Material = Material::plain([66, 150, 140]);
const GROUND: Material = Material::plain([204, 205, 203]);

fn polar(length: f64, angle: f64) -> V {
    Vector3::new(length * angle.cos(), length * angle.sin(), 0.0)
}

fn capsule(a: V, b: V, radius: f64, material: Material) -> Primitive {
    Primitive::new(Shape::Capsule { a, b, radius }, material)
}

fn hand(wrist: V, angle: f64) -> impl Iterator<Item = Primitive> {
    let palm = Primitive::new(
        Shape::Cuboid {
            centre: wrist + polar(0.0275, angle),
            rotation: *Rotation3::from_axis_angle(&Vector3::z_axis(), angle).matrix(),
            half_extents: Vector3::new(0.0275, 0.010, 0.030),
        },
        HAND,
    );
    let fingers = (0..4).map(move |k| {
        let lift = Vector3::z() * (0.0155 * (f64::from(k) - 1.5));
        let knuckle = wrist + polar(0.06, angle) + lift;
        capsule(knuckle, knuckle + polar(0.05, angle), 0.006, HAND)
    });
    std::iter::once(palm).chain(fingers)
}

/// Arm at shoulder and elbow angles [rad], with a target and an obstacle.
pub fn reaching(shoulder: f64, elbow: f64, target: V, obstacle: V) -> Vec<Primitive> {
    let elbow_at = polar(0.15, shoulder);
    let wrist = elbow_at + polar(0.13, shoulder + elbow);
    let depth = Vector3::z() * 0.15;
    let mut scene = vec![
        Primitive::new(
            Shape::Ground {
                height: -0.15,
                centre: [0.0, 0.10],
                half_extents: [0.45, 0.45],
                cell: 0.05,
            },
            GROUND,
        ),
        Primitive::target(target, 0.012),
        Primitive::new(
            Shape::Cylinder {
                a: obstacle - depth,
                b: obstacle + depth,
                radius: 0.035,
            },
            OBSTACLE,
        ),
        Primitive::new(
            Shape::Cylinder {
                a: -depth,
                b: Vector3::z() * 0.012,
                radius: 0.022,
            },
            Material::plain([92, 96, 104]),
        ),
        capsule(Vector3::zeros(), elbow_at, 0.010, ARM),
        capsule(elbow_at, wrist, 0.010, ARM),
    ];
    scene.extend(hand(wrist, shoulder + elbow));
    scene
}

/// The scene of the pictures and measurements: 11 primitives.
pub fn example() -> Vec<Primitive> {
    reaching(
        0.15,
        0.75,
        Vector3::new(-0.16, 0.27, 0.0),
        Vector3::new(0.02, 0.27, 0.0),
    )
}

/// A grasp of 20 primitives: a ball of 6 cm a
/// side 26 cm from the eye at (0, 0.10, 0.25) m, above a table, and a hand of
/// one box and 14 capsules on its forearm. `across` moves the hand over the
/// ball: at 0 m it is in the way of the eye, at 0.06 m beside the ball.
pub fn grasping(across: f64) -> Vec<Primitive> {
    let way = Vector3::new(0.25, 0.35, -0.9).normalize();
    let target = Vector3::new(0.0, 0.10, 0.25) + way * 0.26;
    let table = Shape::Cuboid {
        centre: target - Vector3::z() * 0.05,
        rotation: Matrix3::identity(),
        half_extents: Vector3::new(0.5, 0.5, 0.02),
    };
    let mut scene = vec![
        Primitive::new(table, GROUND),
        Primitive::target(target, 0.03),
    ];
    let at = |x: f64, y: f64, z: f64| target - way * 0.05 + Vector3::new(x + across, y, z);
    let palm = Shape::Cuboid {
        centre: at(0.0, -0.05, 0.0),
        rotation: turned(0.2, -0.1),
        half_extents: Vector3::new(0.035, 0.03, 0.01),
    };
    scene.push(Primitive::new(palm, HAND));
    let mut bone = |a: V, b: V, radius| scene.push(capsule(a, b, radius, HAND));
    for k in 0..4 {
        let x = 0.018 * (f64::from(k) - 1.5);
        bone(at(x, -0.02, 0.0), at(x, 0.01, 0.006), 0.008);
        bone(at(x, 0.01, 0.006), at(x, 0.03, -0.006), 0.0075);
        bone(at(x, 0.03, -0.006), at(x, 0.035, -0.024), 0.007);
    }
    bone(at(-0.03, -0.06, 0.0), at(-0.045, -0.03, -0.01), 0.009);
    bone(at(-0.045, -0.03, -0.01), at(-0.04, 0.0, -0.02), 0.008);
    bone(at(0.0, -0.08, 0.0), at(-0.05, -0.30, 0.02), 0.02);
    bone(at(-0.05, -0.30, 0.02), at(-0.15, -0.40, 0.1), 0.025);
    bone(at(-0.15, -0.40, 0.1), at(-0.15, -0.45, -0.1), 0.03);
    scene
}

/// Where the ball of [`grasping`] is.
pub fn grasped() -> V {
    Vector3::new(0.0, 0.10, 0.25) + Vector3::new(0.25, 0.35, -0.9).normalize() * 0.26
}

/// Trail of the fingertip as thin capsules.
pub fn trail() -> impl Iterator<Item = Primitive> {
    let point = |k: i32| {
        let share = f64::from(k) / 40.0;
        polar(0.34 - 0.06 * (3.0 * share).sin(), -0.4 + 1.2 * share)
    };
    (0..40).map(move |k| capsule(point(k), point(k + 1), 0.0018, TRAIL))
}

/// Eye ball and a short line of sight towards `target`.
pub fn eye_ball(target: V) -> [Primitive; 3] {
    let centre = Vector3::new(0.0, 0.10, 0.25);
    let forward = (target - centre).normalize();
    let ball = |centre, radius, colour| {
        Primitive::new(Shape::Sphere { centre, radius }, Material::plain(colour))
    };
    [
        ball(centre, 0.018, [245, 245, 242]),
        ball(centre + forward * 0.0085, 0.0115, [40, 44, 52]),
        capsule(
            centre + forward * 0.02,
            centre + forward * 0.09,
            0.0015,
            Material::plain([120, 124, 130]),
        ),
    ]
}

/// Columns are the axes of a box turned about z, then about x.
pub fn turned(about_z: f64, about_x: f64) -> Matrix3<f64> {
    (Rotation3::from_axis_angle(&Vector3::x_axis(), about_x)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), about_z))
    .into_inner()
}
