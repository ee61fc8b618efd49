//! Laws that motion and contacts obey, in the tree engine and, where its tolerances allow, in rapier.

mod grasping;
mod spread;

use babble_body::Body;
use babble_body::config::Fingers;
use babble_body::robot::{Ball, MuscleCommand, Robot, Setup, World, towards};
use babble_eye::Shape;
use grasping::{DT, FAR, ball_at_palm, reflex, robots, run, setup, with};
use nalgebra::Vector3;
use proptest::prelude::*;
use spread::spread;

const GRAVITY: f64 = 9.81;

fn mass(robot: &Robot, radius: f64) -> f64 {
    robot.body().object.density_kg_m3 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// A body whose object loses no speed by itself.
fn undamped(body: &mut Body) {
    body.object.linear_damping = 0.0;
    body.object.angular_damping = 0.0;
}

/// The world with its ball in motion \[m/s\].
fn thrown(world: &World, velocity: [f64; 3]) -> World {
    let mut value = serde_json::to_value(world).unwrap();
    value["mechanics"]["ball"]["velocity"] = velocity.to_vec().into();
    serde_json::from_value(value).unwrap()
}

/// A number or a vector of the world's mechanical state.
fn mechanics(world: &World) -> serde_json::Value {
    serde_json::to_value(world).unwrap()["mechanics"].take()
}

fn numbers(values: &serde_json::Value) -> Vec<f64> {
    serde_json::from_value(values.clone()).unwrap()
}

fn spin(world: &World) -> Vector3<f64> {
    Vector3::from_vec(numbers(&mechanics(world)["ball"]["spin"]))
}

/// A ball on its support, far from the hand.
fn alone(robot: &Robot, radius: f64) -> World {
    let centre = [0.0, 0.4];
    robot.world(&Setup {
        support: true,
        ..setup(robot.open_hand([-1.2, 0.5]), Ball { centre, radius })
    })
}

/// Forces are what changes the ball's momentum: in each step m Δu / dt is its weight, what the
/// support carries and what the palm is said to press along its normal. Catches forces of another
/// step, in other units, or without a part of them.
#[test]
fn forces_are_the_change_of_momentum() {
    let robot = with(|body| {
        undamped(body);
        // Then palm and support press along their normals alone.
        body.object.friction = 0.0;
    });
    let mut world = ball_at_palm(&robot, [0.0, 0.8], 0.03);
    let open = robot.open_hand([0.0, 0.8]);
    let mut checked = 0;
    for k in 0..100 {
        // Faster and faster, so that the palm keeps pressing.
        let time = DT * f64::from(k);
        let (before, palm) = (robot.object_velocity(&world), robot.palm(&world));
        robot.step(
            &mut world,
            &towards([4.0 * time * time, 0.8, open[2], open[3]]),
        );
        let touch = robot.touch(&world);
        let force = (robot.object_velocity(&world) - before) * mass(&robot, 0.03) / DT;
        let normal: Vector3<f64> = palm.rotation.column(1).into();
        let weight = mass(&robot, 0.03) * GRAVITY;
        let expected = normal * touch.palm + Vector3::z() * (touch.support - weight);
        assert_eq!([touch.thumb, touch.fingers, touch.arm], [0.0; 3]);
        assert!((force - expected).norm() < 1e-9, "{force} {expected}");
        checked += u32::from(touch.palm > 0.0);
    }
    assert!(checked > 50, "{checked}");
}

/// Contacts give no energy: a ball that is thrown at a still hand never has more than it came with,
/// but for what its support's spring holds. Catches contacts that eject, and friction
/// that drives.
#[test]
fn contacts_give_no_energy() {
    let robot = with(undamped);
    for (radius, sideways) in [(0.012, 0.0), (0.03, 0.3), (0.03, -0.5), (0.02, 1.0)] {
        let at_palm = ball_at_palm(&robot, [0.2, 0.8], radius);
        let normal: Vector3<f64> = robot.palm(&at_palm).rotation.column(1).into();
        let along: Vector3<f64> = robot.palm(&at_palm).rotation.column(0).into();
        let mut world = thrown(&at_palm, (along * sideways - normal * 1.0).into());
        let still = towards(robot.posture(&world));
        let m = mass(&robot, radius);
        let energy = |world: &World| {
            let u = robot.object_velocity(world).norm_squared();
            let turning = 0.4 * radius * radius * spin(world).norm_squared();
            0.5 * m * (u + turning) + m * GRAVITY * robot.object(world).z
        };
        // What the support's spring holds under the ball's weight.
        let stored = (m * GRAVITY).powi(2) / (2.0 * robot.body().contact.stiffness_n_m);
        let (first, mut touched) = (energy(&world), false);
        let mut least = first;
        for _ in 0..400 {
            robot.step(&mut world, &still);
            let now = energy(&world);
            assert!(now <= least + stored, "{now} J after {least} J");
            least = least.min(now);
            touched |= robot.touch(&world).palm > 0.0;
        }
        assert!(touched && least < 0.9 * first);
    }
}

/// A ball that slides on its support loses μ g of its speed each second, until it rolls at 5/7 of
/// it and loses no more. Catches friction of another size, a moment of inertia that is not a ball's,
/// and friction against rolling.
#[test]
fn a_sliding_ball_ends_up_rolling() {
    let friction = 0.2;
    let robot = with(|body| {
        undamped(body);
        body.object.support_friction = friction;
    });
    let mut world = alone(&robot, 0.03);
    let still = towards(robot.posture(&world));
    run(&robot, &mut world, &still, 0.5);
    let first = 0.7;
    let mut world = thrown(&world, [first, 0.0, 0.0]);
    for k in 1..=100 {
        robot.step(&mut world, &still);
        let time = DT * f64::from(k);
        let expected = (first - friction * GRAVITY * time).max(first * 5.0 / 7.0);
        let speed = robot.object_velocity(&world).x;
        assert!(
            (speed - expected).abs() < 2e-3,
            "{time} s: {speed}, {expected} m/s"
        );
    }
    // It rolls: its lowest point stands still.
    let slip = robot.object_velocity(&world).x - spin(&world).y * 0.03;
    assert!(slip.abs() < 1e-3 * first, "{slip} m/s");
}

/// A ball that falls on its support is stopped, without a bounce, as the damped spring of its contact
/// has it, both taken at the end of a step:
/// `m Δv = −m g dt + k dt (d − (τ + dt) v)` for a depth d. Catches contacts that are springs alone, and
/// a stiffness or a relaxation time that is not the body's.
#[test]
fn a_falling_ball_does_not_bounce() {
    let robot = with(undamped);
    let mut world = thrown(&alone(&robot, 0.03), [0.0, 0.0, -1.0]);
    let still = towards(robot.posture(&world));
    let contact = robot.body().contact;
    let (m, k, tau) = (
        mass(&robot, 0.03),
        contact.stiffness_n_m,
        contact.relaxation_s,
    );
    let [mut z, mut v] = [0.0, -1.0];
    for _ in 0..400 {
        v = (m * v - m * GRAVITY * DT - k * DT * z) / (m + k * DT * (tau + DT));
        z += DT * v;
        robot.step(&mut world, &still);
        let height = robot.object(&world).z;
        assert!((height - z).abs() < 1e-7, "{height} {z}");
        assert!(height < 0.0);
    }
    assert!(robot.object_velocity(&world).norm() < 1e-6);
}

/// Up and down are mirror images, as arm and hand are their own: balls that come from above and from
/// below do the same. Catches fingers or contact points that are not symmetric, and a solver that
/// depends on the order of its contacts.
#[test]
fn above_and_below_are_mirror_images() {
    for fingers in [Fingers::Virtual, Fingers::Independent] {
        let robot = with(|body| body.grip.fingers = fingers);
        let start = robot.open_hand([0.2, 0.8]);
        let centre = {
            let world = ball_at_palm(&robot, [0.2, 0.8], 0.02);
            robot.object(&world)
        };
        // Without weight: gravity is no mirror image.
        let ball = Ball {
            centre: [centre.x, centre.y],
            radius: 0.02,
        };
        let begun = robot.world(&setup(start, ball));
        let mut worlds = [0.005, -0.005].map(|speed| thrown(&begun, [0.0, 0.0, speed]));
        for _ in 0..600 {
            for world in &mut worlds {
                // What gravity is about to take.
                let lift = Vector3::z() * (GRAVITY * DT);
                *world = thrown(world, (robot.object_velocity(world) + lift).into());
                robot.step(world, &reflex(&robot, [0.2, 0.8]));
            }
            let [above, below] = worlds.each_ref().map(|world| robot.object(world));
            assert!((above.xy() - below.xy()).norm() < 1e-6, "{above} {below}");
            assert!((above.z + below.z).abs() < 1e-6, "{above} {below}");
        }
        assert!(robot.touch(&worlds[0]).encloses());
    }
}

/// The hand holds a ball of any size from 2 to 7 cm while the arm swings, with one engine's step or
/// half of it, and surfaces sink in by less than a millimetre. Catches grasps that depend on the
/// step, and contacts that are softer than they say.
#[test]
fn balls_of_two_to_seven_centimetres_are_held() {
    for dt in [DT, DT / 2.0] {
        let robot = Robot::new(&Body::paper(), dt);
        for millimetres in [20, 24, 30, 40, 50, 60, 70] {
            let radius = f64::from(millimetres) / 2000.0;
            let mut world = ball_at_palm(&robot, [0.2, 0.8], radius);
            let steps = |seconds: f64| (seconds / dt).round() as usize;
            for _ in 0..steps(3.0) {
                robot.step(&mut world, &reflex(&robot, [0.2, 0.8]));
            }
            robot.remove_support(&mut world);
            let mut deepest: f64 = 0.0;
            for k in 0..steps(3.0) {
                let [shoulder, elbow] = spread(k / steps(0.5) + millimetres as usize);
                let there = [shoulder, 0.5 + elbow];
                robot.step(&mut world, &reflex(&robot, there));
                deepest = deepest.max(robot.penetration(&world));
            }
            assert!(robot.touch(&world).encloses(), "{millimetres} mm");
            assert!(deepest < 1e-3, "{millimetres} mm: {deepest} m");
        }
    }
}

/// What is pressed sinks in by force / stiffness, and the muscles carry it: where nothing rubs, a ball
/// in the closed hand is in balance, and so is every joint of thumb and finger, with `K_P` (EP − q)
/// against the forces times their levers. Catches depths of another stiffness, forces that are not
/// along the normals, and a reaction that the joints do not feel.
#[test]
fn a_pressed_ball_is_in_balance() {
    let robot = with(|body| body.object.friction = 0.0);
    // Larger balls slip out of the hand.
    for radius in [0.012, 0.02, 0.025] {
        let mut world = ball_at_palm(&robot, [0.2, 0.8], radius);
        run(&robot, &mut world, &reflex(&robot, [0.2, 0.8]), 20.0);
        let touch = robot.touch(&world);
        assert!(touch.palm > 0.0 && touch.fingers > 0.0 && touch.thumb > 0.0);
        balances(&robot, &world, radius);
    }
}

/// Whether depths, the ball and the joints of thumb and finger are in balance with the forces.
fn balances(robot: &Robot, world: &World, radius: f64) {
    let mut scene = Vec::new();
    robot.push_visible(world, &mut scene);
    let ball = robot.object(world);
    let impulses = numbers(&mechanics(world)["impulses"]);
    let stiffness = robot.body().contact.stiffness_n_m;
    let mut sum = Vector3::zeros();
    let mut on_links = Vec::new();
    for (thing, impulse) in scene.iter().zip(&impulses) {
        let force = impulse / DT;
        let (from, thickness) = nearest(&thing.shape, &ball);
        let depth = radius + thickness - (ball - from).norm();
        assert!(
            (force - stiffness * depth.max(0.0)).abs() < 1e-3,
            "{force} N, {depth} m"
        );
        let normal = (ball - from).normalize();
        sum += normal * force;
        on_links.push((ball - normal * (radius - 0.5 * depth), normal * -force));
    }
    assert!(sum.xy().norm() < 1e-3, "{sum}");

    let start = |solid: usize| match &scene[solid].shape {
        Shape::Capsule { a, .. } => a.xy(),
        other => panic!("{other:?}"),
    };
    let q = robot.joint_angles(world);
    let kp = robot.body().grip.hand_muscles.kp;
    let [thumb, finger] = robot.body().grip.reflex_deg.map(f64::to_radians);
    // Solids from the first of a digit's link to the last of the digit; a thumb flexes clockwise.
    let finger_joints = (0..3).map(|k| (2 + k, 3 + 4 * k, 15, finger, 1.0));
    let thumb_joints = (0..4).map(|k| (5 + k, 15 + k, 19, thumb, -1.0));
    for (joint, first, end, asked, sense) in finger_joints.chain(thumb_joints) {
        let loads = on_links[first..end].iter().map(|(point, force)| {
            let lever = point.xy() - start(first);
            sense * lever.perp(&force.xy())
        });
        let torque = kp * (asked - q[joint]);
        let load: f64 = loads.sum();
        assert!(
            (torque + load).abs() < 1e-4,
            "joint {joint}: {torque} {load} N·m"
        );
    }
}

/// The point of a shape's axis, or of a box, that is nearest to a point, and how thick the shape is
/// around it.
fn nearest(shape: &Shape, point: &Vector3<f64>) -> (Vector3<f64>, f64) {
    match shape {
        Shape::Capsule { a, b, radius } => {
            let share = (b - a).dot(&(point - a)) / (b - a).norm_squared();
            (a + (b - a) * share.clamp(0.0, 1.0), *radius)
        }
        Shape::Cuboid {
            centre,
            rotation,
            half_extents,
        } => {
            let local = rotation.tr_mul(&(point - centre));
            let nearest = local.zip_map(half_extents, |p, h| p.clamp(-h, h));
            (centre + rotation * nearest, 0.0)
        }
        other => panic!("{other:?}"),
    }
}

/// Two engines, one robot: with the hand free the joints agree to what single precision leaves, and
/// both hold a ball.
#[cfg(feature = "rapier")]
#[test]
fn rapier_agrees() {
    for fingers in [Fingers::Virtual, Fingers::Independent] {
        let robots = robots(fingers);
        let mut worst: f64 = 0.0;
        let mut worlds: Vec<_> = robots
            .iter()
            .map(|robot| robot.world(&setup(robot.open_hand([0.1, 0.8]), FAR)))
            .collect();
        for k in 0..1200 {
            let [a, b] = spread(k / 60);
            let there = [a, 0.2 + b, a, b];
            for (robot, world) in robots.iter().zip(&mut worlds) {
                robot.step(world, &towards(there));
            }
            let [ours, theirs] = [0, 1].map(|i| robots[i].joint_angles(&worlds[i]));
            for (our, their) in ours.iter().zip(theirs) {
                worst = worst.max((our - their).abs());
            }
        }
        println!("{fingers:?}: {:.4} mrad", 1e3 * worst);
        assert!(worst < 1e-3, "{worst} rad");
    }
    for robot in robots(Fingers::Virtual) {
        let mut world = ball_at_palm(&robot, [0.2, 0.8], 0.025);
        run(&robot, &mut world, &reflex(&robot, [0.2, 0.8]), 3.0);
        robot.remove_support(&mut world);
        run(&robot, &mut world, &reflex(&robot, [0.6, 1.2]), 2.0);
        assert!(robot.touch(&world).encloses());
        assert!(robot.object(&world).z.abs() < 2e-3);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever is asked of the muscles, with any ball anywhere and any torque: joints that nothing
    /// pushes move no faster than torque over damping, and a ball that nothing pushes falls. What
    /// presses or throws is never more than 20 rad/s and 30 m/s.
    #[test]
    fn nothing_blows_up(
        posture in prop::array::uniform4(0.0..1.0_f64),
        pulls in prop::collection::vec(prop::array::uniform4(-1.0..1.0_f64), 4),
        torque in any::<bool>(),
        centre in prop::array::uniform2(-0.3..0.3_f64),
        radius in 0.006..0.1_f64,
        support in any::<bool>(),
    ) {
        let robot = with(|_| ());
        let mut world = robot.world(&Setup {
            support,
            ..setup(robot.denormalised(posture), Ball { centre, radius })
        });
        let grip = robot.body().grip;
        let limits = [grip.arm_muscles, grip.arm_muscles, grip.hand_muscles, grip.hand_muscles];
        let (mut time, mut pushed) = (0.0, false);
        for pull in pulls {
            let drive = std::array::from_fn(|i| if torque {
                MuscleCommand::Torque(pull[i] * limits[i].torque_max)
            } else {
                MuscleCommand::EquilibriumPoint(robot.denormalised(pull.map(|x| 0.5 + 0.5 * x))[i])
            });
            for _ in 0..100 {
                robot.step(&mut world, &drive);
                time += DT;
                pushed |= robot.touch(&world).any();
            }
            let ball = robot.object_velocity(&world).norm();
            for (i, speed) in robot.speeds(&world).into_iter().enumerate() {
                let [low, high] = robot.ranges()[i];
                let torque = if torque { limits[i].torque_max } else { limits[i].kp * (high - low) };
                let most = if pushed { 20.0 } else { 1.02 * torque / limits[i].kd };
                prop_assert!(speed.abs() < most, "{i}: {speed}, {most} rad/s");
            }
            let most = match (pushed, support) {
                (true, _) => 30.0,
                (false, true) => 1e-3,
                (false, false) => GRAVITY * time,
            };
            prop_assert!(ball <= most, "{ball}, {most} m/s");
            prop_assert!(robot.joint_angles(&world).iter().all(|q| q.is_finite()));
        }
    }
}
