//! Episodes of grasping: what a step is, in which order things happen, how they end.

mod playing;

use std::sync::Arc;

use babble_body::robot::{MuscleCommand, MuscleCommands, World, towards};
use babble_env::tasks::grasp::{GraspRequest, GraspState, Grip, ObjectPlace, at};
use babble_env::{Batch, Control, GraspOptions, GraspTask, Outcome};
use nalgebra::Vector2;
use playing::grasping::{
    CONTROLS, HELD, IS_SUCCESS, PALM_REACH, REACH, asked, asking_for, before_the_palm, grasp,
    grasp_with, obstacle, play, script, with_control,
};
use playing::{Actions, ended, record};

const DIAMETERS: [f64; 2] = [0.024, 0.06];

fn of_size(diameter: f64) -> GraspRequest {
    GraspRequest {
        diameter: Some(diameter),
        ..GraspRequest::default()
    }
}

fn state(env: &Batch<GraspTask>) -> &GraspState {
    env.state(0).unwrap()
}

fn bytes(world: &World) -> Vec<u8> {
    postcard::to_stdvec(world).unwrap()
}

/// Plays one case and holds it to the order of events; whether it succeeded.
fn grasps(task: &Arc<GraspTask>, seed: u64, diameter: f64, closes: bool) -> bool {
    let mut env = asked(task.clone(), seed, of_size(diameter));
    let (mut step, mut touched, mut gone) = (0, None, None);
    let outcome = play(&mut env, closes, |env| {
        step += 1;
        let (state, shown) = (state(env), record(env));
        let there = task.robot.has_support(&state.world);
        assert_eq!(there, state.enclosure.grip == Grip::Open, "step {step}");
        if !there && gone.is_none() {
            gone = Some(step);
        }
        if state.palm_reach && touched.is_none() {
            touched = Some(step);
        }
        assert!(!state.palm_reach || state.reach);
        let facts = shown.info.facts;
        assert_eq!(
            facts[..5],
            [
                state.progress.is_success,
                state.progress.ever_success,
                state.reach,
                state.palm_reach,
                state.progress.is_success
            ]
        );
        assert_eq!(shown.info.outcome, state.progress.outcome);
    });
    let (shown, state) = (record(&env), state(&env));
    if outcome != Outcome::Success {
        return false;
    }
    assert_eq!((shown.step.terminated, shown.step.truncated), (true, false));
    for fact in [IS_SUCCESS, REACH, PALM_REACH, HELD] {
        assert!(shown.info.facts[fact], "fact {fact}");
    }
    assert_eq!(gone, Some(step - 20));
    assert!(touched.unwrap() < step - 20);
    let centre = task.robot.object(&state.world);
    assert!(centre.z.abs() < 5e-3, "{} m above the plane", centre.z);
    assert!(task.in_hand(&state.world, state.case.radius()));
    true
}

