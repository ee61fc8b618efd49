//! Cases: what is drawn can be played, and which cases are drawn depends on nothing else.

mod playing;

use babble_env::tasks::reach::case::obstacle_at;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::protocol;
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Config, Control, Executor, Purpose, ReachCase, ReachOptions, ReachTask, Stop, Stream,
};
use nalgebra::Vector2;
use playing::{control, task};

fn tasks() -> [ReachTask; 2] {
    ["paper", "icub"].map(|name| {
        ReachTask::new(Config::profile(name).unwrap(), ReachOptions::default()).unwrap()
    })
}

/// Whether some movement of the grid b1 = .01, .02, … solves the case.
fn is_solvable(task: &ReachTask, case: &ReachCase, fidelity: Fidelity) -> bool {
    (1..100).map(|k| f64::from(k) / 100.0).any(|b1| {
        let path = MovementPath::new(task, case, [b1, 1.0 - b1]).unwrap();
        path.is_legal(task, case, fidelity)
    })
}

fn assert_playable(task: &ReachTask, case: &ReachCase) {
    let obstacle = case.obstacle.expect("halfway");
    let middle = (Vector2::from(case.hand) + Vector2::from(case.target)) / 2.0;
    assert!((obstacle.centre - middle).norm() < 1e-12);
    assert!((task.arm.fingertip(case.start) - Vector2::from(case.hand)).norm() < 1e-9);
    let end = task.arm.posture_at(case.target.into()).unwrap();
    for q in [case.start, end] {
        assert!(task.arm.in_range(q) && obstacle.clearance(&task.arm, q) > 0.0);
    }
}

/// Random geometries keep to item 16: ends in reach and clear, obstacle halfway, the distance in
/// its range and spread over it. Catches an obstacle at the target, and starts rejected one-sidedly.
#[test]
fn geometries_keep_to_the_config() {
    for task in tasks() {
        let mut stream = Stream::new(Purpose::Test, 1, 0);
        let [near, far] = task.config.reach.distance_m;
        let mut distances = Vec::new();
        for _ in 0..500 {
            let case = ReachCase::draw_geometry(&task, &mut stream).unwrap();
            assert_playable(&task, &case);
            distances.push(case.distance());
        }
        distances.sort_by(f64::total_cmp);
        assert!(near <= distances[0] && distances[499] <= far);
        let tenth = (far - near) / 10.0;
        assert!(distances[499] > far - tenth && distances[25] < near + 5.0 * tenth);
    }
}

/// A case drawn as legal has a movement that neither touches nor violates. Catches a draw that
/// keeps the geometry of one try and the movement of another.
#[test]
fn legal_cases_can_be_solved() {
    for task in tasks() {
        for fidelity in [Fidelity::Full, Fidelity::QuasiStatic] {
            for i in 0..30 {
                let mut stream = Stream::new(Purpose::Test, 2, i);
                let case =
                    ReachCase::draw_legal(&task, &mut stream, fidelity, &Stop::default()).unwrap();
                assert_playable(&task, &case);
                assert!(is_solvable(&task, &case, fidelity), "{case:?}");
            }
        }
    }
}

/// Table I's cases: legal in the full simulation, the same for any number of threads, a longer
/// list begins with the shorter, and no list shares a case with another seed or purpose.
#[test]
fn table1_depends_on_purpose_seed_and_index_alone() {
    let task = task(control(Control::Pattern));
    let draw = |n, seed, purpose, threads| {
        protocol::table1(
            &task,
            n,
            seed,
            purpose,
            &mut Executor::new(threads).unwrap(),
        )
        .unwrap()
    };
    let cases = draw(40, 0, Purpose::Test, 1);
    assert!(
        cases
            .iter()
            .all(|case| is_solvable(&task, case, Fidelity::Full))
    );
    for threads in [2, 8] {
        assert_eq!(draw(40, 0, Purpose::Test, threads), cases);
    }
    assert_eq!(draw(15, 0, Purpose::Test, 2), cases[..15]);
    let others = [
        draw(40, 1, Purpose::Test, 2),
        draw(40, 0, Purpose::Validation, 2),
        draw(40, 0, Purpose::Learning, 2),
        draw(40, 0, Purpose::Environment, 2),
    ];
    for other in others {
        assert!(other.iter().all(|case| !cases.contains(case)));
    }
}

/// In `pattern` control a sampled case can be solved with the muscles' lag, also around a given end;
/// with nothing given it is the case of a legal movement, as Table I's are. The other controls sample
/// without the lag. Catches a draw that leaves some cases to nobody.
#[test]
fn sampled_cases_can_be_solved_in_their_control() {
    for &of in Control::ALL {
        let fidelity = match of {
            Control::Pattern => Fidelity::Full,
            _ => Fidelity::QuasiStatic,
        };
        let task = task(control(of));
        for i in 0..25 {
            let stream = || Stream::new(Purpose::Test, 5, i);
            let case = CaseRequest::default()
                .draw(&task, &mut stream(), &Stop::default())
                .unwrap();
            let legal =
                ReachCase::draw_legal(&task, &mut stream(), fidelity, &Stop::default()).unwrap();
            assert_eq!(case, legal);
            assert!(is_solvable(&task, &case, fidelity), "{of}");
            let [start, target] = [case.hand, case.target];
            let from = CaseRequest {
                start: Some(start),
                ..CaseRequest::default()
            };
            let to = CaseRequest {
                target: Some(target),
                ..CaseRequest::default()
            };
            for request in [from, to] {
                let case = request
                    .draw(&task, &mut stream(), &Stop::default())
                    .unwrap();
                assert!(is_solvable(&task, &case, fidelity), "{of} {request:?}");
            }
        }
    }
}

