//! Worlds for tests of the robot that grasps.

#![allow(dead_code, reason = "each test file uses some of it")]

use babble_body::Body;
use babble_body::config::{EngineName, Fingers};
use babble_body::robot::{Ball, MuscleCommands, Posture, Robot, Setup, World, towards};

pub(crate) const DT: f64 = 0.005;
/// A ball out of everybody's way.
pub(crate) const FAR: Ball = Ball {
    centre: [0.0, -2.0],
    radius: 0.03,
};

/// The engines of this build.
pub(crate) const ENGINES: &[EngineName] = &[
    EngineName::Tree,
    #[cfg(feature = "rapier")]
    EngineName::Rapier,
];

/// The robot of a changed body.
pub(crate) fn with(change: impl FnOnce(&mut Body)) -> Robot {
    let mut body = Body::paper();
    change(&mut body);
    Robot::new(&body, DT)
}

/// The robot with some fingers in every engine.
pub(crate) fn robots(fingers: Fingers) -> Vec<Robot> {
    let robot = |&engine: &EngineName| {
        with(|body| {
            body.engine = engine;
            body.grip.fingers = fingers;
        })
    };
    ENGINES.iter().map(robot).collect()
}

/// A world without support and obstacle.
pub(crate) fn setup(posture: Posture, ball: Ball) -> Setup {
    Setup {
        posture,
        ball,
        support: false,
        obstacle: None,
    }
}

/// The open hand in `arm` \[rad\], with a ball of `radius` \[m\] a millimetre before the palm, on a
/// support.
pub(crate) fn ball_at_palm(robot: &Robot, arm: [f64; 2], radius: f64) -> World {
    let posture = robot.open_hand(arm);
    let palm = robot.palm(&robot.world(&setup(posture, FAR)));
    let mut pocket = robot.pocket(radius);
    pocket.y += 1e-3;
    let centre = palm.world_from_local(&pocket);
    let ball = Ball {
        centre: [centre.x, centre.y],
        radius,
    };
    robot.world(&Setup {
        support: true,
        ..setup(posture, ball)
    })
}

/// The reflex's equilibrium points with the arm in `arm` \[rad\].
pub(crate) fn reflex(robot: &Robot, arm: [f64; 2]) -> MuscleCommands {
    let [thumb, finger] = robot.body().grip.reflex_deg.map(f64::to_radians);
    towards([arm[0], arm[1], thumb, finger])
}

/// Steps for `seconds`.
pub(crate) fn run(robot: &Robot, world: &mut World, drive: &MuscleCommands, seconds: f64) {
    for _ in 0..(seconds / DT).round() as usize {
        robot.step(world, drive);
    }
}

/// The world as bytes.
pub(crate) fn bytes(world: &World) -> Vec<u8> {
    postcard::to_stdvec(world).unwrap()
}
