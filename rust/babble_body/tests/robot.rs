//! The robot that grasps, against closed forms, and each trap of rapier, in both engines.

mod grasping;
mod spread;

use std::f64::consts::FRAC_PI_2;

use babble_body::config::Fingers;
use babble_body::robot::{Ball, MuscleCommand, Robot, Setup, towards};
use babble_body::{ArmState, Body, Dynamics, Obstacle, PlanarArm, Pull};
use grasping::{DT, FAR, ball_at_palm, bytes, reflex, robots, run, setup, with};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use spread::spread;

fn robot() -> Robot {
    with(|_| ())
}

/// Both kinds of fingers in every engine.
fn all_robots() -> impl Iterator<Item = Robot> {
    [Fingers::Virtual, Fingers::Independent]
        .into_iter()
        .flat_map(robots)
}

/// The arm moves as reaching's closed form does with the same muscles. Catches an inertia, a
/// damping or a spring that is not the arm's, and springs on the wrong joints.
#[test]
fn free_motion_is_the_closed_form() {
    let mut body = Body::paper();
    let robot = Robot::new(&body, DT);
    body.muscles = body.grip.arm_muscles;
    let arm = PlanarArm::new(&body);
    let dynamics = Dynamics::new(&body, &arm);
    let mut worst: f64 = 0.0;
    for seed in 0..8 {
        let mut state = ArmState::at_rest(arm.denormalised(spread(1000 * seed + 999)));
        let mut world = robot.world(&setup(robot.open_hand(state.q), FAR));
        for step in 0..1200 {
            let q_des = arm.denormalised(spread(1000 * seed + step / 100));
            state = dynamics.step(state, Pull::Towards(q_des), DT);
            robot.step(&mut world, &towards(robot.open_hand(q_des)));
            let posture = robot.posture(&world);
            for (ours, theirs) in state.q.into_iter().zip(posture) {
                worst = worst.max((ours - theirs).abs());
            }
        }
    }
    println!("largest difference: {:.3} mrad", 1e3 * worst);
    assert!(worst < 5e-3, "{worst} rad");
}

/// The hand's joints approach their equilibrium points with the time constant `K_D / K_P`. Catches
/// the engine's own joint damping of 0.1 N·m·s/rad (which would make it 1.2 s), damping indexed
/// while the root still counts as free, and thumb or fingers that drag each other.
#[test]
fn the_hand_closes_with_its_time_constant() {
    for robot in all_robots() {
        let mut world = robot.world(&setup(robot.open_hand([0.3, 1.0]), FAR));
        let drive = towards([0.3, 1.0, 0.6, 1.2]);
        for second in 1..=4 {
            run(&robot, &mut world, &drive, 1.0);
            let share = 1.0 - (-f64::from(second)).exp();
            let posture = robot.posture(&world);
            for (flexion, asked) in [(posture[2], 0.6), (posture[3], 1.2)] {
                let error = flexion - share * asked;
                assert!(error.abs() < 0.01 * asked, "{flexion} after {second} s");
            }
        }
    }
}

/// The shoulder's base is fixed: as many degrees of freedom as joints, and all stay where they are
/// at their equilibrium points. Catches a root with six joints of its own.
#[test]
fn nothing_moves_by_itself() {
    for robot in all_robots() {
        let joints = match robot.body().grip.fingers {
            Fingers::Virtual => 9,
            Fingers::Independent => 18,
        };
        let posture = [0.4, 0.9, 0.2, 0.3];
        let mut world = robot.world(&setup(posture, FAR));
        assert_eq!(robot.joint_angles(&world).len(), joints);
        run(&robot, &mut world, &towards(posture), 5.0);
        for (now, before) in robot.posture(&world).into_iter().zip(posture) {
            assert!((now - before).abs() < 1e-5, "{now} {before}");
        }
    }
}

/// A spring that is set after a long rest moves its joint: nothing sleeps. Catches links that rapier
/// puts to sleep, as it does unless told not to.
#[test]
fn an_arm_at_rest_does_not_fall_asleep() {
    for robot in robots(Fingers::Virtual) {
        let rest = robot.open_hand([0.0, 0.5]);
        let mut world = robot.world(&setup(rest, FAR));
        run(&robot, &mut world, &towards(rest), 20.0);
        let there = [0.5, 1.0, 0.5, 0.5];
        run(&robot, &mut world, &towards(there), 8.0);
        for (now, asked) in robot.posture(&world).into_iter().zip(there) {
            assert!((now - asked).abs() < 2e-3, "{now} {asked}");
        }
    }
}

