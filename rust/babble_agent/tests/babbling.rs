//! Babbling and learning: what they depend on, and that they learn.

use std::time::Instant;

use babble_agent::reach::Experience;
use babble_agent::rule::Rule;
use babble_agent::{
    AgentError, Babbling, Learner, Network, ReachBabbling, ReachBrain, ReachNetwork, Variant,
    babble,
};
use babble_brain::CovarianceRule;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::protocol;
use babble_env::{
    Config, Control, EnvError, Executor, Outcome, Purpose, ReachCase, ReachOptions, ReachTask,
};

fn task() -> ReachTask {
    let options = ReachOptions {
        control: Control::Pattern,
        ..ReachOptions::default()
    };
    ReachTask::new(Config::profile("paper").unwrap(), options).unwrap()
}

fn pool(threads: usize) -> Executor {
    Executor::new(threads).unwrap()
}

const FULL: ReachBabbling = ReachBabbling {
    quasi_static: false,
};
const QUASI_STATIC: ReachBabbling = ReachBabbling { quasi_static: true };

fn experience(
    options: ReachBabbling,
    portions: &[usize],
    threads: usize,
) -> (Vec<Experience>, u64) {
    let (task, mut pool) = (task(), pool(threads));
    let mut babbling = Babbling::new(4, options);
    let mut all = Vec::new();
    for &n in portions {
        let found = babbling.experience(&task, n, &mut pool).unwrap();
        assert_eq!(found.len(), n);
        all.extend(found);
        assert_eq!(babbling.learnt(), all.len() as u64);
    }
    (all, babbling.babbled())
}

/// The k-th legal movement depends on the seed alone: any number of threads, any portions give the
/// same experiences from the same number of movements. Catches movements of a chunk thrown away at
/// the end of a portion, and a stream shared between threads.
#[test]
fn babbling_is_one_sequence() {
    for options in [FULL, QUASI_STATIC] {
        let whole = experience(options, &[150], 1);
        for (portions, threads) in [(&[150][..], 2), (&[150][..], 8), (&[1, 99, 7, 43][..], 2)] {
            assert_eq!(experience(options, portions, threads), whole);
        }
    }
}

/// A sequence taken up again where it stopped goes on as if it had not. Catches the last movement
/// babbled twice.
#[test]
fn babbling_resumes() {
    let (task, mut pool) = (task(), pool(2));
    let mut whole = Babbling::new(4, QUASI_STATIC);
    let first = whole.experience(&task, 30, &mut pool).unwrap();
    let mut resumed = Babbling::resume(4, QUASI_STATIC, whole.babbled(), whole.learnt());
    let rest = whole.experience(&task, 30, &mut pool).unwrap();
    assert_eq!(resumed.experience(&task, 30, &mut pool).unwrap(), rest);
    assert_eq!(
        (resumed.babbled(), resumed.learnt()),
        (whole.babbled(), whole.learnt())
    );
    assert_ne!(first, rest);
    let mut other = Babbling::new(5, QUASI_STATIC);
    assert_ne!(other.experience(&task, 30, &mut pool).unwrap(), first);
}

fn babble_all(options: ReachBabbling, n: usize, threads: usize) -> Vec<Experience> {
    let babbling = Babbling::new(4, options);
    let made = babble(&babbling, &task(), n, &mut pool(threads)).unwrap();
    assert_eq!(made.len(), n);
    made.concat()
}

/// Babbles of a seed, legal or not, are those that learning takes its experiences from, in their order,
/// on any number of threads. Catches a percept that depends on whether a movement was legal.
#[test]
fn babbles_hold_the_experiences() {
    for options in [FULL, QUASI_STATIC] {
        let (legal, babbled) = experience(options, &[20], 2);
        let all = babble_all(options, babbled as usize, 2);
        assert_eq!(all.len(), babbled as usize);
        let found: Vec<_> = all.iter().copied().filter(Experience::is_legal).collect();
        assert_eq!(found, legal);
        let one = babble_all(options, 9, 1);
        assert_eq!(one, all[..9]);
        assert!(all.iter().any(|one| one.outcome == Outcome::JointLimit));
    }
}

