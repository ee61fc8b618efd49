//! Whole movements, and their kinship with the same movement made step by step.

mod playing;

use babble_body::Pull;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Autoreset, Batch, Config, Control, Outcome, Purpose, ReachCase, ReachOptions, ReachTask, Stream,
};
use playing::{control, task};

/// Random geometries with a random b1, legal or not.
fn movements(task: &ReachTask, n: u64) -> Vec<(ReachCase, [f64; 2])> {
    (0..n)
        .map(|i| {
            let mut stream = Stream::new(Purpose::Test, 11, i);
            let case = ReachCase::draw_geometry(task, &mut stream).unwrap();
            let b1 = stream.uniform(0.01, 0.99);
            (case, [b1, 1.0 - b1])
        })
        .collect()
}

/// An environment that is reset to play `case`, with its postures recorded.
fn play(options: ReachOptions, case: &ReachCase) -> Batch<ReachTask> {
    let options = ReachOptions {
        record: true,
        max_episode_steps: 1000,
        ..options
    };
    let mut env = Batch::new(task(options), 1, Autoreset::Disabled, 1).unwrap();
    let request = CaseRequest {
        start: Some(case.hand),
        target: Some(case.target),
        obstacle: case
            .obstacle
            .map_or(ObstacleRequest::Absent, ObstacleRequest::At),
    };
    env.request(0, request).unwrap();
    env.reset(&[true]).unwrap();
    env
}

/// A step of `pattern` control is the movement of `MovementPath`, and that is the muscles pulled
/// along the plan one control period after the other, to the same bits. Catches a second stepping
/// code with a period, a touch or a settling time of its own.
#[test]
fn pattern_step_is_the_plan_played_posture_by_posture() {
    let pattern = task(control(Control::Pattern));
    for (case, _) in movements(&pattern, 60) {
        let action = [0.5_f32, -0.5];
        let mut env = play(control(Control::Pattern), &case);
        env.step(&action).unwrap();
        let state = env.state(0).unwrap().clone();
        let path = MovementPath::new(&pattern, &state.case, [0.75, 0.25]).unwrap();
        let mut trail = vec![case.start];
        let movement = path.play(&pattern, &state.case, Fidelity::Full, |arm| {
            trail.push(arm.q);
        });
        assert_eq!(
            (state.progress.outcome, state.arm),
            (movement.outcome, movement.arm)
        );
        assert_eq!(state.trail, trail);

        let mut arm = babble_body::ArmState::at_rest(state.case.start);
        let mut watch = pattern.watch(state.case.obstacle, arm.q);
        let settling = std::iter::repeat(path.postures().last().copied().unwrap_or(case.start));
        let plan = path.postures().iter().copied().chain(settling);
        for (&expected, q_des) in trail[1..].iter().zip(plan) {
            pattern.advance(&mut arm, &mut watch, Pull::Towards(q_des));
            assert_eq!(arm.q, expected);
        }
    }
}

/// The same plan as actions of `posture` control: the same trajectory and the same end, to the f32
/// of the actions. Catches a posture scaled to other ranges than the plan's.
#[test]
fn posture_control_plays_the_same_plan() {
    let pattern = task(control(Control::Pattern));
    let mut compared = 0;
    for (case, b) in movements(&pattern, 40) {
        let path = MovementPath::new(&pattern, &case, b).unwrap();
        let mut trail = Vec::new();
        let movement = path.play(&pattern, &case, Fidelity::Full, |arm| trail.push(arm.q));
        let mut env = play(control(Control::Posture), &case);
        for (&q_des, expected) in path.postures().iter().zip(&trail) {
            let action = pattern
                .arm
                .normalised(q_des)
                .map(|share| (2.0 * share - 1.0) as f32);
            env.step(&action).unwrap();
            let state = env.state(0).unwrap();
            for i in 0..2 {
                assert!((state.arm.q[i] - expected[i]).abs() < 1e-6);
            }
            compared += 1;
            if state.progress.outcome != Outcome::Running {
                break;
            }
        }
        let outcome = env.state(0).unwrap().progress.outcome;
        if movement.outcome == Outcome::Collision && trail.len() <= path.postures().len() {
            assert_eq!(outcome, Outcome::Collision);
        }
    }
    assert!(compared > 2000, "{compared} steps");
}