/// Reaching out with the open hand and closing it once the object is touched grasps nearly all
/// objects on the palm's side, on both bodies and with fingers that flex one by one. The support goes
/// once, the success comes 20 control steps later, and the object is still in the hand and in the
/// plane. Catches a success by contact alone, a support that stays, and a hold that is counted from
/// elsewhere.
#[test]
fn the_script_grasps() {
    let options = with_control(Control::Posture);
    let independent = r#"{"body": {"grip": {"fingers": "independent"}}}"#;
    for (config, n) in [("{}", 10), (r#"{"profile": "icub"}"#, 6), (independent, 4)] {
        let task = grasp_with(config, options);
        for diameter in DIAMETERS {
            let held = (0..n).filter(|&seed| grasps(&task, seed, diameter, true));
            let held = held.count();
            assert!(
                held as u64 + 1 >= n,
                "{config}, {diameter} m: {held} of {n}"
            );
        }
    }
}

/// With the reflex the hand closes by itself from the palm's first touch on. Catches a reflex that
/// the action overrides.
#[test]
fn the_reflex_grasps() {
    let options = GraspOptions {
        enclosure_reflex: true,
        ..with_control(Control::Posture)
    };
    let task = grasp(options);
    for diameter in DIAMETERS {
        let held = (20..28).filter(|&seed| grasps(&task, seed, diameter, false));
        let held = held.count();
        assert!(held >= 7, "{diameter} m: {held} of 8");
    }
}

/// The reflex moves the hand's equilibrium points and not the arm's, from the palm's touch on and
/// not before. Catches a reflex that any touch starts, or one that moves the arm.
#[test]
fn the_reflex_waits_for_the_palm() {
    for control in CONTROLS {
        let options = GraspOptions {
            enclosure_reflex: true,
            max_episode_steps: 30,
            ..with_control(control)
        };
        let task = grasp(options);
        let mut env = asked(task.clone(), 0, before_the_palm(&task, 0.04));
        let [mut before, mut after] = [0; 2];
        play(&mut env, false, |env| {
            let state = state(env);
            assert_eq!(state.reflex, state.palm_reach);
            let hand = [state.equilibrium[2], state.equilibrium[3]];
            assert_eq!(hand == task.reflex(), state.reflex);
            before += u32::from(!state.reflex);
            after += u32::from(state.reflex);
        });
        assert!(before > 0 && after > 10, "{control}: {before} {after}");
        let without = grasp(with_control(control));
        let mut env = asked(without.clone(), 0, before_the_palm(&without, 0.04));
        for _ in 0..20 {
            let action = script(&without, state(&env), false);
            env.step(&action).unwrap();
        }
        assert!(state(&env).palm_reach && !state(&env).reflex);
        // An object before the fingers is touched, and not by the palm.
        let fingertip = Vector2::new(task.robot.palm_centre() + 0.07, 0.02 + 0.012);
        let object = task.arm.with_tip(fingertip).fingertip([0.2, 0.8]);
        let request = GraspRequest {
            object: ObjectPlace::At(object.into()),
            ..before_the_palm(&task, 0.024)
        };
        let mut env = asked(task.clone(), 0, request);
        let there = task.robot.open_hand([0.4, 0.8]);
        for _ in 0..20 {
            let action = asking_for(&task, state(&env), there);
            env.step(&action).unwrap();
        }
        assert!(state(&env).reach && !state(&env).palm_reach, "{control}");
        assert!(!state(&env).reflex);
    }
}

/// An open hand grasps nothing: the time is up, and nothing else ends the episode. Catches a touch
/// that counts as a grasp, and a limit that is one off.
#[test]
fn an_open_hand_runs_out_of_time() {
    let options = GraspOptions {
        max_episode_steps: 90,
        ..with_control(Control::Posture)
    };
    for diameter in DIAMETERS {
        let mut env = asked(grasp(options), 3, of_size(diameter));
        let mut steps = 0;
        let outcome = play(&mut env, false, |env| {
            steps += 1;
            assert!(!record(env).info.facts[IS_SUCCESS]);
        });
        let (shown, state) = (record(&env), state(&env));
        assert_eq!(
            (outcome, steps, state.progress.steps),
            (Outcome::Timeout, 90, 90)
        );
        assert_eq!((shown.step.terminated, shown.step.truncated), (false, true));
        assert!(state.palm_reach && state.enclosure.grip == Grip::Open);
        assert!(!state.progress.ever_success);
    }
}

/// On a table without friction the swung hand pushes the object away. Once it is beyond the arm's
/// reach it is lost, which ends the episode, and not before. Catches a loss that is never noticed,
/// and one that is called a success.
#[test]
fn what_is_pushed_away_is_lost() {
    let slippery = r#"{"body": {"object": {"support_friction": 0, "linear_damping": 0}}}"#;
    let task = grasp_with(slippery, with_control(Control::Torque));
    let mut env = asked(task.clone(), 0, before_the_palm(&task, 0.06));
    for step in 0.. {
        env.step(&[1.0, -0.2, -1.0, -1.0]).unwrap();
        let (shown, state) = (record(&env), state(&env));
        let centre = task.robot.object(&state.world);
        let away = centre.xy().norm() > task.arm.length() + 0.03;
        assert_eq!(shown.step.terminated, away, "{centre}");
        if away {
            assert_eq!(state.progress.outcome, Outcome::Lost);
            assert!(state.reach && !state.progress.ever_success);
            assert!(state.enclosure.grip == Grip::Open && centre.z > -0.01);
            break;
        }
        assert!(step < 120 && !ended(&shown), "{centre}");
    }
}

/// An object that is too heavy for the hand, or that slips through it (one without friction and
/// lighter lies in the groove between two fingers), is lost when the support
/// goes, as soon as the hold cannot succeed any more. Catches a support that carries on, and a
/// verdict at the end of the 20 steps alone.
#[test]
fn what_slips_is_lost() {
    let heavy = r#"{"body": {"object": {"density_kg_m3": 20000}}}"#;
    let slippery = r#"{"body": {"object": {"friction": 0, "density_kg_m3": 4000}}}"#;
    for config in [heavy, slippery] {
        for seed in 0..3 {
            let task = grasp_with(config, with_control(Control::Posture));
            let mut env = asked(task.clone(), seed, of_size(0.06));
            let mut tried = 0;
            let outcome = play(&mut env, true, |env| {
                tried += u32::from(state(env).enclosure.grip != Grip::Open);
            });
            let (shown, state) = (record(&env), state(&env));
            assert_eq!(state.enclosure.grip, Grip::Failed);
            assert_eq!(outcome, Outcome::Lost);
            assert!(shown.step.terminated && !shown.info.facts[HELD]);
            assert!((4..20).contains(&tried), "{config}: {tried} steps");
            assert!(task.robot.object(&state.world).z < -0.02);
        }
    }
}

/// What drives the muscles in a step that left `state`.
fn drive(task: &GraspTask, action: [f32; 4], state: &GraspState) -> MuscleCommands {
    match task.options.control {
        Control::Torque => {
            let muscles = task.muscles();
            std::array::from_fn(|i| {
                MuscleCommand::Torque(f64::from(action[i]) * muscles[i].torque_max)
            })
        }
        _ => towards(state.equilibrium),
    }
}

/// A control step is ten physics steps under one drive: the world afterwards is the same to the bit,
/// touch is the mean of their forces, the facts tell whether there ever was one, and the support
/// goes after the first 20 of them with enclosing contact in 190 physics steps. Catches forces of
/// the last physics step alone, and contacts that are counted once a control step.
#[test]
fn a_step_is_ten_physics_steps() {
    for control in CONTROLS {
        let task = grasp(with_control(control));
        let mut env = asked(task.clone(), 1, before_the_palm(&task, 0.03));
        let mut world = state(&env).world.clone();
        let mut counts: Vec<u32> = Vec::new();
        let (mut reach, mut palm_reach, mut support) = (false, false, true);
        loop {
            let action = script(&task, state(&env), true);
            env.step(&action).unwrap();
            let (shown, state) = (record(&env), state(&env));
            let drive = drive(&task, action, state);
            let (mut forces, mut enclosing) = ([0.0; 3], 0);
            for _ in 0..10 {
                task.robot.step(&mut world, &drive);
                let touch = task.robot.touch(&world);
                for (sum, force) in forces
                    .iter_mut()
                    .zip([touch.palm, touch.thumb, touch.fingers])
                {
                    *sum += force;
                }
                enclosing += u32::from(touch.encloses());
                reach |= touch.any();
                palm_reach |= touch.palm > 0.0;
            }
            counts.push(enclosing);
            let enclosed: u32 = counts.iter().rev().take(20).sum();
            let in_hand = task.in_hand(&world, state.case.radius());
            if support && counts.len() >= 20 && enclosed >= 190 && in_hand {
                task.robot.remove_support(&mut world);
                support = false;
            }
            assert_eq!(bytes(&world), bytes(&state.world), "{control}");
            assert_eq!((state.reach, state.palm_reach), (reach, palm_reach));
            for (i, force) in forces.into_iter().enumerate() {
                let felt = (force / 10.0 / 20.0).min(1.0);
                let shown = f64::from(shown.senses[at::TOUCH + i]);
                assert!((shown - felt).abs() < 1e-6, "{shown} {felt}");
            }
            if ended(&shown) {
                assert_eq!(state.progress.outcome, Outcome::Success, "{control}");
                assert!(!support);
                break;
            }
        }
    }
}

/// Each control does what its name says: an angle added to the equilibrium point and kept, a share
/// of the range, a torque against damping alone. Catches mixed-up units and joints.
#[test]
fn controls_act_on_their_quantity() {
    let played = |control, actions: &[[f32; 4]]| {
        let task = grasp(with_control(control));
        let start = GraspRequest {
            start: Some([0.0, 1.0]),
            object: ObjectPlace::At([0.0, 0.32]),
            ..of_size(0.024)
        };
        let mut env = asked(task.clone(), 0, start);
        for action in actions {
            env.step(action).unwrap();
        }
        let state = state(&env).clone();
        (task, state)
    };
    let near = |a: [f64; 4], b: [f64; 4], tolerance: f64| {
        let close = a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance);
        assert!(close, "{a:?} {b:?}");
    };
    let (_, delta) = played(
        Control::DeltaPosture,
        &[[1.0, -0.5, 0.4, 0.2], [0.2, 0.0, -1.0, 0.2]],
    );
    let moved = [0.0 + 6.0, 1_f64.to_degrees() - 2.5, 0.0, 2.0];
    near(delta.equilibrium.map(f64::to_degrees), moved, 1e-5);
    let (_, posture) = played(Control::Posture, &[[-0.2, -0.5, 0.5, 1.0]]);
    // Ranges −75…180°, 5…130°, 0…90° and 0…90°.
    near(
        posture.equilibrium.map(f64::to_degrees),
        [27.0, 36.25, 67.5, 90.0],
        1e-5,
    );
    let (task, torque) = played(Control::Torque, &[[0.1, -0.05, 0.2, 0.5]; 4]);
    // T / K_D: 200 N·m against 200 N·m·s/rad, and 0.5 against 0.5.
    near(
        task.robot.speeds(&torque.world),
        [0.1, -0.05, 0.2, 0.5],
        2e-2,
    );
}

