//! The 26 joints of arm and hand (paper Sect. II-C: 7 in the arm, 19 in the hand).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::error::{BodyError, within};

/// Names of the 26 joints, from the shoulder outwards.
///
/// The hand's 19 are the thumb's 4 and 4 for each finger, less the middle finger's pivot, which is
/// fixed as on the iCub.
pub const JOINT_NAMES: [&str; 26] = [
    "shoulder",
    "shoulder_pitch",
    "shoulder_roll",
    "elbow",
    "wrist_flexion",
    "wrist_deviation",
    "wrist_roll",
    "thumb_pivot",
    "thumb_1",
    "thumb_2",
    "thumb_3",
    "index_pivot",
    "index_1",
    "index_2",
    "index_3",
    "middle_1",
    "middle_2",
    "middle_3",
    "ring_pivot",
    "ring_1",
    "ring_2",
    "ring_3",
    "little_pivot",
    "little_1",
    "little_2",
    "little_3",
];

/// The two joints that move in reaching: shoulder and elbow, both about the vertical.
pub const ARM_JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// One joint: its range, and the angle it is locked at if it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Lower end of the range \[deg\].
    pub lower_deg: f64,
    /// Upper end of the range \[deg\].
    pub upper_deg: f64,
    /// Angle at which the joint is held \[deg\]; none for a joint that moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub locked_deg: Option<f64>,
}

/// All joints by name.
pub type Joints = BTreeMap<String, Joint>;

/// The 26 joints with the ranges given for shoulder and elbow, everything else locked at 0, which
/// stretches the hand and folds the thumb in line with it.
#[must_use]
pub fn reaching_joints(shoulder_deg: [f64; 2], elbow_deg: [f64; 2]) -> Joints {
    let joint = |name: &str| match name {
        "shoulder" => free(shoulder_deg),
        "elbow" => free(elbow_deg),
        _ if name.starts_with("shoulder") || name.starts_with("wrist") => locked([-90.0, 90.0]),
        _ if name.ends_with("pivot") => locked([-20.0, 20.0]),
        _ => locked([0.0, 90.0]),
    };
    JOINT_NAMES
        .iter()
        .map(|&name| (name.to_owned(), joint(name)))
        .collect()
}

fn free([lower_deg, upper_deg]: [f64; 2]) -> Joint {
    Joint {
        lower_deg,
        upper_deg,
        locked_deg: None,
    }
}

fn locked([lower_deg, upper_deg]: [f64; 2]) -> Joint {
    Joint {
        lower_deg,
        upper_deg,
        locked_deg: Some(0.0),
    }
}

/// Checks names, ranges and locks.
///
/// # Errors
/// [`BodyError::UnknownJoint`], [`BodyError::OutOfBounds`] or [`BodyError::Lock`].
pub fn validate(joints: &Joints) -> Result<(), BodyError> {
    if let Some(name) = joints
        .keys()
        .find(|name| !JOINT_NAMES.contains(&name.as_str()))
    {
        return Err(BodyError::UnknownJoint {
            name: name.clone(),
            known: JOINT_NAMES.join(", "),
        });
    }
    for name in JOINT_NAMES {
        let joint = joints.get(name).ok_or_else(|| BodyError::Lock {
            name: name.to_owned(),
            problem: "the joint is missing".to_owned(),
        })?;
        validate_joint(name, joint)?;
    }
    Ok(())
}

fn validate_joint(name: &str, joint: &Joint) -> Result<(), BodyError> {
    within(
        &format!("joints.{name}.lower_deg"),
        joint.lower_deg,
        -360.0,
        360.0,
    )?;
    within(
        &format!("joints.{name}.upper_deg"),
        joint.upper_deg,
        joint.lower_deg,
        360.0,
    )?;
    let moves = ARM_JOINTS.contains(&name);
    match joint.locked_deg {
        Some(angle) if !moves => within(
            &format!("joints.{name}.locked_deg"),
            angle,
            joint.lower_deg,
            joint.upper_deg,
        ),
        None if moves => within(
            &format!("joints.{name}.upper_deg"),
            joint.upper_deg,
            joint.lower_deg + 1.0,
            joint.lower_deg + 360.0,
        ),
        Some(_) => Err(lock(
            name,
            "this joint moves in reaching and cannot be locked",
        )),
        None => Err(lock(
            name,
            "only shoulder and elbow move in reaching; give an angle",
        )),
    }
}

fn lock(name: &str, problem: &str) -> BodyError {
    BodyError::Lock {
        name: name.to_owned(),
        problem: problem.to_owned(),
    }
}
