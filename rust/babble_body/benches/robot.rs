//! What a physics step of 5 ms costs, free and with a ball in the hand, in both engines.

use babble_body::Body;
use babble_body::config::{EngineName, Fingers};
use babble_body::robot::{Ball, MuscleCommands, Robot, Setup, World, towards};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

const DT: f64 = 0.005;
/// Steps from one target of the arm to the next.
const STEPS: u32 = 100;

fn robot(engine: EngineName, fingers: Fingers) -> Robot {
    let mut body = Body::paper();
    body.engine = engine;
    body.grip.fingers = fingers;
    Robot::new(&body, DT)
}

fn world(robot: &Robot, ball: Ball, support: bool) -> World {
    robot.world(&Setup {
        posture: robot.open_hand([0.0, 0.8]),
        ball,
        support,
        obstacle: None,
    })
}

fn reflex(robot: &Robot, arm: [f64; 2]) -> MuscleCommands {
    let [thumb, finger] = robot.body().grip.reflex_deg.map(f64::to_radians);
    towards([arm[0], arm[1], thumb, finger])
}

/// A ball of 5 cm that the reflex has closed around, without support.
fn held(robot: &Robot) -> World {
    let far = Ball {
        centre: [0.0, -2.0],
        radius: 0.025,
    };
    let palm = robot.palm(&world(robot, far, false));
    let mut pocket = robot.pocket(far.radius);
    pocket.y += 1e-3;
    let centre = palm.world_from_local(&pocket);
    let ball = Ball {
        centre: [centre.x, centre.y],
        ..far
    };
    let mut world = world(robot, ball, true);
    for _ in 0..600 {
        robot.step(&mut world, &reflex(robot, [0.0, 0.8]));
    }
    robot.remove_support(&mut world);
    for _ in 0..200 {
        robot.step(&mut world, &reflex(robot, [0.0, 0.8]));
    }
    assert!(robot.touch(&world).encloses(), "the ball is held");
    world
}

fn steps(c: &mut Criterion) {
    for (engine, of) in [(EngineName::Tree, "tree"), (EngineName::Rapier, "rapier")] {
        for (fingers, joints) in [(Fingers::Virtual, 9), (Fingers::Independent, 18)] {
            let robot = robot(engine, fingers);
            let far = Ball {
                centre: [0.0, -0.5],
                radius: 0.025,
            };
            let free = world(&robot, far, true);
            for (name, begun) in [("free", free), ("held", held(&robot))] {
                c.bench_function(&format!("physics: {of}, {joints} joints, {name}"), |b| {
                    let mut k = 0;
                    // From target to target, and never for long without the ball.
                    b.iter_batched_ref(
                        || begun.clone(),
                        |world| {
                            for _ in 0..STEPS {
                                k += 1;
                                let there = if k % 200 < 100 {
                                    [0.3, 1.2]
                                } else {
                                    [-0.3, 0.6]
                                };
                                robot.step(world, black_box(&reflex(&robot, there)));
                            }
                        },
                        BatchSize::SmallInput,
                    );
                });
            }
        }
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
