//! Cases of grasping: what is drawn can be played, what is asked for is what is played, and the rest
//! is refused by name.

mod playing;

use babble_env::tasks::grasp::{GraspCase, GraspRequest, InHand, ObjectPlace, Region, protocol};
use babble_env::{
    Autoreset, Batch, Config, Control, EnvError, Executor, GraspOptions, GraspTask, Purpose,
    Reward, Stop, Stream,
};
use nalgebra::Vector3;
use playing::bits;
use playing::grasping::{asked, goal_form, grasp, grasp_with, obstacle, with_control};

fn tasks() -> Vec<GraspTask> {
    let mut tasks = Vec::new();
    for body in ["paper", "icub"] {
        for &region in Region::ALL {
            for goal in [false, true] {
                let base = if goal {
                    goal_form(Control::Posture)
                } else {
                    GraspOptions::default()
                };
                let options = GraspOptions { region, ..base };
                tasks.push(GraspTask::new(Config::profile(body).unwrap(), options).unwrap());
            }
        }
    }
    tasks
}

/// The gap between the open hand and the object at the start.
fn gap(task: &GraspTask, case: &GraspCase) -> f64 {
    let centre = Vector3::new(case.object[0], case.object[1], 0.0);
    task.robot
        .clearance(task.robot.open_hand(case.start), &centre)
        - case.radius()
}

fn random(task: &GraspTask, n: usize, seed: u64, purpose: Purpose) -> Vec<GraspCase> {
    protocol::random(task, n, seed, purpose, &mut Executor::new(2).unwrap()).unwrap()
}

fn polar([x, y]: [f64; 2]) -> [f64; 2] {
    [x.hypot(y), y.atan2(x).to_degrees()]
}

fn inside(value: f64, [low, high]: [f64; 2]) -> bool {
    (low - 1e-9..=high + 1e-9).contains(&value)
}

/// Sampled cases keep to their region and its joint ranges, with the arm clear of the object, which
/// some posture brings to the palm; both diameters occur and the region is filled; there is no
/// obstacle, and a goal in the goal form alone, at least 5 cm away. Catches a region of the other
/// body, degrees for radians, and a clearance from the object's centre.
#[test]
fn drawn_cases_keep_to_their_region() {
    for task in tasks() {
        let cases = random(&task, 150, 1, Purpose::Test);
        let region = task.region();
        for case in &cases {
            let [radius, direction] = polar(case.object);
            assert!(inside(radius, region.radius_m) && inside(direction, region.polar_deg));
            assert!(task.arm.in_range(case.start));
            for (q, range) in case
                .start
                .iter()
                .zip([region.shoulder_deg, region.elbow_deg])
            {
                assert!(inside(q.to_degrees(), range), "{case:?}");
            }
            assert!(gap(&task, case) >= 0.005, "{case:?}");
            let there = task
                .grasp_posture(case.object, case.radius())
                .expect("in reach");
            let [x, y] = task.before_palm(there, case.radius(), 0.0);
            assert!((x - case.object[0]).hypot(y - case.object[1]) < 1e-9);
            assert!(task.arm.in_range(there));
            assert_eq!(case.obstacle, None);
            assert_eq!(case.goal.is_some(), task.options.goal);
            if let Some([x, y]) = case.goal {
                let [radius, direction] = polar([x, y]);
                assert!(inside(radius, region.radius_m) && inside(direction, region.polar_deg));
                assert!((x - case.object[0]).hypot(y - case.object[1]) >= 0.05);
            }
        }
        let small = cases.iter().filter(|case| case.diameter == 0.024).count();
        let large = cases.iter().filter(|case| case.diameter == 0.06).count();
        assert!(
            small + large == 150 && small.min(large) > 40,
            "{small} {large}"
        );
        let mut directions: Vec<f64> = cases.iter().map(|case| polar(case.object)[1]).collect();
        directions.sort_by(f64::total_cmp);
        let [low, high] = region.polar_deg;
        let spread = (directions[149] - directions[0]) / (high - low);
        assert!(spread > 0.6, "{spread} of {low}…{high}°");
    }
}

