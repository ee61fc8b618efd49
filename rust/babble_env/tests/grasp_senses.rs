//! What is sensed of a grasping episode, against the body's own functions.

mod playing;

use babble_body::visual;
use babble_env::batch::Record;
use babble_env::tasks::grasp::{
    FOVEA_NEURONS, GraspRequest, GraspState, ObjectPlace, Region, at, see,
};
use babble_env::{Autoreset, Config, Control, GraspOptions, GraspTask};
use babble_eye::{Gaze, Material, Primitive, Shape, foveal_shape, red_centroid};
use nalgebra::{Matrix3, Vector3};
use playing::grasping::{
    CONTROLS, asked, before_the_palm, bounds, grasp, grasp_with, obstacle, script, with_control,
};
use playing::{Actions, ended, record, seeded};

const BODIES: [&str; 2] = ["paper", "icub"];

fn task_of(body: &str, options: GraspOptions) -> std::sync::Arc<GraspTask> {
    GraspTask::new(Config::profile(body).unwrap(), options)
        .unwrap()
        .into()
}

/// Whatever is played, observations are finite and inside the bounds that the spec promises, on both
/// bodies, in both regions and in every control, with the object out of reach and in the hand.
/// Catches a muscle stretched further than the spec says, and forces above the greatest.
#[test]
fn observations_keep_to_the_spec() {
    for body in BODIES {
        for &region in Region::ALL {
            for control in CONTROLS {
                let options = GraspOptions {
                    region,
                    enclosure_reflex: true,
                    ..with_control(control)
                };
                let mut env = seeded(task_of(body, options), 4, Autoreset::NextStep, 1, 70);
                let near = before_the_palm(env.task(), 0.06);
                env.request(0, near).unwrap();
                env.request(1, before_the_palm(env.task(), 0.024)).unwrap();
                env.reset(&[true; 4]).unwrap();
                let bounds = bounds(env.task());
                let mut actions = Actions::of_width(4, 4);
                let mut held = [0.0; 4];
                for step in 0..80 {
                    // Random, but for a while the same, so that it gets somewhere.
                    let drawn = actions.draw();
                    if step % 10 == 0 {
                        held = *drawn.first_chunk().unwrap();
                    }
                    env.step(&[&drawn[..12], &held].concat()).unwrap();
                    for Record { senses, .. } in env.records() {
                        for (x, (name, low, high)) in senses.iter().zip(&bounds) {
                            let inside = low <= x && x <= high;
                            assert!(inside, "{body} {region} {control}: {name} = {x}");
                        }
                    }
                }
            }
        }
    }
}

/// Joint angles and stretch add up to the equilibrium points, and the clock runs. Catches shares of
/// other ranges, a stretch of the wrong sign, and equilibrium points of the step before.
#[test]
fn stretch_leads_to_the_equilibrium_points() {
    for control in CONTROLS {
        let task = grasp(with_control(control));
        let mut env = asked(task.clone(), 0, before_the_palm(&task, 0.03));
        let mut actions = Actions::of_width(1, 4);
        let mut compared = 0;
        for step in 1..=60 {
            env.step(&actions.draw()).unwrap();
            let (shown, state) = (record(&env), env.state(0).unwrap());
            let joints = [at::ARM, at::ARM + 1, at::HAND, at::HAND + 1];
            let share = joints.map(|at| f64::from(shown.senses[at]));
            let angles = task.robot.denormalised(share);
            let posture = task.robot.posture(&state.world);
            for i in 0..4 {
                // A joint at its stop may be a hair beyond its range.
                assert!((angles[i] - posture[i]).abs() < 1e-2, "{control} {i}");
                let stretch = f64::from(shown.senses[at::STRETCH + i]);
                let beyond = state.equilibrium[i] - posture[i] - stretch;
                // Torque on a joint at its stop: cut to the bound.
                let cut = stretch.abs() >= task.stretch_bounds()[i] - 1e-6;
                assert!(
                    beyond.abs() < if cut { 1e-2 } else { 1e-6 },
                    "{control} {i}"
                );
                if (0.001..0.999).contains(&share[i]) {
                    assert!((angles[i] + stretch - state.equilibrium[i]).abs() < 1e-5);
                    compared += 1;
                }
            }
            let elapsed = step as f32 / task.options.max_episode_steps as f32;
            assert!((shown.senses[at::TIME] - elapsed).abs() < 1e-6);
            if ended(&shown) {
                break;
            }
        }
        assert!(compared > 100, "{control}: {compared}");
    }
}

