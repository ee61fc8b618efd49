//! Laws of the arm's kinematics and of the skeleton behind it.

use std::f64::consts::PI;

use babble_body::arm::Segment;
use babble_body::skeleton::{self, BoneKind};
use babble_body::{Body, PlanarArm};
use nalgebra::Vector2;
use proptest::prelude::*;

/// The default body with the wrist locked at an angle.
fn bent_wrist(wrist_deg: f64) -> Body {
    let mut body = Body::paper();
    body.joints.get_mut("wrist_flexion").unwrap().locked_deg = Some(wrist_deg);
    body.validate().unwrap();
    body
}

/// The default body with fingers, thumb and wrist locked where `share` of their ranges says.
fn bent_hand(share: &[f64]) -> Body {
    let mut body = Body::paper();
    let bent = ["wrist_flexion", "thumb_1", "thumb_2", "index_1", "index_2"];
    for (name, share) in bent.into_iter().zip(share) {
        body.joints.get_mut(name).unwrap().locked_deg = Some(45.0 * share);
    }
    body
}

fn distance(segment: &Segment, point: Vector2<f64>) -> f64 {
    let along = segment.b - segment.a;
    let share = ((point - segment.a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (point - segment.a - along * share).norm()
}

/// Stretched, the hand is 11.6 cm long and the arm reaches 39.6 cm; each link is one segment, so
/// that a distance costs two projections. Catches a segment left out of a finger, and an outline
/// that keeps the collinear bones apart.
#[test]
fn default_body_measures_as_the_paper_says() {
    let body = Body::paper();
    let hand = body.hand.palm_m + body.hand.finger_m.iter().sum::<f64>();
    assert!((hand - 0.116).abs() < 1e-12);
    let arm = PlanarArm::new(&body);
    assert!((arm.length() - 0.396).abs() < 1e-12);
    assert_eq!(arm.tip_angle, 0.0);
    assert_eq!((arm.upper_segments.len(), arm.fore_segments.len()), (1, 1));
    let [upper, fore] = [arm.upper_segments[0], arm.fore_segments[0]];
    assert!(((upper.b - upper.a).norm() - 0.15).abs() < 1e-12);
    assert!(((fore.b - fore.a).norm() - 0.246).abs() < 1e-12);
    assert!((arm.fore_radius - 0.246).abs() < 1e-12);
}

/// Angles count counter-clockwise from +x, the elbow's from the upper arm. Catches a mirrored arm.
#[test]
fn known_postures() {
    let arm = PlanarArm::new(&Body::paper());
    let expected = [
        ([0.0, 0.0], [0.396, 0.0]),
        ([PI / 2.0, 0.0], [0.0, 0.396]),
        ([0.0, PI / 2.0], [0.15, 0.246]),
        ([PI / 2.0, PI / 2.0], [-0.246, 0.15]),
    ];
    for (q, tip) in expected {
        assert!((arm.fingertip(q) - Vector2::from(tip)).norm() < 1e-12);
    }
}

/// No posture for what is out of reach on either side, or no number. Catches a clamped arccosine.
#[test]
fn out_of_reach_has_no_posture() {
    let arm = PlanarArm::new(&Body::paper());
    for [x, y] in [[0.3961, 0.0], [0.0, -0.5], [0.0959, 0.0], [0.0, 0.0]] {
        assert_eq!(arm.posture_at(Vector2::new(x, y)), None, "{x} {y}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(arm.posture_at(Vector2::new(bad, 0.1)), None);
    }
}

proptest! {
    /// IK(FK(q)) = q everywhere in the joint ranges, with a straight and a bent wrist. Catches the
    /// other branch of the elbow, a shoulder off by a turn and a tip angle of the wrong sign.
    #[test]
    fn inverse_undoes_forward(share in prop::array::uniform2(0.0..1.0), wrist in -4.0..45.0) {
        for body in [Body::paper(), Body::icub(), bent_wrist(wrist)] {
            let arm = PlanarArm::new(&body);
            let q = arm.denormalised(share);
            let back = arm.posture_at(arm.fingertip(q)).unwrap();
            for i in 0..2 {
                prop_assert!((back[i] - q[i]).abs() < 1e-9, "{q:?} came back as {back:?}");
            }
        }
    }

    /// FK(IK(x)) = x for every point within reach, in the joint ranges or not.
    #[test]
    fn forward_undoes_inverse(share in 0.001..0.999, angle in -PI..PI, wrist in -4.0..45.0) {
        for body in [Body::paper(), bent_wrist(wrist)] {
            let arm = PlanarArm::new(&body);
            let (near, far) = ((arm.reach - arm.upper).abs(), arm.length());
            let radius = near + share * (far - near);
            let point = Vector2::new(radius * angle.cos(), radius * angle.sin());
            let q = arm.posture_at(point).unwrap();
            prop_assert!((arm.fingertip(q) - point).norm() < 1e-12);
        }
    }

    /// The planar arm is the skeleton seen from above: the same fingertip and elbow, bent wrist
    /// included. Catches a rotation about the wrong axis and a hand hung on the wrong link.
    #[test]
    fn planar_arm_is_the_skeleton(share in prop::array::uniform2(0.0..1.0), wrist in -4.0..45.0) {
        let body = bent_wrist(wrist);
        let arm = PlanarArm::new(&body);
        let q = arm.denormalised(share);
        let (bones, tip) = skeleton::bones(&body, &skeleton::joint_angles(&body.joints, q));
        let pose = arm.place(q);
        prop_assert!((tip.xy() - pose.tip).norm() < 1e-12);
        prop_assert!((bones[0].b.xy() - pose.elbow).norm() < 1e-12);
        prop_assert!(tip.z.abs() < 1e-12);
    }

    /// The merged outline covers every bone and nothing else, however the hand is bent. Catches a
    /// digit dropped by the merge, and collinear bones with a gap joined across it.
    #[test]
    fn outline_covers_the_bones(bend in prop::collection::vec(0.0..1.0, 5)) {
        let body = bent_hand(&bend);
        let arm = PlanarArm::new(&body);
        let (bones, _) = skeleton::bones(&body, &skeleton::joint_angles(&body.joints, [0.0, 0.0]));
        let elbow = Vector2::new(arm.upper, 0.0);
        let near = |segments: &[Segment], point| {
            segments.iter().map(|s| distance(s, point)).fold(f64::INFINITY, f64::min)
        };
        for bone in bones.iter().filter(|bone| bone.kind != BoneKind::UpperArm) {
            for end in [bone.a.xy(), bone.b.xy(), (bone.a.xy() + bone.b.xy()) / 2.0] {
                prop_assert!(near(&arm.fore_segments, end - elbow) < 1e-8);
            }
        }
        let flat: Vec<Segment> = bones
            .iter()
            .filter(|bone| bone.kind != BoneKind::UpperArm)
            .map(|bone| Segment { a: bone.a.xy() - elbow, b: bone.b.xy() - elbow })
            .filter(|s| (s.b - s.a).norm() > 0.0)
            .collect();
        for segment in &arm.fore_segments {
            for k in 0..=20 {
                let point = segment.a + (segment.b - segment.a) * (f64::from(k) / 20.0);
                prop_assert!(near(&flat, point) < 1e-8);
                prop_assert!(point.norm() <= arm.fore_radius + 1e-12);
            }
        }
    }

    /// Shares of the joint ranges and angles are the same thing said twice; clamping ends in range.
    #[test]
    fn shares_and_angles(q in prop::array::uniform2(-10.0..10.0)) {
        let arm = PlanarArm::new(&Body::paper());
        let back = arm.denormalised(arm.normalised(q));
        prop_assert!((0..2).all(|i| (back[i] - q[i]).abs() < 1e-12));
        let inside = arm.clamp(q);
        prop_assert!(arm.in_range(inside));
        prop_assert_eq!(arm.in_range(q), inside == q);
    }
}