/// Diameters are those of the list, or any between its ends if the config says so.
#[test]
fn diameters_are_a_list_or_a_range() {
    let draw = |json| {
        let task = grasp_with(json, GraspOptions::default());
        let cases = random(&task, 100, 2, Purpose::Test);
        let mut all: Vec<f64> = cases.iter().map(|case| case.diameter).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let mut list = draw(r#"{"grasp": {"diameters_m": [0.05, 0.02, 0.03]}}"#);
    list.dedup();
    assert_eq!(list, [0.02, 0.03, 0.05]);
    let range =
        draw(r#"{"grasp": {"diameters_m": [0.05, 0.02, 0.03], "any_diameter_between": true}}"#);
    assert!(range[0] >= 0.02 && range[0] < 0.025 && range[99] < 0.05 && range[99] > 0.045);
    assert!(range.windows(2).all(|pair| pair[0] < pair[1]));
}

/// Case i depends on purpose, seed and i alone: a longer list begins with the shorter, and no list
/// shares a case with another seed or purpose.
#[test]
fn cases_depend_on_purpose_seed_and_index_alone() {
    let task = grasp(GraspOptions::default());
    let draw = |n, seed, purpose| random(&task, n, seed, purpose);
    let cases = draw(40, 0, Purpose::Test);
    assert_eq!(draw(15, 0, Purpose::Test), cases[..15]);
    for other in [draw(40, 1, Purpose::Test), draw(40, 0, Purpose::Validation)] {
        assert!(other.iter().all(|case| !cases.contains(case)));
    }
}

/// What is asked of a case is what is played, and the rest is drawn as it should be; it is asked of
/// the resets to come too. Catches a request that is taken for a hint.
#[test]
fn requests_are_kept() {
    let task = grasp(goal_form(Control::Posture));
    let model = random(&task, 1, 3, Purpose::Test)[0];
    let aside = obstacle([-0.3, -0.3], 0.02);
    for mask in 0_u32..32 {
        let pick = |bit: u32| mask & (1 << bit) != 0;
        let request = GraspRequest {
            start: pick(0).then_some(model.start),
            object: if pick(1) {
                ObjectPlace::At(model.object)
            } else {
                ObjectPlace::Sampled
            },
            diameter: pick(2).then_some(model.diameter),
            goal: pick(3).then_some([0.1, 0.2]),
            obstacle: pick(4).then_some(aside),
        };
        let mut env = asked(task.clone(), u64::from(mask), request);
        for _ in 0..3 {
            let case = env.state(0).unwrap().case;
            assert!(request.start.is_none_or(|start| start == case.start));
            assert!(
                request
                    .object
                    .point()
                    .is_none_or(|object| object == case.object)
            );
            assert!(
                request
                    .diameter
                    .is_none_or(|diameter| diameter == case.diameter)
            );
            assert!(request.goal.is_none_or(|goal| Some(goal) == case.goal));
            assert_eq!(case.obstacle, request.obstacle);
            assert!(gap(&task, &case) >= 0.005);
            let drawn = env.state(0).unwrap().clone();
            env.reset(&[true]).unwrap();
            let again = env.state(0).unwrap();
            assert_eq!(again.lifecycle.request, request);
            let whole = pick(0) && pick(1) && pick(2) && pick(3);
            assert!(again.case == drawn.case || !whole);
            assert!(again.case != drawn.case || pick(0) && pick(1));
        }
    }
}

/// A new world stands as its case says: posture, object and equilibrium points.
#[test]
fn episodes_begin_as_their_case() {
    let env = playing::seeded(
        grasp(GraspOptions::default()),
        20,
        Autoreset::Disabled,
        1,
        0,
    );
    let task = env.task();
    for i in 0..20 {
        let state = env.state(i).unwrap();
        let open = task.robot.open_hand(state.case.start);
        let posture = task.robot.posture(&state.world);
        assert!(posture.iter().zip(open).all(|(a, b)| (a - b).abs() < 1e-6));
        assert_eq!(state.equilibrium, open);
        let [x, y] = state.case.object;
        assert!((task.robot.object(&state.world) - Vector3::new(x, y, 0.0)).norm() < 1e-6);
        assert!(task.robot.has_support(&state.world) && !task.robot.touch(&state.world).any());
        assert!(!state.reach && state.touch == [0.0; 3] && state.progress.steps == 0);
    }
}

/// Table II: 12 positions times 12 starts for each diameter; Fig. 7 the first 11 of those starts.
/// What is there can be played. Catches starts on a joint limit, and a grid in another order.
#[test]
fn the_papers_grids() {
    for body in ["paper", "icub"] {
        let task = GraspTask::new(Config::profile(body).unwrap(), GraspOptions::default());
        let task = task.unwrap();
        let (table2, fig7) = (protocol::table2(&task), protocol::fig7(&task));
        assert_eq!((table2.len(), fig7.len()), (2 * 144, 2 * 132));
        for (position, cases) in table2.chunks_exact(12).enumerate() {
            assert_eq!(fig7[11 * position..][..11], cases[..11]);
            for (start, case) in cases.iter().enumerate() {
                let Some(case) = case else { continue };
                assert_eq!(case.diameter, [0.024, 0.06][position / 12]);
                let [radius, direction] = polar(case.object);
                let at = position % 12;
                assert!((radius - [0.13, 0.21, 0.29][at / 4]).abs() < 1e-12);
                assert!((direction - [-20.0, 40.0, 100.0, 160.0][at % 4]).abs() < 1e-9);
                let share = task.arm.normalised(case.start);
                let expected = [
                    (start / 3) as f64 / 4.0 + 0.125,
                    (start % 3) as f64 / 3.0 + 1.0 / 6.0,
                ];
                assert!((share[0] - expected[0]).abs() + (share[1] - expected[1]).abs() < 1e-9);
                assert!(gap(&task, case) >= 0.005);
            }
        }
        let there = table2.iter().flatten().count();
        println!("{body}: {there} of 288");
        assert!(there > 200, "{there}");
        let mut distinct: Vec<_> = table2.iter().flatten().collect();
        distinct.dedup();
        assert_eq!(distinct.len(), there);
    }
}

/// Case by case what cannot be played, with the part that is named for it.
fn impossible(task: &GraspTask) -> Vec<(&'static str, GraspRequest)> {
    let start = [0.2, 0.8];
    let clear = GraspRequest {
        start: Some(start),
        object: ObjectPlace::At([-0.2, 0.15]),
        ..GraspRequest::default()
    };
    // One millimetre from where an object lies in the hand.
    let near_palm = ObjectPlace::At(task.before_palm(start, 0.03, 0.002));
    let on_arm = task.before_palm(start, 0.0, 0.0);
    let mut all = Vec::new();
    for object in [[0.5, 0.0], [f64::NAN, 0.1], [0.1, f64::INFINITY]] {
        all.push((
            "object",
            GraspRequest {
                object: ObjectPlace::At(object),
                ..clear
            },
        ));
    }
    for start in [[f64::NAN, 1.0], [0.0, -1.0], [4.0, 1.0]] {
        all.push((
            "start",
            GraspRequest {
                start: Some(start),
                ..clear
            },
        ));
    }
    for diameter in [0.0, -0.02, 0.004, 0.3, f64::NAN, f64::INFINITY] {
        all.push((
            "diameter",
            GraspRequest {
                diameter: Some(diameter),
                ..clear
            },
        ));
    }
    for at in [
        obstacle(on_arm, 0.02),
        obstacle([-0.2, 0.14], 0.02),
        obstacle([f64::NAN, 0.1], 0.02),
        obstacle([-0.3, -0.3], 0.0),
        obstacle([-0.3, -0.3], f64::NAN),
    ] {
        all.push((
            "obstacle",
            GraspRequest {
                obstacle: Some(at),
                ..clear
            },
        ));
    }
    let (object, diameter) = (near_palm, Some(0.06));
    all.push((
        "object",
        GraspRequest {
            object,
            diameter,
            ..clear
        },
    ));
    let goals = if task.options.goal {
        [[0.5, 0.5], [f64::NAN; 2]]
    } else {
        [[0.1, 0.2]; 2]
    };
    for goal in goals {
        all.push((
            "goal",
            GraspRequest {
                goal: Some(goal),
                ..clear
            },
        ));
    }
    all
}

/// Cases that overlap or are no numbers are refused by the reset and named; the episode goes on as
/// if nothing had been asked. Catches a half-done reset, and NaN that passes a comparison.
#[test]
fn impossible_cases_are_named() {
    for options in [
        with_control(Control::DeltaPosture),
        goal_form(Control::Torque),
    ] {
        let task = grasp(options);
        let mut env = asked(task.clone(), 2, GraspRequest::default());
        env.step(&[0.5; 4]).unwrap();
        let before = bits(&env);
        for (part, request) in impossible(&task) {
            env.request(0, request).unwrap();
            let error = env.reset(&[true]).unwrap_err();
            assert!(
                matches!(error, EnvError::Case { what, .. } if what == part),
                "{part}, {request:?}: {error}"
            );
            assert_eq!(bits(&env), before);
        }
        env.step(&[0.5; 4]).unwrap();
        env.reset(&[true]).unwrap();
        assert_eq!(
            env.state(0).unwrap().lifecycle.request,
            GraspRequest::default()
        );
    }
}

/// Where no start is clear of the object asked for, the search ends with an error. Catches an
/// endless one.
#[test]
fn a_search_for_cases_ends() {
    let mut env = asked(grasp(GraspOptions::default()), 2, GraspRequest::default());
    let before = bits(&env);
    let object = ObjectPlace::At([0.05, 0.0]);
    let (at_shoulder, diameter) = (
        GraspRequest {
            object,
            ..GraspRequest::default()
        },
        Some(0.2),
    );
    env.request(
        0,
        GraspRequest {
            diameter,
            ..at_shoulder
        },
    )
    .unwrap();
    let error = env.reset(&[true]).unwrap_err();
    assert!(matches!(error, EnvError::NoGraspCase { .. }), "{error}");
    assert_eq!(bits(&env), before);
}

/// NaN, infinite and missing numbers of actions are named with their place, and nothing has moved.
#[test]
fn bad_actions_leave_everything_as_it_was() {
    let mut env = playing::seeded(grasp(GraspOptions::default()), 2, Autoreset::NextStep, 1, 0);
    let before = bits(&env);
    for bad in [f32::NAN, f32::INFINITY] {
        let error = env
            .step(&[0.1, 0.1, 0.1, 0.1, 0.1, 0.1, bad, 0.1])
            .unwrap_err();
        assert!(
            matches!(
                error,
                EnvError::ActionNotFinite {
                    env: 1,
                    index: 2,
                    ..
                }
            ),
            "{error}"
        );
    }
    for got in [0, 4, 7, 9] {
        let expected = EnvError::ActionShape { got, expected: 8 };
        assert_eq!(env.step(&vec![0.0; got]), Err(expected));
    }
    assert_eq!(bits(&env), before);
    let mut fresh = Batch::new(grasp(GraspOptions::default()), 1, Autoreset::NextStep, 1).unwrap();
    assert_eq!(fresh.step(&[0.0; 4]), Err(EnvError::NeedsReset { env: 0 }));
}

/// Options that contradict each other or are out of bounds are named.
#[test]
fn impossible_options_are_named() {
    let base = GraspOptions::default();
    let progress = GraspOptions {
        reward: Reward::Progress,
        ..goal_form(Control::Posture)
    };
    for (options, name) in [
        (progress, "reward"),
        (with_control(Control::Pattern), "control"),
    ] {
        let error = GraspTask::new(Config::profile("paper").unwrap(), options).unwrap_err();
        assert!(
            matches!(error, EnvError::Option { option, .. } if option == name),
            "{error}"
        );
    }
    for max_episode_steps in [0, 1_000_001] {
        let options = GraspOptions {
            max_episode_steps,
            ..base
        };
        let error = GraspTask::new(Config::profile("paper").unwrap(), options).unwrap_err();
        assert!(
            error.to_string().starts_with("max_episode_steps = "),
            "{error}"
        );
    }
    for (json, field) in [
        (r#"{"grasp": {"diameters_m": []}}"#, "grasp.diameters_m"),
        (
            r#"{"grasp": {"diameters_m": [0.03, 0]}}"#,
            "grasp.diameters_m[1]",
        ),
        (r#"{"grasp": {"held_share": 1}}"#, "grasp.held_share"),
        (
            r#"{"grasp": {"palm_side": {"radius_m": [0.3, 0.2]}}}"#,
            "grasp.palm_side.radius_m[1]",
        ),
        (
            r#"{"grasp": {"physics_steps": 251}}"#,
            "grasp.physics_steps",
        ),
        (r#"{"grasp": {"grip": 1}}"#, "grasp.grip"),
    ] {
        let error = Config::from_json(json).unwrap_err();
        assert!(
            matches!(&error, EnvError::Config { field: named, .. } if named == field),
            "{error}"
        );
    }
}

/// Each case comes from its own stream: drawing one does not depend on how often another was drawn.
#[test]
fn a_stream_gives_its_case() {
    let task = grasp(GraspOptions::default());
    let draw = |stream: &mut Stream| {
        GraspRequest::default()
            .draw(&task, stream, &Stop::default())
            .unwrap()
    };
    let mut stream = Stream::new(Purpose::Test, 4, 2);
    let (first, second) = (draw(&mut stream), draw(&mut stream));
    assert_ne!(first, second);
    assert_eq!(random(&task, 3, 4, Purpose::Test)[2], first);
}

/// The object that is put at the palm is 1 mm before it, on its support, untouched; the reflex then
/// has it, and keeps it without the support. Catches a gap on the wrong side, a ball that begins in
/// the hand, and a support that comes back.
#[test]
fn objects_are_put_at_the_palm() {
    let task = GraspTask::new(Config::profile("paper").unwrap(), GraspOptions::default()).unwrap();
    for diameter in [0.024, 0.06] {
        let arm = [0.4, 0.9];
        let mut object = InHand::new(&task, arm, diameter);
        let (world, radius) = (object.world(), diameter / 2.0);
        assert!(task.robot.has_support(world) && !task.robot.touch(world).any());
        assert!((task.pocket_offset(world, radius).norm() - 1e-3).abs() < 1e-5);
        assert!(task.in_hand(world, radius) && !object.is_held(&task));
        assert_eq!(object.start(), arm);
        object.carry(&task, arm, 3.0);
        assert!(object.is_held(&task));
        object.remove_support(&task);
        assert!(object.carry(&task, [0.6, 0.7], 1.0) < 3e-3);
        assert!(object.is_held(&task) && !task.robot.has_support(object.world()));
    }
}