/// A learner that learns movement by movement has the bits of one that learns them at once, whichever
/// its rule. Catches an association that a rule leaves out.
#[test]
fn a_learner_may_be_watched_as_often_as_one_likes() {
    for rule in Rule::NAMES {
        let brain = ReachBrain {
            rule: rule.parse().unwrap(),
            ..ReachBrain::variant(Variant::Paper)
        };
        let new = || Learner::<ReachNetwork>::new(brain.clone(), &task(), 4, QUASI_STATIC).unwrap();
        let (mut whole, mut watched) = (new(), new());
        whole.learn(&task(), 12, &mut pool(2)).unwrap();
        for _ in 0..12 {
            watched.learn(&task(), 1, &mut pool(1)).unwrap();
        }
        assert_eq!(watched.network.associations(), whole.network.associations());
        assert_eq!(watched.babbling.babbled(), whole.babbling.babbled());
        assert!(
            whole.network.associations()[0]
                .weights()
                .iter()
                .any(|&w| w != 0.0)
        );
    }
}

/// A rule of one's own learns what the built-in one does; one that fails leaves the learner as it was.
/// Catches babbles that count although nothing was learnt from them.
#[test]
fn a_rule_of_ones_own_learns_all_or_nothing() {
    let own = ReachBrain {
        rule: Rule::own(),
        ..ReachBrain::variant(Variant::Paper)
    };
    let mut theirs = Learner::<ReachNetwork>::new(own, &task(), 4, QUASI_STATIC).unwrap();
    let paper = ReachBrain::variant(Variant::Paper);
    let mut ours = Learner::<ReachNetwork>::new(paper, &task(), 4, QUASI_STATIC).unwrap();
    let (task, mut pool) = (task(), pool(2));
    assert!(matches!(
        theirs.learn(&task, 1, &mut pool),
        Err(AgentError::Config { field: "rule", .. })
    ));
    let covariance = CovarianceRule::default();
    theirs
        .learn_by(
            &mut |w, g, a| Ok(w.learn(&covariance, g, a)?),
            &task,
            9,
            &mut pool,
        )
        .unwrap();
    ours.learn(&task, 9, &mut pool).unwrap();
    assert_eq!(theirs.network.associations(), ours.network.associations());
    let failed = theirs.learn_by(
        &mut |w, g, a| {
            w.learn(&covariance, g, a)?;
            Err(AgentError::Rule {
                problem: "no".to_owned(),
            })
        },
        &task,
        9,
        &mut pool,
    );
    assert!(failed.is_err());
    assert_eq!(theirs.network.associations(), ours.network.associations());
    assert_eq!(theirs.babbling.babbled(), ours.babbling.babbled());
}

/// Interrupted babbling ends within moments, has experienced nothing, and goes on as if it had not
/// begun; so does the drawing of cases. Catches movements that are counted and forgotten.
#[test]
fn interrupted_babbling_is_where_it_was() {
    let task = task();
    let (whole, _) = experience(FULL, &[60], 2);
    for threads in [1, 2] {
        let mut babbling = Babbling::new(4, FULL);
        assert_eq!(
            babbling.experience(&task, 30, &mut pool(threads)).unwrap(),
            whole[..30]
        );
        let before = (babbling.babbled(), babbling.learnt());
        let mut impatient = pool(threads).interrupted_by(|| true);
        let began = Instant::now();
        let result = babbling.experience(&task, 1_000_000, &mut impatient);
        assert_eq!(result, Err(AgentError::Env(EnvError::Interrupted)));
        let cases = protocol::table1(&task, 1_000_000, 0, Purpose::Validation, &mut impatient);
        assert_eq!(cases, Err(EnvError::Interrupted));
        let seconds = began.elapsed().as_secs_f64();
        println!("{threads} threads: interrupted twice in {seconds:.3} s");
        assert!(seconds < 2.0, "{seconds} s");
        assert_eq!((babbling.babbled(), babbling.learnt()), before);
        let rest = babbling.experience(&task, 30, &mut pool(threads)).unwrap();
        assert_eq!(rest, whole[30..]);
    }
}

/// About one movement in five is legal, as the paper says, with the percepts in their ranges and
/// b2 = 1 − b1. Catches illegal movements that are experienced, and counts of something else.
#[test]
fn one_movement_in_five_is_legal() {
    let (experiences, movements) = experience(FULL, &[400], 2);
    let rate = 400.0 / movements as f64;
    assert!((0.12..0.26).contains(&rate), "{rate}");
    for one in experiences {
        assert!(one.is_legal());
        let Experience {
            eye, obstacle, b, ..
        } = one;
        assert!(eye.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!(obstacle.iter().all(|x| x.abs() < 1.6));
        assert!((b[0] + b[1] - 1.0).abs() < 1e-6 && (0.01..=0.99).contains(&b[0]));
    }
}

/// A body that hardly leaves a legal movement is an error that counts what was tried, or of the
/// task; never an endless search.
#[test]
fn nothing_legal_is_an_error() {
    let config = Config::from_json(
        r#"{"body": {"joints": {"shoulder": {"lower_deg": 0, "upper_deg": 2},
            "elbow": {"lower_deg": 10, "upper_deg": 12}}}}"#,
    );
    let task = ReachTask::new(config.unwrap(), ReachOptions::default()).unwrap();
    let result = Babbling::new(0, FULL).experience(&task, 1, &mut pool(2));
    assert!(matches!(
        result,
        Err(AgentError::Env(_) | AgentError::NothingToLearn { .. })
    ));
}