/// Where an obstacle stands in the way of the arm's swing.
fn in_the_way(task: &GraspTask) -> GraspRequest {
    let hand = task.before_palm([0.7, 0.8], 0.0, 0.02);
    GraspRequest {
        start: Some([0.2, 0.8]),
        object: ObjectPlace::At([-0.2, 0.15]),
        diameter: Some(0.024),
        obstacle: Some(obstacle(hand, 0.02)),
        ..GraspRequest::default()
    }
}

/// The first touch of the obstacle is a collision and the end, in every control. Catches an obstacle
/// that is seen and not felt, and one that the object's touch sets off.
#[test]
fn touching_the_obstacle_ends_the_episode() {
    for control in CONTROLS {
        let task = grasp(with_control(control));
        let mut env = asked(task.clone(), 0, in_the_way(&task));
        let posture = task.robot.open_hand([1.2, 0.8]);
        for step in 0.. {
            let action = asking_for(&task, state(&env), posture);
            env.step(&action).unwrap();
            let (shown, state) = (record(&env), state(&env));
            let posture = task.robot.posture(&state.world);
            let stands = state.case.obstacle.unwrap();
            let gap = task.robot.clearance_of_vertical(posture, stands.centre) - stands.radius;
            assert_eq!(
                state.progress.outcome == Outcome::Collision,
                shown.step.terminated
            );
            if shown.step.terminated {
                assert!(gap.abs() < 2e-3, "{gap} m");
                assert_eq!(shown.step.terms[3], -1.0);
                assert!(!state.progress.is_success && !state.reach);
                break;
            }
            assert!(gap > -1e-4 && step < 100, "{gap} m");
        }
    }
    // Without it the same swing goes on.
    let task = grasp(with_control(Control::Posture));
    let request = GraspRequest {
        obstacle: None,
        ..in_the_way(&task)
    };
    let mut env = asked(task.clone(), 0, request);
    let posture = task.robot.open_hand([1.2, 0.8]);
    for _ in 0..60 {
        let action = asking_for(&task, state(&env), posture);
        env.step(&action).unwrap();
        assert_eq!(state(&env).progress.outcome, Outcome::Running);
    }
}

