//! What a body refuses, and that the refusal names field, value and bound.

use babble_body::joints::{ARM_JOINTS, JOINT_NAMES, Joint};
use babble_body::{Body, BodyError};

fn refusal(change: impl FnOnce(&mut Body)) -> BodyError {
    let mut body = Body::paper();
    change(&mut body);
    body.validate().expect_err("this body should be refused")
}

#[test]
fn profiles_are_valid() {
    Body::paper().validate().unwrap();
    Body::icub().validate().unwrap();
}

/// 26 joints, 7 in the arm and 19 in the hand, of which two move. Catches a joint forgotten or
/// named twice.
#[test]
fn there_are_26_joints() {
    let body = Body::paper();
    let mut names = JOINT_NAMES.to_vec();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 26);
    assert!(names.iter().all(|name| body.joints.contains_key(*name)));
    let digits = ["thumb", "index", "middle", "ring", "little"];
    let in_hand = |name: &&&str| digits.iter().any(|digit| name.starts_with(digit));
    assert_eq!(names.iter().filter(in_hand).count(), 19);
    let free: Vec<_> = names
        .iter()
        .filter(|name| body.joints[**name].locked_deg.is_none())
        .collect();
    assert_eq!(free, [&"elbow", &"shoulder"]);
    assert_eq!(ARM_JOINTS, ["shoulder", "elbow"]);
}

type Field = fn(&mut Body) -> &mut f64;

/// Every length and every number of the muscles, set to what cannot be, is named with its value.
/// Catches a field that nobody checks: a NaN would run on into every posture.
#[test]
fn numbers_out_of_bounds_are_named() {
    let fields: [(&str, Field); 14] = [
        ("arm.upper_arm_m", |b| &mut b.arm.upper_arm_m),
        ("arm.forearm_m", |b| &mut b.arm.forearm_m),
        ("arm.half_width_m", |b| &mut b.arm.half_width_m),
        ("arm.density_kg_m3", |b| &mut b.arm.density_kg_m3),
        ("hand.palm_m", |b| &mut b.hand.palm_m),
        ("hand.palm_height_m", |b| &mut b.hand.palm_height_m),
        ("hand.finger_m[2]", |b| &mut b.hand.finger_m[2]),
        ("hand.thumb_m[0]", |b| &mut b.hand.thumb_m[0]),
        ("hand.finger_spacing_m", |b| &mut b.hand.finger_spacing_m),
        ("muscles.kp", |b| &mut b.muscles.kp),
        ("muscles.kd", |b| &mut b.muscles.kd),
        ("muscles.torque_max", |b| &mut b.muscles.torque_max),
        ("obstacle.radius_m", |b| &mut b.obstacle.radius_m),
        ("target.radius_m", |b| &mut b.target.radius_m),
    ];
    for (name, field) in fields {
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e9] {
            let error = refusal(|body| *field(body) = bad);
            assert!(
                matches!(&error, BodyError::OutOfBounds { field, value, bound }
                    if field == name && value.to_bits() == bad.to_bits() && bound.contains('[')),
                "{name} = {bad}: {error}"
            );
            assert!(error.to_string().starts_with(name), "{error}");
        }
    }
}

/// Ranges of joints: finite, in order, and wide enough for a joint that moves.
#[test]
fn ranges_of_joints_are_checked() {
    type Change = fn(&mut Joint);
    let cases: [(&str, &str, Change); 6] = [
        ("elbow", "lower_deg", |j| j.lower_deg = f64::NAN),
        ("elbow", "upper_deg", |j| j.upper_deg = j.lower_deg - 1.0),
        ("elbow", "upper_deg", |j| j.upper_deg = j.lower_deg + 0.5),
        ("shoulder", "lower_deg", |j| j.lower_deg = -1000.0),
        ("shoulder", "upper_deg", |j| {
            (j.lower_deg, j.upper_deg) = (-360.0, 360.0);
        }),
        ("wrist_roll", "locked_deg", |j| j.locked_deg = Some(91.0)),
    ];
    for (joint, field, change) in cases {
        let error = refusal(|body| change(body.joints.get_mut(joint).unwrap()));
        let path = format!("joints.{joint}.{field} = ");
        assert!(error.to_string().starts_with(&path), "{path}: {error}");
    }
}

/// Names are checked both ways: none too many, none too few.
#[test]
fn unknown_and_missing_joints_are_named() {
    let error = refusal(|body| {
        let joint = body.joints["elbow"];
        body.joints.insert("knee".to_owned(), joint);
    });
    assert!(matches!(&error, BodyError::UnknownJoint { name, .. } if name == "knee"));
    assert!(error.to_string().contains("wrist_flexion"), "{error}");
    let error = refusal(|body| {
        body.joints.remove("ring_2");
    });
    assert!(matches!(&error, BodyError::Lock { name, .. } if name == "ring_2"));
}

/// Shoulder and elbow move and all else stands. Catches a lock that is silently ignored.
#[test]
fn locks_are_checked() {
    for (name, lock) in [
        ("elbow", Some(10.0)),
        ("shoulder", Some(0.0)),
        ("thumb_1", None),
    ] {
        let error = refusal(|body| body.joints.get_mut(name).unwrap().locked_deg = lock);
        assert!(
            matches!(&error, BodyError::Lock { name: named, .. } if named == name),
            "{error}"
        );
    }
}

/// Inverse kinematics needs the plane and one branch; the obstacle must be as tall as the hand.
/// Catches bodies for which the reaching task would quietly compute something else.
#[test]
fn impossible_geometry_is_refused() {
    let lock = |name: &'static str, angle: f64| {
        move |body: &mut Body| body.joints.get_mut(name).unwrap().locked_deg = Some(angle)
    };
    let refusals = [
        (refusal(lock("shoulder_pitch", 10.0)), "shoulder_pitch"),
        (refusal(lock("shoulder_roll", 10.0)), "shoulder_roll"),
        (
            refusal(lock("wrist_deviation", 20.0)),
            "off the arm's plane",
        ),
        (refusal(lock("wrist_flexion", -60.0)), "two branches"),
        (
            refusal(|body| body.joints.get_mut("elbow").unwrap().lower_deg = -10.0),
            "two branches",
        ),
        (
            refusal(|body| body.joints.get_mut("elbow").unwrap().upper_deg = 190.0),
            "two branches",
        ),
        (refusal(|body| body.obstacle.height_m = 0.04), "height_m"),
    ];
    for (error, words) in refusals {
        assert!(matches!(error, BodyError::Geometry { .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// A build without rapier says so, and names the engine.
#[cfg(not(feature = "rapier"))]
#[test]
fn an_engine_that_is_not_built_in_is_refused() {
    let mut body = serde_json::to_value(Body::paper()).unwrap();
    body["engine"] = "rapier".into();
    let error = serde_json::from_value::<Body>(body)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("engine `rapier` is not part of this build"),
        "{error}"
    );
}