proptest! {
    /// The palm stands where the arm's forward kinematics has it. Catches joints about another axis
    /// than the engine's free one, angles of the wrong sign, and a start that is not the case's.
    #[test]
    fn the_palm_is_where_kinematics_has_it(q1 in -1.3..3.1_f64, q2 in 0.1..2.2_f64, flexion in 0.0..1.5_f64) {
        for robot in robots(Fingers::Virtual) {
            let posture = [q1, q2, flexion, flexion];
            let mut world = robot.world(&setup(posture, FAR));
            // Then the angles are those that the engine has.
            robot.step(&mut world, &towards(posture));
            let pose = PlanarArm::new(robot.body()).place([q1, q2]);
            let palm = robot.palm(&world);
            let middle = 0.13 + 0.065 / 2.0;
            let expected = pose.elbow + pose.fore_direction * middle;
            prop_assert!((palm.origin - expected.push(0.0)).norm() < 3e-6);
            let side = Vector3::new(-pose.fore_direction.y, pose.fore_direction.x, 0.0);
            prop_assert!((palm.rotation.column(1) - side).norm() < 3e-6);
            for (now, asked) in robot.posture(&world).into_iter().zip(posture) {
                prop_assert!((now - asked).abs() < 3e-6);
            }
        }
    }

    #[test]
    fn torques_stop_at_the_joint_ranges(shares in prop::array::uniform4(-1.0..1.0_f64)) {
        stops_at_the_joint_ranges(&robot(), shares);
    }
}

/// The same in every engine.
#[test]
fn the_largest_torques_stop_at_the_joint_ranges() {
    for robot in all_robots() {
        for share in [1.0, -1.0] {
            stops_at_the_joint_ranges(&robot, [share; 4]);
        }
    }
}

/// Torques beyond the ends of the joint ranges do not carry a joint past them, and within them
/// move it at T / `K_D`. Catches a missing stop, and a torque of the wrong unit or sign.
fn stops_at_the_joint_ranges(robot: &Robot, shares: [f64; 4]) {
    let mut world = robot.world(&setup(robot.denormalised([0.5; 4]), FAR));
    let grip = &robot.body().grip;
    let limits = [
        grip.arm_muscles,
        grip.arm_muscles,
        grip.hand_muscles,
        grip.hand_muscles,
    ];
    let torques = std::array::from_fn(|i| shares[i] * limits[i].torque_max);
    let before = robot.posture(&world);
    run(robot, &mut world, &torques.map(MuscleCommand::Torque), 0.1);
    for (i, now) in robot.posture(&world).into_iter().enumerate() {
        let expected = before[i] + 0.1 * torques[i] / limits[i].kd;
        assert!((now - expected).abs() < 4e-3, "joint {i}: {now} {expected}");
    }
    run(robot, &mut world, &torques.map(MuscleCommand::Torque), 8.0);
    for (now, [low, high]) in robot.posture(&world).into_iter().zip(robot.ranges()) {
        assert!(
            now > low - 0.01 && now < high + 0.01,
            "{now} not in [{low}, {high}]"
        );
    }
}

/// A ball at rest weighs on its support with m g, whatever the number of solver substeps. Catches
/// impulses that are read per substep, and forces divided by the wrong time.
#[test]
fn the_support_carries_the_weight() {
    for robot in robots(Fingers::Virtual) {
        for radius in [0.012, 0.03] {
            let ball = Ball {
                centre: [0.0, 0.3],
                radius,
            };
            let open = robot.open_hand([-1.0, 0.5]);
            let mut world = robot.world(&Setup {
                support: true,
                ..setup(open, ball)
            });
            run(&robot, &mut world, &towards(open), 2.0);
            let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
            let weight = robot.body().object.density_kg_m3 * volume * 9.81;
            let force = robot.touch(&world).support;
            assert!((force / weight - 1.0).abs() < 0.01, "{force} N, {weight} N");
            assert!(robot.object(&world).z.abs() < 1e-3);
        }
    }
}

/// Without its support the ball falls as a damped body does. Catches a support that stays, and
/// gravity of another size or direction.
#[test]
fn without_support_the_ball_falls() {
    let robot = robot();
    let open = robot.open_hand([-1.0, 0.5]);
    let ball = Ball {
        centre: [0.0, 0.3],
        radius: 0.03,
    };
    let mut world = robot.world(&Setup {
        support: true,
        ..setup(open, ball)
    });
    let drive = towards(open);
    run(&robot, &mut world, &drive, 0.5);
    robot.remove_support(&mut world);
    assert!(!robot.has_support(&world));
    let before = robot.object(&world);
    run(&robot, &mut world, &drive, 0.5);
    let (c, t) = (robot.body().object.linear_damping, 0.5);
    // dv/dt = −g − c v from rest.
    let depth = 9.81 / c * (t - (1.0 - (-c * t).exp()) / c);
    let fallen = before - robot.object(&world);
    assert!(
        (fallen.z / depth - 1.0).abs() < 0.02,
        "{} m, {depth} m",
        fallen.z
    );
    assert!(fallen.xy().norm() < 1e-6);
}

