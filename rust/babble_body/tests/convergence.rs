//! The solver tells in how many steps it did not converge.

mod grasping;

use babble_body::Body;
use babble_body::robot::{Robot, towards};
use grasping::{ball_at_palm, bytes, reflex, run, with};

/// Closes the hand on a ball and waves it about for `seconds`; the count.
fn unconverged(robot: &Robot, radius: f64, seconds: f64) -> u64 {
    let mut world = ball_at_palm(robot, [0.3, 1.0], radius);
    run(robot, &mut world, &reflex(robot, [0.3, 1.0]), 1.0);
    robot.remove_support(&mut world);
    let [thumb, finger] = [0.2, 1.5];
    for half_second in 0..(2.0 * seconds) as usize {
        let arm = [[-0.5, 0.5], [1.0, 1.6], [2.0, 0.2]][half_second % 3];
        let drive = if half_second % 5 == 4 {
            towards([arm[0], arm[1], thumb, finger])
        } else {
            reflex(robot, arm)
        };
        run(robot, &mut world, &drive, 0.5);
    }
    robot.unconverged_steps().unwrap()
}

/// A ball of a tenth of a milligram between stiff fingers, on contacts five hundred times as hard as
/// the default's and hardly smoothed friction: rounding leaves little of the curvature.
fn hopeless(body: &mut Body) {
    body.contact.stiffness_n_m = 1e7;
    body.contact.relaxation_s = 0.26;
    body.contact.stiction_m_s = 1e-6;
    body.object.density_kg_m3 = 1.0;
    body.object.friction = 10.0;
    body.grip.hand_muscles.kp = 3_300.0;
    body.grip.hand_muscles.kd = 8.1;
    body.grip.hand_muscles.torque_max = 8.1;
}

#[test]
fn the_papers_hand_converges_at_each_step() {
    assert_eq!(unconverged(&with(|_| ()), 0.03, 500.0), 0);
}

#[test]
fn steps_that_do_not_converge_are_counted_and_the_world_goes_on() {
    let robot = with(hopeless);
    let count = unconverged(&robot, 0.0025, 300.0);
    assert!(count > 0);
    println!("{count} steps");
    // A copy counts on from there.
    assert_eq!(robot.clone().unconverged_steps(), Some(count));
}

/// The count is no part of a world: two robots with different counts have worlds of the same bytes.
#[test]
fn the_count_is_in_no_world() {
    let (fresh, used) = (with(hopeless), with(hopeless));
    assert!(unconverged(&used, 0.0025, 300.0) > 0);
    let [one, other] = [&fresh, &used].map(|robot| bytes(&ball_at_palm(robot, [0.3, 1.0], 0.03)));
    assert_eq!(one, other);
}

/// rapier solves with a fixed number of iterations and does not say how far it came.
#[cfg(feature = "rapier")]
#[test]
fn an_engine_that_does_not_tell_has_no_count() {
    let robot = with(|body| body.engine = babble_body::config::EngineName::Rapier);
    assert_eq!(robot.unconverged_steps(), None);
}
