//! The links of arm and hand for a posture of all 26 joints.
//!
//! At zero everything lies along +x. Each link is a bone from `a` to `b`; the hand is on edge, so
//! that the fingers lie above one another and flex in the plane of motion.

use nalgebra::{Rotation3, Vector3};

use crate::config::Body;
use crate::error::BodyError;
use crate::joints::{JOINT_NAMES, Joints};

/// Which piece of arm or hand a bone is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoneKind {
    /// Moves with the shoulder alone.
    UpperArm,
    /// Moves with the shoulder and the elbow.
    Forearm,
    /// The palm, carried by the forearm.
    Palm,
    /// A segment of a finger or the thumb.
    Digit,
}

/// A straight link with round ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    /// Which piece it is.
    pub kind: BoneKind,
    /// Near end \[m\].
    pub a: Vector3<f64>,
    /// Far end \[m\].
    pub b: Vector3<f64>,
}

/// A moving frame that walks down the chain of links.
#[derive(Clone, Copy)]
struct Frame {
    origin: Vector3<f64>,
    rotation: Rotation3<f64>,
}

impl Frame {
    const fn at(origin: Vector3<f64>, rotation: Rotation3<f64>) -> Self {
        Self { origin, rotation }
    }

    fn turn(self, axis: &Vector3<f64>, angle: f64) -> Self {
        if angle == 0.0 {
            return self;
        }
        // Rodrigues' formula through libm: the same bits on every platform.
        let (s, c) = libm::sincos(angle);
        let k = axis.cross_matrix();
        let matrix = nalgebra::Matrix3::identity() + k * s + k * k * (1.0 - c);
        Self {
            rotation: self.rotation * Rotation3::from_matrix_unchecked(matrix),
            ..self
        }
    }

    fn forward(self, length: f64) -> Self {
        self.shift(Vector3::new(length, 0.0, 0.0))
    }

    fn shift(self, by: Vector3<f64>) -> Self {
        Self {
            origin: self.origin + self.rotation * by,
            ..self
        }
    }
}

/// Angles \[rad\] of the 26 joints in the order of [`JOINT_NAMES`].
pub type JointAngles = [f64; 26];

/// The locked angles of `joints`, with the arm's two free joints at `q` \[rad\].
#[must_use]
pub fn joint_angles(joints: &Joints, q: [f64; 2]) -> JointAngles {
    JOINT_NAMES.map(|name| match name {
        "shoulder" => q[0],
        "elbow" => q[1],
        _ => joints
            .get(name)
            .and_then(|joint| joint.locked_deg)
            .unwrap_or(0.0)
            .to_radians(),
    })
}

/// All bones, from the upper arm to the little finger, and the point that reaches: the middle of
/// the four fingertips.
#[must_use]
pub fn bones(body: &Body, posture: &JointAngles) -> (Vec<Bone>, Vector3<f64>) {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let mut bones = Vec::with_capacity(20);
    let shoulder = Frame::at(Vector3::zeros(), Rotation3::identity())
        .turn(&z, posture[0])
        .turn(&y, posture[1])
        .turn(&x, posture[2]);
    let elbow = push(
        &mut bones,
        BoneKind::UpperArm,
        shoulder,
        body.arm.upper_arm_m,
    )
    .turn(&z, posture[3]);
    let wrist = push(&mut bones, BoneKind::Forearm, elbow, body.arm.forearm_m)
        .turn(&z, posture[4])
        .turn(&y, posture[5])
        .turn(&x, posture[6]);
    let knuckles = push(&mut bones, BoneKind::Palm, wrist, body.hand.palm_m);
    digit(&mut bones, wrist, &body.hand.thumb_m, &posture[7..11], -1.0);
    let mut fingertip = Vector3::zeros();
    for (finger, (pivot, flexion)) in [(Some(11), 12), (None, 15), (Some(18), 19), (Some(22), 23)]
        .into_iter()
        .enumerate()
    {
        let height = (1.5 - finger as f64) * body.hand.finger_spacing_m;
        let base = knuckles.shift(Vector3::new(0.0, 0.0, height));
        let angles = [
            pivot.map_or(0.0, |joint: usize| posture[joint]),
            posture[flexion],
            posture[flexion + 1],
            posture[flexion + 2],
        ];
        fingertip += digit(&mut bones, base, &body.hand.finger_m, &angles, 1.0) / 4.0;
    }
    (bones, fingertip)
}

/// A pivot about the palm's normal, then three flexions; returns the tip.
fn digit(
    bones: &mut Vec<Bone>,
    base: Frame,
    lengths: &[f64; 4],
    angles: &[f64],
    side: f64,
) -> Vector3<f64> {
    let mut frame = base.turn(&Vector3::y(), angles[0]);
    for (segment, length) in lengths.iter().enumerate() {
        if segment > 0 {
            frame = frame.turn(&Vector3::z(), side * angles[segment]);
        }
        frame = push(bones, BoneKind::Digit, frame, *length);
    }
    frame.origin
}

fn push(bones: &mut Vec<Bone>, kind: BoneKind, frame: Frame, length: f64) -> Frame {
    let end = frame.forward(length);
    bones.push(Bone {
        kind,
        a: frame.origin,
        b: end.origin,
    });
    end
}

/// The elbow must turn about the vertical and the fingertip lie in the plane of motion, or the
/// inverse kinematics of Sect. III-A does not exist; the obstacle must be as tall as the arm.
pub(crate) fn validate_plane(body: &Body) -> Result<(), BodyError> {
    const TOLERANCE_M: f64 = 1e-9;
    let (bones, tip) = bones(body, &joint_angles(&body.joints, [0.0, 0.5]));
    if bones[0].b.z.abs() > TOLERANCE_M || body.joints["shoulder_roll"].locked_deg != Some(0.0) {
        return Err(BodyError::Geometry {
            problem:
                "shoulder_pitch and shoulder_roll must be locked at 0: the arm moves in its plane"
                    .to_owned(),
        });
    }
    if tip.z.abs() > TOLERANCE_M {
        return Err(BodyError::Geometry {
            problem: format!(
                "the locked joints put the fingertip {:.4} m off the arm's plane",
                tip.z
            ),
        });
    }
    let half = body.obstacle.height_m / 2.0;
    let top = bones
        .iter()
        .flat_map(|bone| [bone.a.z.abs(), bone.b.z.abs()])
        .fold(0.0, f64::max);
    let top = top.max(body.hand.palm_height_m / 2.0);
    if top > half {
        return Err(BodyError::Geometry {
            problem: format!(
                "obstacle.height_m = {} must be at least {:.3}, so that arm and hand cannot pass above it",
                body.obstacle.height_m,
                2.0 * top
            ),
        });
    }
    Ok(())
}