/// Arm and hand pass through the support, which reaches above the lower edge of the palm.
#[test]
fn the_support_touches_the_object_alone() {
    let robot = robot();
    let ball = Ball {
        centre: [-0.3, 0.1],
        radius: 0.012,
    };
    let start = robot.open_hand([-0.5, 1.0]);
    let [mut with, mut without] = [true, false].map(|support| {
        robot.world(&Setup {
            support,
            ..setup(start, ball)
        })
    });
    let drive = towards([0.8, 1.5, 1.0, 1.2]);
    run(&robot, &mut with, &drive, 1.0);
    run(&robot, &mut without, &drive, 1.0);
    assert_eq!(robot.posture(&with), robot.posture(&without));
}

/// The first step of a new world sees arm and hand where they are. Catches colliders that still
/// stand where the template has them, along x, and kick a ball there.
#[test]
fn the_first_step_meets_no_phantom() {
    for robot in all_robots() {
        let ball = Ball {
            centre: [0.2, 0.01],
            radius: 0.03,
        };
        let posture = robot.open_hand([1.5, 0.5]);
        let mut world = robot.world(&Setup {
            support: true,
            ..setup(posture, ball)
        });
        for _ in 0..5 {
            robot.step(&mut world, &towards(posture));
            assert!(!robot.touch(&world).any());
            assert_eq!(robot.penetration(&world), 0.0);
        }
        assert!((robot.object(&world) - Vector3::new(0.2, 0.01, 0.0)).norm() < 1e-4);
    }
}

/// The obstacle stops arm and hand and says so; the object cannot pass it either.
#[test]
fn the_obstacle_stops_the_arm() {
    let robot = robot();
    let arm = PlanarArm::new(robot.body());
    let start = [0.0, 0.6];
    let hand = arm.fingertip([0.6, 0.6]);
    let obstacle = Obstacle {
        centre: Vector2::new(hand.x, hand.y) * 0.8,
        radius: 0.02,
    };
    let mut world = robot.world(&Setup {
        obstacle: Some(obstacle),
        ..setup(robot.open_hand(start), FAR)
    });
    assert!(!robot.touch(&world).collision);
    let drive = towards(robot.open_hand([1.6, 0.6]));
    run(&robot, &mut world, &drive, 3.0);
    assert!(robot.touch(&world).collision);
    let shoulder = robot.posture(&world)[0];
    assert!((0.2..1.0).contains(&shoulder), "{shoulder}");
}

/// Two worlds of one setup are the same, whatever was played in between, and so is a copy that is
/// made in mid-contact, or one that went through bytes; in rapier too, whose state is made again from
/// its past. Catches buffers that a reset leaves warm, and engine state that is not written.
#[test]
fn copies_continue_bit_for_bit() {
    for robot in all_robots() {
        let arm = [0.2, 0.8];
        let mut world = ball_at_palm(&robot, arm, 0.02);
        let drive = reflex(&robot, arm);
        run(&robot, &mut world, &drive, 2.5);
        let mut again = ball_at_palm(&robot, arm, 0.02);
        run(&robot, &mut again, &drive, 2.5);
        assert_eq!(bytes(&world), bytes(&again), "the same setup again");
        assert!(robot.touch(&world).encloses());

        let mut copy = world.clone();
        let mut read = postcard::from_bytes(&bytes(&world)).unwrap();
        for _ in 0..300 {
            for world in [&mut world, &mut copy, &mut read] {
                robot.step(world, &reflex(&robot, [0.6, 1.2]));
            }
            assert_eq!(robot.object(&world), robot.object(&copy));
            assert_eq!(robot.object(&world), robot.object(&read));
            assert_eq!(robot.posture(&world), robot.posture(&read));
        }
        assert_eq!(bytes(&world), bytes(&copy));
    }
}

/// The hand is symmetric about the arm's plane, so it keeps a ball in that plane. Catches fingers
/// or forces that are not mirrored.
#[test]
fn a_grasped_ball_stays_in_the_plane() {
    let robot = robot();
    let mut world = ball_at_palm(&robot, [0.2, 0.8], 0.03);
    run(&robot, &mut world, &reflex(&robot, [0.2, 0.8]), 3.0);
    assert!(robot.object(&world).z.abs() < 1e-3);
}