/// With muscles as fast as the physics step the full simulation is the quasi-static one: the same
/// outcomes, and the arm within a milliradian of the plan. Catches a lag, a touch or an order of
/// events in one of the two alone.
#[test]
fn fast_muscles_are_quasi_static() {
    let mut config = Config::profile("paper").unwrap();
    config.body.muscles.kp = 1e5;
    config.body.muscles.kd = 1.0;
    config.body.arm.density_kg_m3 = 1.0;
    let task = ReachTask::new(config, control(Control::Pattern)).unwrap();
    let (mut same, mut seen) = (0, std::collections::BTreeSet::new());
    let all = movements(&task, 300);
    for (case, b) in &all {
        let path = MovementPath::new(&task, case, *b).unwrap();
        let mut trails = [Vec::new(), Vec::new()];
        let [full, still] = &mut trails;
        let ends = [
            path.play(&task, case, Fidelity::Full, |arm| full.push(arm.q)),
            path.play(&task, case, Fidelity::QuasiStatic, |arm| still.push(arm.q)),
        ];
        seen.insert(ends[1].outcome.name());
        if ends[0].outcome == ends[1].outcome {
            same += 1;
            let steps = full.len().min(still.len()).saturating_sub(1);
            for (a, b) in full[..steps].iter().zip(still) {
                assert!((a[0] - b[0]).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-3);
            }
        }
    }
    assert!(same >= 297, "{same} of {} ended alike", all.len());
    assert!(seen.contains("success") && seen.contains("collision") && seen.contains("joint_limit"));
}

/// Whichever of touch and joint limit comes first ends a movement: its time is that of the last
/// posture played, a violation leaves no posture outside, a touch leaves the arm at the obstacle.
#[test]
fn movements_end_where_they_fail() {
    let task = task(control(Control::Pattern));
    for (case, b) in movements(&task, 200) {
        let path = MovementPath::new(&task, &case, b).unwrap();
        assert!(path.postures().iter().all(|&q| task.arm.in_range(q)));
        for fidelity in [Fidelity::Full, Fidelity::QuasiStatic] {
            let mut played = 0;
            let movement = path.play(&task, &case, fidelity, |_| played += 1);
            let period = task.config.reach.control_period_s;
            assert!((movement.time_s - f64::from(played) * period).abs() < 1e-9);
            let whole = path.postures().len() == task.config.reach.movement_steps();
            let legal = path.is_legal(&task, &case, fidelity);
            let clearance = case.obstacle.unwrap().clearance(&task.arm, movement.arm.q);
            match movement.outcome {
                Outcome::Collision => {
                    assert!(fidelity == Fidelity::QuasiStatic || clearance.abs() < 2e-6);
                    assert!(!legal);
                }
                Outcome::JointLimit => assert!(!whole && !legal),
                _ => {
                    assert!(whole && legal && clearance > 0.0);
                    // T = 8 s and four time constants of 0.8 s to settle.
                    let lasts = match fidelity {
                        Fidelity::Full => 8.0 + 4.0 * 0.8,
                        Fidelity::QuasiStatic => 8.0,
                    };
                    assert!((movement.time_s - lasts).abs() < 1e-9);
                }
            }
        }
    }
}

/// Looking at a few postures first tells the same of a movement as looking at all of them, in both
/// bodies, also where the few cannot be every 16th. Catches a touch or a joint limit that only the few
/// would show, as by points that are not on the path.
#[test]
fn few_postures_tell_what_all_do() {
    let mut legal = 0;
    for (profile, movement_s) in [
        ("paper", 8.0),
        ("icub", 8.0),
        ("paper", 4.6),
        ("paper", 1.55),
    ] {
        let mut config = Config::profile(profile).unwrap();
        config.reach.movement_s = movement_s;
        let task = ReachTask::new(config, control(Control::Pattern)).unwrap();
        for (case, b) in movements(&task, 400) {
            let path = MovementPath::new(&task, &case, b).unwrap();
            for fidelity in [Fidelity::Full, Fidelity::QuasiStatic] {
                let quick = MovementPath::is_legal_with(&task, &case, b, fidelity).unwrap();
                assert_eq!(quick, path.is_legal(&task, &case, fidelity));
                legal += u32::from(quick);
            }
        }
    }
    assert!((300..1500).contains(&legal), "{legal} of 3200 are legal");
}