/// Streams differ in purpose, seed and index, and repeat themselves. Catches a seed that is added
/// to the index, so that environment 1 of seed 0 is environment 0 of seed 1.
#[test]
fn streams_do_not_coincide() {
    let first = |purpose, seed, index| {
        let mut stream = Stream::new(purpose, seed, index);
        [(); 2].map(|()| stream.uniform(0.0, 1.0).to_bits())
    };
    let purposes = [
        Purpose::Environment,
        Purpose::Learning,
        Purpose::Validation,
        Purpose::Test,
        Purpose::Policy,
    ];
    let mut seen = std::collections::BTreeSet::new();
    for purpose in purposes {
        for seed in (0..20).chain([u64::MAX]) {
            for index in 0..20 {
                assert_eq!(first(purpose, seed, index), first(purpose, seed, index));
                seen.insert(first(purpose, seed, index));
            }
        }
    }
    assert_eq!(seen.len(), 5 * 21 * 20);
    let mut stream = Stream::new(Purpose::Test, 0, 0);
    let mean = (0..10_000).map(|_| stream.uniform(-1.0, 3.0)).sum::<f64>() / 1e4;
    assert!((mean - 1.0).abs() < 0.05, "{mean}");
}

/// Fig. 4: 4 targets, 36 different starts on a circle around each. All can be played, also with
/// obstacle and start exchanged, and they are spread over all that can: between neighbours lie as
/// many playable directions everywhere, up to one. Catches a rule that leaves starts out.
#[test]
fn fig4_has_144_cases() {
    for task in tasks() {
        let cases = protocol::fig4(&task);
        assert_eq!(cases.len(), 144);
        let [near, far] = task.config.reach.distance_m;
        for cases in cases.chunks_exact(36) {
            let cases: Vec<_> = cases.iter().map(|case| case.unwrap()).collect();
            let mut directions = Vec::new();
            for case in &cases {
                assert_playable(&task, case);
                assert_eq!(case.target, cases[0].target);
                assert!((case.distance() - 0.5 * (near + far)).abs() < 1e-12);
                let switched = case.switched(&task).unwrap();
                assert_eq!(switched.hand, middle(case));
                assert_eq!(switched.obstacle, Some(obstacle_at(&task, case.hand)));
                let away = Vector2::from(case.hand) - Vector2::from(case.target);
                directions.push(away.y.atan2(away.x).rem_euclid(std::f64::consts::TAU));
            }
            assert!(directions.windows(2).all(|pair| pair[0] < pair[1]));
            let steps: Vec<_> = directions
                .windows(2)
                .map(|pair| ((pair[1] - pair[0]) * 720.0 / std::f64::consts::TAU).round())
                .collect();
            let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
            let wide = steps.iter().filter(|&&step| step > least + 1.0).count();
            assert!(wide <= 4, "{steps:?}"); // Gaps between arcs of playable directions.
        }
    }
}

/// What is asked of a case is what is played, and only the rest is drawn. Catches a request that is
/// taken for a hint.
#[test]
fn requests_are_kept() {
    let task = task(control(Control::DeltaPosture));
    let mut stream = Stream::new(Purpose::Test, 3, 0);
    let legal =
        ReachCase::draw_legal(&task, &mut stream, Fidelity::QuasiStatic, &Stop::default()).unwrap();
    let (start, target) = (Some(legal.hand), Some(legal.target));
    let elsewhere = obstacle_at(&task, [-0.3, -0.3]);
    let wanted = |request: &ObstacleRequest, case: &ReachCase| match request {
        ObstacleRequest::Halfway => case.obstacle == Some(obstacle_at(&task, middle(case))),
        ObstacleRequest::Absent => case.obstacle.is_none(),
        ObstacleRequest::At(obstacle) => case.obstacle == Some(*obstacle),
    };
    let obstacles = [
        ObstacleRequest::Halfway,
        ObstacleRequest::Absent,
        ObstacleRequest::At(elsewhere),
    ];
    for obstacle in obstacles {
        for (start, target) in [(None, None), (start, None), (None, target), (start, target)] {
            let request = CaseRequest {
                start,
                target,
                obstacle,
            };
            let case = request.draw(&task, &mut stream, &Stop::default()).unwrap();
            assert!(start.is_none_or(|p| p == case.hand), "{request:?}");
            assert!(target.is_none_or(|p| p == case.target), "{request:?}");
            assert!(wanted(&obstacle, &case), "{request:?}");
        }
    }
}

fn middle(case: &ReachCase) -> [f64; 2] {
    ((Vector2::from(case.hand) + Vector2::from(case.target)) / 2.0).into()
}