/// Actions beyond −1…1 are played as the bounds are, and the equilibrium points stay in the joint
/// ranges. Catches muscles that pull out of the ranges.
#[test]
fn actions_are_clipped() {
    for control in CONTROLS {
        let task = grasp(with_control(control));
        let [mut inside, mut outside] =
            [(); 2].map(|()| asked(task.clone(), 4, GraspRequest::default()));
        for _ in 0..25 {
            inside.step(&[1.0, -1.0, 1.0, -1.0]).unwrap();
            outside.step(&[1e30, -7.0, 1.1, f32::MIN]).unwrap();
            assert_eq!(playing::bits(&inside), playing::bits(&outside));
            if ended(&record(&inside)) {
                break;
            }
        }
        if control != Control::Torque {
            let clamped = task.robot.clamp(state(&inside).equilibrium);
            assert_eq!(clamped, state(&inside).equilibrium);
        }
    }
}

/// Recording keeps one moment for the reset and one for each step and changes nothing else.
#[test]
fn recording_changes_nothing() {
    let options = with_control(Control::Posture);
    let recording = GraspOptions {
        record: true,
        ..options
    };
    let task = grasp(options);
    let near = before_the_palm(&task, 0.04);
    let mut plain = asked(task, 0, near);
    let mut recorded = asked(grasp(recording), 0, near);
    let mut actions = Actions::of_width(1, 4);
    for step in 1..=20 {
        let action = actions.draw();
        plain.step(&action).unwrap();
        recorded.step(&action).unwrap();
        assert_eq!(record(&plain), record(&recorded));
        assert_eq!(state(&recorded).trail.len(), step + 1);
        assert!(state(&plain).trail.is_empty());
        let moment = state(&recorded).trail.last().unwrap();
        let object = plain.task().robot.object(&state(&plain).world);
        assert_eq!(moment.object, [object.x, object.y, object.z]);
        assert_eq!(moment.gaze, state(&plain).gaze);
    }
}
