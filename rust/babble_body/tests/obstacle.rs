//! Clearance against parry3d, and that no touch is missed between two postures.

mod spread;

use babble_body::arm::sweep;
use babble_body::skeleton;
use babble_body::{Body, ContactWatch, Obstacle, PlanarArm};
use nalgebra::Vector2;
use parry3d::math::{Pose, Vector};
use parry3d::query;
use parry3d::shape::Segment;
use proptest::prelude::*;
use spread::spread;

/// Sub-steps of the brute-force search.
const FINE: u32 = 20_000;

/// Distance in space of the cylinder to the nearest bone, each a capsule as wide as the arm. Between
/// the axes parry's distance is exact; from its cylinder shape it is iterated, to a millimetre.
fn parry_distance(body: &Body, obstacle: &Obstacle, q: [f64; 2]) -> f64 {
    let single = |v: nalgebra::Vector3<f64>| Vector::new(v.x as f32, v.y as f32, v.z as f32);
    let half = body.obstacle.height_m / 2.0;
    let end = |z| single(obstacle.centre.push(z));
    let axis = Segment::new(end(-half), end(half));
    let (bones, _) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, q));
    let to_bone = |bone: &skeleton::Bone| {
        let bone = Segment::new(single(bone.a), single(bone.b));
        let found = query::distance(&Pose::IDENTITY, &bone, &Pose::IDENTITY, &axis);
        f64::from(found.unwrap().distance)
    };
    let between_axes = bones.iter().map(to_bone).fold(f64::INFINITY, f64::min);
    between_axes - obstacle.radius - body.arm.half_width_m
}

fn bent() -> Body {
    let mut body = Body::paper();
    for (name, angle) in [("wrist_flexion", 30.0), ("thumb_1", 80.0), ("ring_2", 60.0)] {
        body.joints.get_mut(name).unwrap().locked_deg = Some(angle);
    }
    body.validate().unwrap();
    body
}

fn obstacle_near(arm: &PlanarArm, [x, y]: [f64; 2], radius: f64) -> Obstacle {
    let reach = arm.length() + 0.05;
    let centre = Vector2::new((2.0 * x - 1.0) * reach, (2.0 * y - 1.0) * reach);
    Obstacle { centre, radius }
}

/// The clearance in the plane is the distance in space, with a stretched and a bent hand, and
/// below 0 where the solids overlap. Catches a bone or a half-width left out, and the
/// forearm measured in the upper arm's frame.
#[test]
fn clearance_is_the_distance_of_the_solids() {
    for body in [Body::paper(), Body::icub(), bent()] {
        let arm = PlanarArm::new(&body);
        for k in 0..2000 {
            let q = arm.denormalised(spread(k));
            let obstacle =
                obstacle_near(&arm, spread(k + 5000), 0.005 + 0.04 * spread(k + 9000)[0]);
            let (ours, theirs) = (
                obstacle.clearance(&arm, q),
                parry_distance(&body, &obstacle, q),
            );
            assert!(
                (ours - theirs).abs() < 1e-6,
                "{ours} m, parry {theirs} m at {q:?}"
            );
        }
    }
}

fn between(from: [f64; 2], to: [f64; 2], share: f64) -> [f64; 2] {
    [0, 1].map(|i| from[i] + share * (to[i] - from[i]))
}

/// A millimetre of wire, passed at full speed within one step, far from it before and after.
/// Catches testing the ends of a step alone.
#[test]
fn thin_obstacle_is_not_passed_through() {
    let arm = PlanarArm::new(&Body::paper());
    let (from, to) = ([0.2, 0.6], [2.2, 0.6]);
    let hand = arm.fingertip([1.2, 0.6]) * 0.9;
    let wire = Obstacle {
        centre: hand,
        radius: 5e-4,
    };
    let [before, after] = [from, to].map(|q| wire.clearance(&arm, q));
    assert!(before > 0.05 && after > 0.05);
    let touch = wire
        .first_touch(&arm, from, to, [before, after])
        .expect("the arm sweeps over the wire");
    assert!(wire.clearance(&arm, between(from, to, touch)).abs() < 1e-6);
}