/// A ball pressed between hand and palm is in balance: it does not gain energy from its contacts,
/// and surfaces sink into each other by at most 3 mm. Catches contacts that are too soft or that
/// crush and eject, as muscles of 200 N·m/rad on a finger do.
#[test]
fn a_squeezed_ball_rests() {
    let robot = robot();
    for radius in [0.012, 0.02, 0.03] {
        let mut world = ball_at_palm(&robot, [0.2, 0.8], radius);
        let drive = reflex(&robot, [0.2, 0.8]);
        run(&robot, &mut world, &drive, 4.0);
        robot.remove_support(&mut world);
        run(&robot, &mut world, &drive, 2.0);
        let (mut speed, mut depth): (f64, f64) = (0.0, 0.0);
        for _ in 0..200 {
            robot.step(&mut world, &drive);
            speed = speed.max(robot.object_velocity(&world).norm());
            depth = depth.max(robot.penetration(&world));
            assert!(robot.touch(&world).encloses());
        }
        println!("radius {radius}: {speed:.4} m/s, {:.2} mm", 1e3 * depth);
        assert!(speed < 0.02 && depth < 3e-3, "{speed} m/s, {depth} m");
    }
}

/// The open thumb points back and to the palm's side, and closes towards the fingers.
#[test]
fn thumb_and_fingers_close_towards_each_other() {
    let robot = robot();
    let scene = |flexion: f64| {
        let world = robot.world(&setup([0.0, FRAC_PI_2, flexion, flexion], FAR));
        let mut scene = Vec::new();
        robot.push_visible(&world, &mut scene);
        scene
    };
    let palm = robot.palm(&robot.world(&setup([0.0, FRAC_PI_2, 0.0, 0.0], FAR)));
    let tips = |flexion: f64| {
        let tip = |shape: &babble_eye::Shape| match shape {
            babble_eye::Shape::Capsule { b, .. } => palm.local_from_world(b),
            other => panic!("{other:?}"),
        };
        let scene = scene(flexion);
        // Upper arm, forearm, palm, three times four finger segments, four of the thumb.
        assert_eq!(scene.len(), 19);
        [tip(&scene[18].shape), tip(&scene[12].shape)]
    };
    let [thumb, finger] = tips(0.0);
    assert!(thumb.x < -0.05 && thumb.y > 0.01, "{thumb}");
    assert!((finger.x - (0.0325 + 0.051 - 0.006)).abs() < 1e-6 && finger.y.abs() < 1e-6);
    let [thumb, finger] = tips(60_f64.to_radians());
    assert!(thumb.y > 0.02 && thumb.x > -0.03, "{thumb}");
    assert!(finger.y > 0.02, "{finger}");
}

proptest! {
    /// Distances by forward kinematics are those to the solids that the engine moves. Catches links
    /// or solids that stand elsewhere in one of the two, and the palm's edges.
    #[test]
    fn clearance_is_the_distance_to_what_is_seen(
        q1 in -1.3..3.1_f64, q2 in 0.1..2.2_f64, thumb in 0.0..1.5_f64, finger in 0.0..1.5_f64,
        x in -0.4..0.4_f64, y in -0.4..0.4_f64, z in -0.05..0.05_f64,
    ) {
        use babble_eye::Shape;
        let robot = robot();
        let posture = [q1, q2, thumb, finger];
        let mut scene = Vec::new();
        robot.push_visible(&robot.world(&setup(posture, FAR)), &mut scene);
        let point = Vector3::new(x, y, z);
        let least = scene.iter().map(|thing| match &thing.shape {
            Shape::Capsule { a, b, radius } => {
                let along = (0..=4000).map(|k| a + (b - a) * (f64::from(k) / 4000.0));
                along.map(|p| (point - p).norm()).fold(f64::INFINITY, f64::min) - radius
            }
            Shape::Cuboid { centre, rotation, half_extents } => {
                let local = rotation.tr_mul(&(point - centre));
                let nearest = local.zip_map(half_extents, |p, h| p.clamp(-h, h));
                (local - nearest).norm()
            }
            other => panic!("{other:?}"),
        }).fold(f64::INFINITY, f64::min);
        let clearance = robot.clearance(posture, &point);
        prop_assert!((clearance.max(-0.006) - least.max(-0.006)).abs() < 1e-5 || clearance < 0.0 && least <= 0.0,
            "{clearance} {least}");
        prop_assert!(robot.clearance_of_vertical(posture, Vector2::new(x, y)) <= clearance + 1e-9);
    }
}