fn learnt(variant: Variant, portions: &[usize], threads: usize) -> ReachNetwork {
    let (task, mut pool) = (task(), pool(threads));
    let mut babbling = Babbling::new(4, QUASI_STATIC);
    let mut hebb = ReachNetwork::new(ReachBrain::variant(variant)).unwrap();
    for &n in portions {
        let experiences = babbling.experience(&task, n, &mut pool).unwrap();
        pool.run(|| hebb.learn(&experiences)).unwrap().unwrap();
    }
    hebb
}

/// Learning in two calls is learning in one, on any number of threads, to the bit. Catches running
/// averages that start anew with each call.
#[test]
fn learning_goes_on() {
    for variant in [Variant::Paper, Variant::Conjunctive] {
        let whole = learnt(variant, &[120], 1);
        for (portions, threads) in [(&[120][..], 8), (&[50, 70][..], 2)] {
            let other = learnt(variant, portions, threads);
            assert_eq!(other.associations(), whole.associations());
        }
    }
}

/// Share of the cases that the agent's movements solve in the full simulation.
fn success(task: &ReachTask, hebb: &ReachNetwork, cases: &[ReachCase]) -> f64 {
    let solved = cases.iter().filter(|case| {
        let gaze = task.foveate(case).unwrap();
        let camera = task.eye.camera(gaze);
        let single = |x: [f64; 2]| x.map(|x| x as f32);
        let obstacle = ReachTask::obstacle_angles(&camera, case.obstacle.as_ref());
        let b = hebb
            .decide(single(task.eye.normalised(gaze)), single(obstacle))
            .unwrap();
        let path = MovementPath::new(task, case, b).unwrap();
        path.play(task, case, Fidelity::Full, |_| {}).outcome == Outcome::Success
    });
    solved.count() as f64 / cases.len() as f64
}

/// It learns: 250 legal movements are enough for the conjunctive map to solve more than 80 % of
/// cases it has not seen, where the silent map it started from solves none.
#[test]
fn conjunctive_map_learns_from_250_movements() {
    let task = task();
    let cases = protocol::table1(&task, 200, 0, Purpose::Validation, &mut pool(2)).unwrap();
    let newborn = ReachNetwork::new(ReachBrain::variant(Variant::Conjunctive)).unwrap();
    assert_eq!(success(&task, &newborn, &cases), 0.0);
    let mut babbling = Babbling::new(0, FULL);
    let experiences = babbling.experience(&task, 250, &mut pool(2)).unwrap();
    let mut hebb = newborn;
    hebb.learn(&experiences).unwrap();
    let share = success(&task, &hebb, &cases);
    println!("success after 250 legal movements: {share:.3}");
    assert!(share > 0.8, "{share}");
}

/// Numbers of the maps out of bounds are named; percepts that are no numbers never become a NaN.
#[test]
fn bad_configs_and_percepts_are_named() {
    let base = ReachBrain::variant(Variant::Conjunctive);
    let cases = [
        (
            ReachBrain {
                output_neurons: 1,
                ..base.clone()
            },
            "output_neurons",
        ),
        (
            ReachBrain {
                obstacle_neurons: 102,
                ..base.clone()
            },
            "obstacle_neurons",
        ),
        (
            ReachBrain {
                target_neurons: 0,
                ..base.clone()
            },
            "target_neurons",
        ),
        (
            ReachBrain {
                obstacle_field_deg: f64::NAN,
                ..base.clone()
            },
            "obstacle_field_deg",
        ),
        (
            ReachBrain {
                sigma: 0.0,
                ..base.clone()
            },
            "sigma",
        ),
    ];
    for (config, field) in cases {
        let error = ReachNetwork::new(config).unwrap_err().to_string();
        assert!(error.contains(field), "{error}");
    }
    assert!(
        "hebb"
            .parse::<Variant>()
            .unwrap_err()
            .to_string()
            .contains("conjunctive")
    );
    let hebb = ReachNetwork::new(base).unwrap();
    let decision = hebb.decide([f32::NAN; 2], [0.0; 2]);
    assert!(decision.is_err() || decision.unwrap().iter().all(|b| b.is_finite()));
}