/// Muscles can be stretched by the joint ranges, and torques by as much as a spring would have to be
/// that pulls as hard as the greatest one.
#[test]
fn stretch_is_bounded_by_ranges_or_torques() {
    for control in CONTROLS {
        let bounds = bounds(&grasp(with_control(control)));
        let expected = if control == Control::Torque {
            // 200 N·m over 200 N·m/rad, and 0.5 over 0.5.
            [1.0; 4]
        } else {
            [255.0, 125.0, 90.0, 90.0].map(f32::to_radians)
        };
        for (&(name, low, high), most) in bounds[at::STRETCH..].iter().zip(expected) {
            assert!(
                (high - most).abs() < 1e-6 && low == -high,
                "{control} {name}: {high}"
            );
        }
    }
}

/// The palm is first felt on the step after which the palm has touched the object, and something is
/// felt only of an object that was touched. Catches forces of another part, and facts that lag.
#[test]
fn touch_and_facts_agree() {
    for control in CONTROLS {
        for diameter in [0.024, 0.06] {
            let task = grasp(with_control(control));
            let mut env = asked(task.clone(), 0, before_the_palm(&task, diameter));
            let (mut before, mut felt) = (false, [0; 3]);
            loop {
                let action = script(&task, env.state(0).unwrap(), true);
                env.step(&action).unwrap();
                let (shown, state) = (record(&env), env.state(0).unwrap());
                let touch = &shown.senses[at::TOUCH..];
                assert_eq!(state.palm_reach, before || touch[0] > 0.0);
                assert!(state.reach || touch.iter().all(|&force| force == 0.0));
                before = state.palm_reach;
                for (count, &force) in felt.iter_mut().zip(touch) {
                    *count += u32::from(force > 0.0);
                }
                if ended(&shown) {
                    break;
                }
            }
            assert!(felt.iter().all(|&count| count > 20), "{felt:?}");
        }
    }
}

/// What the eye sees, put together anew: the object, arm and hand, the obstacle, and a plain table
/// below them.
fn scene(task: &GraspTask, state: &GraspState) -> Vec<Primitive> {
    let mut scene = vec![task.robot.visible_object(&state.world, state.case.radius())];
    task.robot.push_visible(&state.world, &mut scene);
    let obstacle = state.case.obstacle.as_ref();
    scene.extend(obstacle.map(|obstacle| visual::obstacle(&task.config.body, obstacle)));
    let top = -task.config.body.hand.palm_height_m / 2.0 - 0.005;
    let table = Shape::Cuboid {
        centre: Vector3::new(0.0, 0.1, top - 0.01),
        rotation: Matrix3::identity(),
        half_extents: Vector3::new(0.6, 0.6, 0.01),
    };
    scene.push(Primitive::new(table, Material::plain([196, 196, 188])));
    scene
}

/// The edges in the fovea.
fn fovea(task: &GraspTask, scene: &[Primitive], gaze: Gaze) -> Vec<f32> {
    let mut edges = [0.0; FOVEA_NEURONS];
    foveal_shape(scene, &task.eye.camera(gaze), &mut edges);
    edges.to_vec()
}

/// Eye and fovea of an observation are those of that gaze on that scene.
fn assert_sees(task: &GraspTask, state: &GraspState, shown: &Record) {
    let scene = scene(task, state);
    let gaze = task.eye.normalised(state.gaze).map(|x| x as f32);
    assert_eq!(shown.senses[at::EYE..at::FOVEA], gaze);
    let edges = fovea(task, &scene, state.gaze);
    assert_eq!(shown.senses[at::FOVEA..at::HAND], edges);
}

