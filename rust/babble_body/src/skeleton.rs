//! The links of arm and hand for a posture of all 26 joints.
//!
//! At zero everything lies along +x. Each link is a bone from `a` to `b`; the hand is on edge, so
//! that the fingers lie above one another and flex in the plane of motion.

use nalgebra::{Matrix3, Vector3};

use crate::config::Body;
use crate::geometry::frame::Frame;
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
    /// A segment of the thumb.
    Thumb,
    /// A segment of a finger.
    Finger,
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
    let shoulder = Frame {
        origin: Vector3::zeros(),
        rotation: Matrix3::identity(),
    }
    .turned(&z, posture[0])
    .turned(&y, posture[1])
    .turned(&x, posture[2]);
    let elbow = push(
        &mut bones,
        BoneKind::UpperArm,
        shoulder,
        body.arm.upper_arm_m,
    )
    .turned(&z, posture[3]);
    let wrist = push(&mut bones, BoneKind::Forearm, elbow, body.arm.forearm_m)
        .turned(&z, posture[4])
        .turned(&y, posture[5])
        .turned(&x, posture[6]);
    let knuckles = push(&mut bones, BoneKind::Palm, wrist, body.hand.palm_m);
    digit(
        &mut bones,
        BoneKind::Thumb,
        wrist,
        &body.hand.thumb_m,
        &posture[7..11],
    );
    let mut fingertip = Vector3::zeros();
    for (finger, (pivot, flexion)) in [(Some(11), 12), (None, 15), (Some(18), 19), (Some(22), 23)]
        .into_iter()
        .enumerate()
    {
        let height = (1.5 - finger as f64) * body.hand.finger_spacing_m;
        let base = knuckles.shifted(Vector3::new(0.0, 0.0, height));
        let angles = [
            pivot.map_or(0.0, |joint: usize| posture[joint]),
            posture[flexion],
            posture[flexion + 1],
            posture[flexion + 2],
        ];
        let lengths = &body.hand.finger_m;
        fingertip += digit(&mut bones, BoneKind::Finger, base, lengths, &angles) / 4.0;
    }
    (bones, fingertip)
}

/// A pivot about the palm's normal, then three flexions, the thumb's clockwise; returns the tip.
fn digit(
    bones: &mut Vec<Bone>,
    kind: BoneKind,
    base: Frame,
    lengths: &[f64; 4],
    angles: &[f64],
) -> Vector3<f64> {
    let side = if kind == BoneKind::Thumb { -1.0 } else { 1.0 };
    let mut frame = base.turned(&Vector3::y(), angles[0]);
    for (segment, length) in lengths.iter().enumerate() {
        if segment > 0 {
            frame = frame.turned(&Vector3::z(), side * angles[segment]);
        }
        frame = push(bones, kind, frame, *length);
    }
    frame.origin
}

fn push(bones: &mut Vec<Bone>, kind: BoneKind, frame: Frame, length: f64) -> Frame {
    let end = frame.shifted(Vector3::new(length, 0.0, 0.0));
    bones.push(Bone {
        kind,
        a: frame.origin,
        b: end.origin,
    });
    end
}
