//! What the eye and an onlooker can see of the robot and its world.

use nalgebra::{Matrix3, Vector3};

use crate::config::Body;
use crate::geometry::obstacle::Obstacle;
use crate::skeleton::{self, Bone, BoneKind};
use babble_eye::{Gaze, Material, Primitive, Shape};

pub(crate) const SLEEVE: Material = Material::plain([92, 134, 178]);
pub(crate) const FOREARM: Material = Material::plain([112, 154, 196]);
pub(crate) const SKIN: Material = Material::plain([228, 184, 150]);
const OBSTACLE: Material = Material::plain([96, 108, 120]);
const EYE_WHITE: Material = Material::plain([236, 236, 230]);
const PUPIL: Material = Material::plain([40, 44, 52]);
const GAZE: Material = Material::plain([120, 190, 120]);
const TRAIL: Material = Material::plain([46, 160, 120]);
const GROUND: Material = Material::plain([196, 196, 188]);
/// Radius of the eye \[m\].
const BALL_M: f64 = 0.018;

/// A thing to be seen, and the name of what it belongs to: "forearm", "thumb", "obstacle" ...
pub type Part = (&'static str, Primitive);

/// Arm and hand in full: sleeves, palm and every digit.
#[must_use]
pub fn robot(body: &Body, q: [f64; 2]) -> Vec<Part> {
    let (bones, _) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, q));
    let width = body.arm.half_width_m;
    let digit = width.min(0.4 * body.hand.finger_spacing_m);
    let part = |bone: &Bone| match bone.kind {
        BoneKind::UpperArm => ("upper_arm", capsule(bone, width, SLEEVE)),
        BoneKind::Forearm => ("forearm", capsule(bone, width, FOREARM)),
        BoneKind::Palm => ("palm", palm(bone, width, body.hand.palm_height_m)),
        BoneKind::Thumb => ("thumb", capsule(bone, digit, SKIN)),
        BoneKind::Finger => ("finger", capsule(bone, digit, SKIN)),
    };
    bones.iter().map(part).collect()
}

fn capsule(bone: &Bone, radius: f64, material: Material) -> Primitive {
    let shape = Shape::Capsule {
        a: bone.a,
        b: bone.b,
        radius,
    };
    Primitive::new(shape, material)
}

fn palm(bone: &Bone, half_width: f64, height: f64) -> Primitive {
    let along = (bone.b - bone.a).normalize();
    let across = Vector3::z().cross(&along).normalize();
    let shape = Shape::Cuboid {
        centre: (bone.a + bone.b) / 2.0,
        rotation: Matrix3::from_columns(&[along, across, along.cross(&across)]),
        half_extents: Vector3::new((bone.b - bone.a).norm() / 2.0, half_width, height / 2.0),
    };
    Primitive::new(shape, SKIN)
}

/// The red sphere at a point of the plane.
#[must_use]
pub fn target(body: &Body, at: [f64; 2]) -> Primitive {
    Primitive::target(Vector3::new(at[0], at[1], 0.0), body.target.radius_m)
}

/// A flat disc below the plane of motion, where an object is to be carried.
#[must_use]
pub fn goal(at: [f64; 2]) -> Primitive {
    const RADIUS_M: f64 = 0.02;
    let end = |z| Vector3::new(at[0], at[1], z);
    let shape = Shape::Cylinder {
        a: end(-0.036),
        b: end(-0.034),
        radius: RADIUS_M,
    };
    Primitive::new(shape, TRAIL)
}

/// The vertical cylinder, half of it above the plane.
#[must_use]
pub fn obstacle(body: &Body, obstacle: &Obstacle) -> Primitive {
    let half = body.obstacle.height_m / 2.0;
    let end = |z| Vector3::new(obstacle.centre.x, obstacle.centre.y, z);
    let shape = Shape::Cylinder {
        a: end(-half),
        b: end(half),
        radius: obstacle.radius,
    };
    Primitive::new(shape, OBSTACLE)
}

/// What stands around the robot in a picture from outside: ground, eye ball and line of gaze.
pub fn push_surroundings(
    scene: &mut Vec<Primitive>,
    body: &Body,
    gaze: Gaze,
    eye: &babble_eye::Eye,
) {
    let centre = Vector3::from(body.eye.position_m);
    let forward: Vector3<f64> = eye.camera(gaze).rotation.row(2).transpose();
    scene.push(eye_ball(body));
    let pupil = centre + forward * (0.62 * BALL_M);
    scene.push(Primitive::new(
        Shape::Sphere {
            centre: pupil,
            radius: 0.5 * BALL_M,
        },
        PUPIL,
    ));
    if let Some([x, y]) = eye.target_in_plane(gaze, 0.0) {
        let line = Shape::Capsule {
            a: centre,
            b: Vector3::new(x, y, 0.0),
            radius: 0.001,
        };
        scene.push(Primitive::new(line, GAZE));
    }
    scene.push(ground(body));
}

/// The eye, as others see it.
#[must_use]
pub fn eye_ball(body: &Body) -> Primitive {
    let shape = Shape::Sphere {
        centre: body.eye.position_m.into(),
        radius: BALL_M,
    };
    Primitive::new(shape, EYE_WHITE)
}

/// The ground on which the obstacle stands.
#[must_use]
pub fn ground(body: &Body) -> Primitive {
    let height = -body.obstacle.height_m / 2.0;
    let shape = Shape::Ground {
        height,
        centre: [0.0, 0.1],
        half_extents: [0.6, 0.6],
        cell: 0.1,
    };
    Primitive::new(shape, GROUND)
}

/// The way of the fingertip, as a thin line in the plane.
pub fn push_trail(scene: &mut Vec<Primitive>, tips: &[nalgebra::Vector2<f64>]) {
    const STEP_M: f64 = 0.004;
    let mut last: Option<nalgebra::Vector2<f64>> = None;
    for (i, &tip) in tips.iter().enumerate() {
        let Some(from) = last else {
            last = Some(tip);
            continue;
        };
        if (tip - from).norm() < STEP_M && i + 1 < tips.len() {
            continue;
        }
        let end = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let shape = Shape::Capsule {
            a: end(from),
            b: end(tip),
            radius: 0.002,
        };
        scene.push(Primitive::new(shape, TRAIL));
        last = Some(tip);
    }
}
