//! A held object follows the hand; an object that something helps to press is not held.

mod playing;

use std::sync::Arc;

use babble_body::Obstacle;
use babble_body::robot::{Posture, Touch, towards};
use babble_env::tasks::grasp::{GraspRequest, GraspState, Grip, ObjectPlace};
use babble_env::{Autoreset, Batch, Control, GraspTask, Purpose, Stream};
use playing::grasping::{asking_for, grasp_with, obstacle, play, with_control};
use playing::{ended, record, seeded};

/// Control steps that are enough to enclose an object and to hold it: twice 20 and some more.
const LASTING: u32 = 60;

fn state(env: &Batch<GraspTask>) -> &GraspState {
    env.state(0).unwrap()
}

fn task_with(json: &str) -> Arc<GraspTask> {
    grasp_with(json, with_control(Control::Posture))
}

fn engine(name: &str) -> Arc<GraspTask> {
    task_with(&format!(r#"{{"body": {{"engine": "{name}"}}}}"#))
}

fn begun(task: &Arc<GraspTask>, request: GraspRequest) -> Batch<GraspTask> {
    let mut env = seeded(task.clone(), 1, Autoreset::Disabled, 1, 0);
    env.request(0, request).unwrap();
    env.reset(&[true]).unwrap();
    env
}

/// A point of the plane from the forearm's direction: so far along it, and so far to the palm's side.
fn beside(arm: [f64; 2], from: [f64; 2], along: f64, aside: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(arm[0] + arm[1]);
    let [x, y] = from;
    [x + along * cos - aside * sin, y + along * sin + aside * cos]
}

/// Whether the hand touches the object as if it enclosed it.
fn both_sides(touch: &Touch) -> bool {
    touch.fingers > 0.0 && (touch.palm > 0.0 || touch.thumb > 0.0)
}

/// Pulls to one posture throughout an episode, in which nothing is ever held; how many control steps
/// ended with the object touched in such a way.
fn press(env: &mut Batch<GraspTask>, to: Posture, touched: impl Fn(&Touch) -> bool) -> u32 {
    let task = env.task().clone();
    let mut lasted = 0;
    loop {
        env.step(&asking_for(&task, state(env), to)).unwrap();
        let touch = task.robot.touch(&state(env).world);
        lasted += u32::from(touched(&touch));
        assert_ne!(state(env).enclosure.grip, Grip::Held);
        if ended(&record(env)) {
            return lasted;
        }
    }
}

/// A case whose obstacle stands behind the object, seen from the palm of a hand that comes straight.
fn before_an_obstacle(task: &GraspTask, object: [f64; 2], shift: f64) -> (GraspRequest, [f64; 2]) {
    let radius = 0.03;
    let arm = task.grasp_posture(object, radius).unwrap();
    let Obstacle { radius: wide, .. } = obstacle(object, 0.035);
    let centre = beside(arm, object, 0.0, radius + wide + 0.0005);
    // The object lies where the open fingers meet the palm.
    let arm = task.grasp_posture(beside(arm, object, -shift, 0.0), radius);
    let request = GraspRequest {
        start: Some([arm.unwrap()[0] - 1.0, 0.6]),
        object: ObjectPlace::At(object),
        diameter: Some(2.0 * radius),
        obstacle: Some(obstacle(centre, wide)),
        ..GraspRequest::default()
    };
    (request, arm.unwrap())
}

/// An open hand, or one with fingers a little bent, that presses an object against the obstacle touches
/// it with palm and fingers for longer than a grasp takes, and holds nothing: away from the obstacle it
/// would lose it. Catches contacts that count whatever else presses the object, in either engine.
#[test]
fn an_object_pinned_against_the_obstacle_is_not_held() {
    for (name, objects) in [
        ("tree", &[[0.0, 0.24], [0.05, 0.22]][..]),
        ("rapier", &[[0.0, 0.24]]),
    ] {
        let task = engine(name);
        let mut lasted = Vec::new();
        for &object in objects {
            for (shift, bent, further) in [(0.03, 0.0, 0.05), (0.035, 0.0, 0.3), (0.03, 0.15, 0.1)]
            {
                let (request, arm) = before_an_obstacle(&task, object, shift);
                let to = [arm[0] + further, arm[1] + further, 0.0, bent];
                lasted.push(press(&mut begun(&task, request), to, |touch| {
                    both_sides(touch) && touch.obstacle > 0.0
                }));
            }
        }
        assert!(
            lasted.iter().any(|&steps| steps >= LASTING),
            "{name}: {lasted:?}"
        );
    }
}

/// The same with the upper arm behind the object: an elbow that bends far presses it between upper arm
/// and hand.
#[test]
fn an_object_pinned_against_the_upper_arm_is_not_held() {
    let body =
        r#"{"body": {"joints": {"elbow": {"upper_deg": 160}}}, "grasp": {"palm_reach_m": 0.2}}"#;
    for engine in ["tree", "rapier"] {
        let task = task_with(&body.replacen(
            r#""joints""#,
            &format!(r#""engine": "{engine}", "joints""#),
            1,
        ));
        let start = [0.4, 1.93];
        let mut lasting = 0;
        for diameter in [0.08, 0.1, 0.13] {
            let request = GraspRequest {
                start: Some(start),
                object: ObjectPlace::At(task.before_palm(start, diameter / 2.0, 0.007)),
                diameter: Some(diameter),
                ..GraspRequest::default()
            };
            let to = [start[0], 2.7, 0.0, 0.75];
            let steps = press(&mut begun(&task, request), to, |touch| {
                both_sides(touch) && touch.arm > 0.0
            });
            lasting += u32::from(steps >= LASTING);
        }
        assert!(lasting >= 1, "{engine}: pinned for long {lasting} times");
    }
}

/// Fingers that bend a little and push an object along its support have it between them and the palm,
/// and the support's friction presses it there. It counts as enclosed while the support carries it, and
/// is lost without. Catches a support that stays.
#[test]
fn an_object_that_the_support_carries_is_not_held() {
    for name in ["tree", "rapier"] {
        let task = engine(name);
        let start = [0.2, 0.8];
        let object = beside(start, task.before_palm(start, 0.03, 0.007), 0.03, 0.0);
        let request = GraspRequest {
            start: Some(start),
            object: ObjectPlace::At(object),
            diameter: Some(0.06),
            ..GraspRequest::default()
        };
        let mut lasted = Vec::new();
        for bent in [0.1, 0.3, 0.5] {
            let to = [start[0] + 1.5, start[1], 0.0, bent];
            let mut env = begun(&task, request);
            lasted.push((press(&mut env, to, both_sides), state(&env).enclosure.grip));
        }
        assert!(
            lasted.iter().any(|&(steps, _)| steps >= 20),
            "{name}: {lasted:?}"
        );
    }
}

/// Moves the arm to random postures for 3 s, the hand's muscles pulling as before; how far the object
/// then is from where it was in the palm's frame \[m\], if the hand alone has it.
fn carried(task: &GraspTask, held: &GraspState, seed: u64) -> Option<f64> {
    let (mut world, radius) = (held.world.clone(), held.case.radius());
    let before = task.pocket_offset(&world, radius);
    let mut stream = Stream::new(Purpose::Test, seed, 3);
    let [.., thumb, finger] = held.equilibrium;
    for _ in 0..6 {
        let [shoulder, elbow] = task.draw_free_posture(radius, &mut stream).unwrap();
        for _ in 0..100 {
            task.robot
                .step(&mut world, &towards([shoulder, elbow, thumb, finger]));
        }
    }
    let has = task.in_hand(&world, radius) && both_sides(&task.robot.touch(&world));
    has.then(|| (task.pocket_offset(&world, radius) - before).norm())
}

/// A hand that closes around an object as the reflex does holds it, and the object then follows the
/// hand through 3 s of arm motion, from one random posture to another every half second. Catches a
/// measure that a loose or pinned object passes.
#[test]
fn a_held_object_follows_the_hand() {
    for (name, seeds) in [("tree", 16), ("rapier", 3)] {
        let task = engine(name);
        let mut held = 0;
        for seed in 0..seeds {
            let mut env = seeded(task.clone(), 1, Autoreset::Disabled, 1, seed);
            play(&mut env, true, |_| {});
            if state(&env).enclosure.grip != Grip::Held {
                continue;
            }
            held += 1;
            let moved = carried(&task, state(&env), seed);
            assert!(
                moved.is_some_and(|moved| moved < 0.01),
                "{name} {seed}: {moved:?}"
            );
        }
        assert!(held * 10 >= seeds * 9, "{name}: {held} of {seeds} held");
    }
}