/// At the start the object is in the middle of the image, but where the arm hides it or the eye
/// cannot turn so far; the fovea shows edges. Catches an eye that begins where it was, and one that
/// looks at the goal or at the hand.
#[test]
fn the_eye_begins_on_the_object() {
    for body in BODIES {
        for &region in Region::ALL {
            let options = GraspOptions {
                region,
                ..GraspOptions::default()
            };
            let env = seeded(task_of(body, options), 40, Autoreset::Disabled, 1, 500);
            let (task, mut centred) = (env.task().clone(), 0);
            for (i, shown) in env.records().enumerate() {
                let state = env.state(i).unwrap();
                assert_sees(&task, state, shown);
                let camera = task.eye.camera(state.gaze);
                let Some([x, y]) = red_centroid(&scene(&task, state), &camera) else {
                    assert_eq!(state.gaze, task.eye.rest());
                    continue;
                };
                let middle = task.eye.config().pixels as f64 / 2.0;
                let off = (x - middle).abs().max((y - middle).abs());
                let edges = &shown.senses[at::FOVEA..at::HAND];
                if off < 0.6 {
                    centred += 1;
                    assert!(edges.iter().any(|&edge| edge > 0.1), "{body} {region} {i}");
                }
                // The same by the function that others use.
                let mut seen = [0.0; FOVEA_NEURONS];
                let gaze = see(&task, &state.world, &state.case, &mut seen).unwrap();
                assert_eq!((gaze, edges), (state.gaze, &seen[..]));
            }
            println!("{body} {region}: {centred} of 40 in the middle");
            assert!(centred >= 36, "{body} {region}: {centred} of 40");
        }
    }
}

/// Each step the gaze is one step of Eq. 1 from the gaze before, on the scene after it, and stays
/// where nothing red is seen; the fovea is that of the new gaze. Catches a scene of the step before,
/// an eye that jumps to the object, and one that turns towards the obstacle.
#[test]
fn the_eye_follows_by_the_reflex() {
    for body in BODIES {
        let task = task_of(body, with_control(Control::Posture));
        let near = GraspRequest {
            obstacle: Some(obstacle([-0.25, -0.1], 0.02)),
            ..before_the_palm(&task, 0.05)
        };
        let mut moved = 0;
        for request in [near, GraspRequest::default()] {
            let mut env = asked(task.clone(), 7, request);
            for _ in 0..120 {
                let before = env.state(0).unwrap().clone();
                let action = script(&task, &before, true);
                env.step(&action).unwrap();
                let (shown, state) = (record(&env), env.state(0).unwrap());
                let next = task.eye.reflex_step(&scene(&task, state), before.gaze);
                assert_eq!(state.gaze, next.unwrap_or(before.gaze));
                assert_sees(&task, state, &shown);
                moved += u32::from(state.gaze != before.gaze);
                if ended(&shown) {
                    break;
                }
            }
        }
        assert!(moved > 30, "{body}: {moved}");
    }
}

/// Where all of the object is hidden, here behind a tall obstacle, the eye looks straight ahead and
/// stays there. Catches an eye that sees through things, and a reset that fails.
#[test]
fn a_hidden_object_leaves_the_eye_where_it_is() {
    let tall = r#"{"body": {"obstacle": {"height_m": 0.4}}}"#;
    let task = grasp_with(tall, with_control(Control::Posture));
    // From the object 67 mm towards the eye, which is at (0, 0.1, 0.25).
    let request = GraspRequest {
        start: Some([-1.0, 0.5]),
        object: ObjectPlace::At([-0.2, 0.15]),
        diameter: Some(0.024),
        obstacle: Some(obstacle([-0.135, 0.134], 0.05)),
        ..GraspRequest::default()
    };
    let mut env = asked(task.clone(), 0, request);
    for _ in 0..10 {
        let state = env.state(0).unwrap();
        assert_eq!(state.gaze, task.eye.rest());
        assert_sees(&task, state, &record(&env));
        let mut edges = [0.0; FOVEA_NEURONS];
        assert_eq!(see(&task, &state.world, &state.case, &mut edges), None);
        env.step(&[-0.9, 0.0, 0.0, 0.0]).unwrap();
    }
    let request = GraspRequest {
        obstacle: None,
        ..request
    };
    let env = asked(task.clone(), 0, request);
    assert_ne!(env.state(0).unwrap().gaze, task.eye.rest());
}
