//! The agents that need no learning.

use babble_agent::reach::reference::{case_from_senses, oracle, plan, scripted};
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::protocol;
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Autoreset, Batch, Config, Control, Executor, Outcome, Purpose, ReachCase, ReachOptions,
    ReachTask,
};

fn task(profile: &str) -> ReachTask {
    let options = ReachOptions {
        control: Control::Pattern,
        ..ReachOptions::default()
    };
    ReachTask::new(Config::profile(profile).unwrap(), options).unwrap()
}

fn outcome(task: &ReachTask, case: &ReachCase, b: [f64; 2]) -> Outcome {
    let path = MovementPath::new(task, case, b).unwrap();
    path.play(task, case, Fidelity::Full, |_| {}).outcome
}

/// The oracle solves every case that the script solves, and nearly all there are. Catches a run of
/// values read out at its end, where movements graze the obstacle.
#[test]
fn oracle_is_at_least_the_script() {
    for (profile, least) in [("paper", 57), ("icub", 57)] {
        let task = task(profile);
        let mut pool = Executor::new(2).unwrap();
        let cases = protocol::table1(&task, 60, 0, Purpose::Validation, &mut pool).unwrap();
        let (mut best, mut fixed) = (0, 0);
        for case in &cases {
            best +=
                u32::from(outcome(&task, case, oracle(&task, case).unwrap()) == Outcome::Success);
            fixed += u32::from(outcome(&task, case, scripted(case)) == Outcome::Success);
        }
        println!("{profile}: oracle {best}, script {fixed} of 60");
        assert!(
            best >= fixed && best >= least && fixed >= 45,
            "{profile}: {best} {fixed}"
        );
    }
}

/// The oracle's b1 is the middle of the values that succeed: as many succeed below it as above.
/// Catches a value from the run's edge, which grazes the obstacle.
#[test]
fn oracle_keeps_away_from_the_edges() {
    let task = task("paper");
    let mut pool = Executor::new(2).unwrap();
    let cases = protocol::table1(&task, 8, 1, Purpose::Validation, &mut pool).unwrap();
    for case in cases {
        let hundredths = 100.0 * oracle(&task, &case).unwrap()[0];
        let succeeds = |k: f64| {
            let inside = (1.0..=99.0).contains(&k);
            inside && outcome(&task, &case, [k / 100.0, 1.0 - k / 100.0]) == Outcome::Success
        };
        let run = |from: f64, step: f64| {
            let values = (0..100).map(|i| from + step * f64::from(i));
            values.take_while(|&k| succeeds(k)).count()
        };
        let below = run((hundredths + 1e-6).floor(), -1.0);
        let above = run((hundredths - 1e-6).ceil(), 1.0);
        assert!(
            below > 0 && below == above,
            "{hundredths}: {below} below, {above} above"
        );
    }
}

/// The script bulges towards the shoulder, in any direction of the movement.
/// Catches a mirrored side, which fails for one half of the directions alone.
#[test]
fn script_bulges_towards_the_shoulder() {
    for k in 0..16 {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
        let middle = [0.1, 0.2];
        let case = ReachCase {
            start: [0.0; 2],
            hand: [middle[0] - 0.08 * cos, middle[1] - 0.08 * sin],
            target: [middle[0] + 0.08 * cos, middle[1] + 0.08 * sin],
            obstacle: None,
        };
        let way = MovementPath::desired(&task("paper"), &case, scripted(&case)).unwrap();
        let bulge = [way[79].x - middle[0], way[79].y - middle[1]];
        // What of the way to the shoulder is across the movement.
        let left = -middle[1] * cos + middle[0] * sin;
        let across = bulge[1] * cos - bulge[0] * sin;
        assert!(across * left > 0.0, "direction {k}: {bulge:?}");
        assert!(across.abs() > 0.05);
    }
}

/// What the senses tell is the case: start, target and obstacle within a millimetre, or that there
/// is no obstacle. Catches a camera frame mixed up between the two bodies.
#[test]
fn senses_tell_the_case() {
    for profile in ["paper", "icub"] {
        for obstacle in [ObstacleRequest::Halfway, ObstacleRequest::Absent] {
            let mut env = Batch::new(task(profile).into(), 40, Autoreset::Disabled, 1).unwrap();
            for i in 0..40 {
                env.request(
                    i,
                    CaseRequest {
                        obstacle,
                        ..CaseRequest::default()
                    },
                )
                .unwrap();
            }
            env.reset(&[true; 40]).unwrap();
            for (i, record) in env.records().enumerate() {
                let told =
                    case_from_senses(env.task(), record.senses.first_chunk().unwrap()).unwrap();
                let case = env.state(i).unwrap().case;
                let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-3;
                assert!(near(told.hand, case.hand) && near(told.target, case.target));
                match (told.obstacle, case.obstacle) {
                    (Some(a), Some(b)) => {
                        assert!(near(a.centre.into(), b.centre.into()) && a.radius == b.radius);
                    }
                    (told, case) => assert_eq!(told, case),
                }
            }
        }
    }
}

/// A plan has one posture for each control step, inside the ranges; where the path leaves them the
/// last posture inside is held. Catches a plan that is cut short.
#[test]
fn plans_last_the_whole_movement() {
    let task = task("paper");
    let mut held = 0;
    for i in 0..100 {
        let mut stream = babble_env::Stream::new(Purpose::Test, 5, i);
        let case = ReachCase::draw_geometry(&task, &mut stream).unwrap();
        let b1 = stream.uniform(0.01, 0.99);
        let b = [b1, 1.0 - b1];
        let (plan, path) = (
            plan(&task, &case, b).unwrap(),
            MovementPath::new(&task, &case, b).unwrap(),
        );
        assert_eq!(plan.len(), task.config.reach.movement_steps());
        assert!(
            plan.iter()
                .flatten()
                .all(|share| (0.0..=1.0).contains(share))
        );
        let inside = path.postures().len();
        held += usize::from(inside < plan.len());
        assert!(
            plan[inside..]
                .iter()
                .all(|share| *share == plan[inside.saturating_sub(1)])
        );
    }
    assert!(held > 5);
}