/// A wire on the way of the fingertip of a thin, stretched arm: the motion for which the bound on
/// the sweep is tight, to one part in a hundred. Catches a bound that is a little too small.
#[test]
fn touch_at_the_fingertip_is_not_pruned() {
    let mut body = Body::paper();
    body.arm.half_width_m = 1e-4;
    let arm = PlanarArm::new(&body);
    for turn in [0.05, 0.1, 0.2] {
        let (from, to) = ([1.0, arm.lower[1]], [1.0 + turn, arm.lower[1]]);
        let wire = Obstacle {
            centre: arm.fingertip(between(from, to, 0.5)) * 0.9999,
            radius: 1e-4,
        };
        let (before, after) = (wire.clearance(&arm, from), wire.clearance(&arm, to));
        assert!(before + after > 0.95 * sweep(&arm, from, to));
        let touch = wire.first_touch(&arm, from, to, [before, after]);
        assert!(
            touch.is_some_and(|share| (0.4..0.5).contains(&share)),
            "{touch:?}"
        );
    }
}

proptest! {
    /// No point of the arm moves further than the sweep says. Catches a bound without the forearm's
    /// share of the shoulder's motion, or with the fingertip for the farthest point.
    #[test]
    fn sweep_bounds_every_motion(
        shares in prop::array::uniform4(0.0..1.0), step in 1e-4..1.0,
        centre in prop::array::uniform2(0.0..1.0),
    ) {
        for body in [Body::paper(), bent()] {
            let arm = PlanarArm::new(&body);
            let from = arm.denormalised([shares[0], shares[1]]);
            let to = between(from, arm.denormalised([shares[2], shares[3]]), step);
            let obstacle = obstacle_near(&arm, centre, 0.03);
            let change = (obstacle.clearance(&arm, to) - obstacle.clearance(&arm, from)).abs();
            prop_assert!(change <= sweep(&arm, from, to) + 1e-12);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Against 20,000 sub-steps of a motion as wide as the joint ranges: what they touch is found,
    /// the arm touches where it is said to, and nothing before. Catches a search that prunes too
    /// early, returns the second touch, or tests one half alone.
    #[test]
    fn first_touch_is_the_first_and_none_is_missed(
        shares in prop::array::uniform4(0.0..1.0),
        at in prop::array::uniform2(0.0..1.0),
        radius in 1e-4..0.05,
    ) {
        let arm = PlanarArm::new(&Body::paper());
        let (from, to) = (
            arm.denormalised([shares[0], shares[1]]),
            arm.denormalised([shares[2], shares[3]]),
        );
        let obstacle = obstacle_near(&arm, at, radius);
        let clearance = |share: f64| obstacle.clearance(&arm, between(from, to, share));
        let brute = (0..=FINE).map(|k| f64::from(k) / f64::from(FINE)).find(|&s| clearance(s) <= 0.0);
        let touch = obstacle.first_touch(&arm, from, to, [0.0, 1.0].map(clearance));
        if let Some(brute) = brute {
            let touch = touch.expect("a touch was missed");
            let late = (touch - brute) * sweep(&arm, from, to);
            prop_assert!(late < 1e-6, "touch at {touch}, brute force at {brute}");
        }
        if let Some(touch) = touch {
            prop_assert!(clearance(touch) <= 1e-9);
            // The reported moment is late by a micrometre of motion at most.
            prop_assert!(touch == 0.0 || clearance(touch) > -2e-6);
        }
    }

    /// A watch that skips queries tells the same as one that queries at every step, along walks
    /// that come and go, touching or not. Catches a bound that does not shrink, or that is not
    /// renewed after a query.
    #[test]
    fn watch_equals_asking_at_every_step(
        start in prop::array::uniform2(0.0..1.0),
        at in prop::array::uniform2(0.0..1.0),
        radius in 1e-3..0.05,
        pace in 1e-3..0.1,
        seed in 0_usize..1_000_000,
    ) {
        let arm = PlanarArm::new(&Body::paper());
        let obstacle = obstacle_near(&arm, at, radius);
        let mut from = arm.denormalised(start);
        let mut watch = ContactWatch::new(Some(obstacle), &arm, from);
        let mut nothing = ContactWatch::new(None, &arm, from);
        for k in 0..200 {
            // A heading that lasts for 20 steps.
            let heading = spread(seed + k / 20);
            let to = arm.clamp([0, 1].map(|i| from[i] + pace * (heading[i] - 0.5)));
            let clearances = [from, to].map(|q| obstacle.clearance(&arm, q));
            let asked = obstacle.first_touch(&arm, from, to, clearances);
            prop_assert_eq!(watch.touch(&arm, from, to), asked);
            prop_assert_eq!(nothing.touch(&arm, from, to), None);
            from = to;
        }
    }
}
