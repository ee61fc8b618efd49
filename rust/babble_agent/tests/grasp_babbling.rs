//! Babbling with the object in the hand and what is learnt from it.

use std::time::Instant;

use babble_agent::grasp::Experience;
use babble_agent::grasp::GraspBabbling::InHand;
use babble_agent::grasp::holding::trials;
use babble_agent::{AgentError, Babbling, GraspBrain, GraspNetwork, Network, babble};
use babble_brain::{MapConfig, PopulationMap};
use babble_env::tasks::grasp::{FOVEA_NEURONS, GraspCase, at};
use babble_env::{Autoreset, Batch, Config, EnvError, Executor, GraspOptions, GraspTask, Outcome};

const DIAMETERS: [f64; 2] = [0.024, 0.06];

fn task_with(json: &str) -> GraspTask {
    GraspTask::new(Config::from_json(json).unwrap(), GraspOptions::default()).unwrap()
}

fn task() -> GraspTask {
    task_with("{}")
}

fn pool(threads: usize) -> Executor {
    Executor::new(threads).unwrap()
}

fn experience(seed: u64, portions: &[usize], threads: usize) -> (Vec<Experience>, u64) {
    let (task, mut pool) = (task(), pool(threads));
    let mut babbling = Babbling::new(seed, InHand);
    let mut all = Vec::new();
    for &n in portions {
        let found = babbling.experience(&task, n, &mut pool).unwrap();
        assert_eq!(found.len(), n);
        all.extend(found);
        assert_eq!(babbling.learnt(), all.len() as u64);
    }
    (all, babbling.babbled())
}

/// The k-th object that is kept depends on the seed alone: any number of threads, any portions give
/// the same experiences from the same number of babbles. Catches babbles of a chunk thrown away at
/// the end of a portion, a stream shared between threads, and a hand that is not opened again.
#[test]
fn babbling_is_one_sequence() {
    let whole = experience(4, &[24], 1);
    for (portions, threads) in [(&[24][..], 2), (&[24][..], 8), (&[1, 17, 6][..], 2)] {
        assert_eq!(experience(4, portions, threads), whole);
    }
    assert!(experience(5, &[6], 2).0 != whole.0[..6]);
}

/// A sequence taken up again where it stopped goes on as if it had not. Catches the last babble made
/// twice.
#[test]
fn babbling_resumes() {
    let (task, mut pool) = (task(), pool(2));
    let mut whole = Babbling::new(4, InHand);
    let first = whole.experience(&task, 8, &mut pool).unwrap();
    let mut resumed = Babbling::resume(4, InHand, whole.babbled(), whole.learnt());
    let rest = whole.experience(&task, 8, &mut pool).unwrap();
    assert_eq!(resumed.experience(&task, 8, &mut pool).unwrap(), rest);
    assert_eq!(
        (resumed.babbled(), resumed.learnt(), resumed.seed()),
        (whole.babbled(), whole.learnt(), 4)
    );
    assert_ne!(first, rest);
}

/// Babbles of a seed, kept or not, are those that learning takes its experiences from, in their order.
/// A hand that stays open loses them all, and says so.
#[test]
fn babbles_hold_the_experiences() {
    let (kept, babbled) = experience(4, &[6], 2);
    let all = babble(
        &Babbling::new(4, InHand),
        &task(),
        babbled as usize,
        &mut pool(2),
    )
    .unwrap();
    let all = all.concat();
    let found: Vec<_> = all.iter().filter(|one| one.is_kept()).cloned().collect();
    assert_eq!(found, kept);
    let open = task_with(r#"{"body": {"grip": {"reflex_deg": [0, 0]}}}"#);
    let lost = babble(&Babbling::new(4, InHand), &open, 3, &mut pool(2)).unwrap();
    let lost = lost.concat();
    assert_eq!(lost.len(), 3);
    assert!(
        lost.iter()
            .all(|one| one.outcome == Outcome::Lost && !one.is_kept())
    );
}

/// With a period, a babble leaves an experience after each period of its movement: the arm is elsewhere at
/// each, the object the same, and the last is that of the same babble without one. Any number of threads
/// and any portions give the same. Catches a period that changes the movement, and experiences of a babble
/// that come in another order.
#[test]
fn a_babble_can_be_learnt_from_along_its_movement() {
    let along = |portions: &[usize], threads: usize| {
        let (task, mut pool) = (task(), pool(threads));
        let mut babbling = Babbling::new(4, InHand).every(Some(0.5)).unwrap();
        let each = portions.iter();
        let each = each.map(|&n| babbling.experience(&task, n, &mut pool).unwrap());
        let all: Vec<Experience> = each.flatten().collect();
        (all, babbling.babbled())
    };
    let (all, babbled) = along(&[9], 1);
    assert_eq!(along(&[9], 2), (all.clone(), babbled));
    assert_eq!(along(&[9], 8), (all.clone(), babbled));
    assert_eq!(along(&[1, 5, 3], 2), (all.clone(), babbled));
    let (ends, once) = experience(4, &[9], 2);
    assert_eq!(once, babbled);
    // Three postures of two seconds.
    assert_eq!(all.len(), 9 * 12);
    for (along, end) in all.chunks(12).zip(&ends) {
        assert_eq!(&along[11], end);
        for two in along.windows(2) {
            assert!(two[0].arm != two[1].arm && two[0].eye != two[1].eye);
            assert_eq!(two[0].diameter, two[1].diameter);
        }
    }
    let too_long = Babbling::<GraspTask>::new(4, InHand).every(Some(2.5));
    for refused in [too_long, Babbling::new(4, InHand).every(Some(f64::NAN))] {
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("learning_period_s"), "{error}");
    }
}

/// An open hand closes around the object that is put before its palm, which is of either size; the
/// object is in the hand and in sight at the end: the eye's direction is that of the palm's pocket,
/// the fovea shows edges, the fingers are bent less than the reflex asks, as the object is between
/// them. Catches objects that were lost and are experienced, flexions in place of opening angles,
/// and an eye that looks elsewhere.
#[test]
fn kept_objects_are_in_the_hand() {
    let task = task();
    let (experiences, babbles) = experience(1, &[40], 2);
    assert!(babbles <= 60, "{babbles} babbles for 40 objects");
    for diameter in DIAMETERS {
        let of_size = experiences.iter().filter(|one| one.diameter == diameter);
        assert!(of_size.count() >= 10);
    }
    for Experience {
        eye,
        fovea,
        arm,
        hand,
        pregrasp,
        diameter,
        outcome,
    } in &experiences
    {
        assert_eq!(*pregrasp, None);
        assert_eq!(*outcome, Outcome::Success);
        let shares = eye.iter().chain(arm).chain(&**fovea);
        assert!(shares.clone().all(|x| (0.0..=1.0).contains(x)));
        assert!(fovea.iter().any(|&edge| edge > 0.05));
        let radius = diameter / 2.0;
        let arm = task.arm.denormalised(arm.map(f64::from));
        let pocket = task.before_palm(arm, radius, 0.0);
        let gaze = task.eye.from_normalised(eye.map(f64::from));
        let [x, y] = task.eye.target_in_plane(gaze, 0.0).unwrap();
        let off = (x - pocket[0]).hypot(y - pocket[1]);
        assert!(off < radius + 0.02, "the eye looks {off} m beside the palm");
        let flexion = hand.map(|ep| (90.0 - f64::from(ep)).to_radians());
        let reflex = task.reflex();
        for (now, asked) in flexion.into_iter().zip(reflex) {
            assert!((0.05..asked + 1e-3).contains(&now), "{now} of {asked} rad");
        }
        // The small one nearly lets the fingers close.
        let least = if *diameter < 0.03 { 0.01 } else { 0.3 };
        assert!(flexion[1] < reflex[1] - least, "{flexion:?}");
    }
}

/// Interrupted babbling, and trials of the reflex, end within moments; the sequence goes on as if
/// they had not begun. Catches a check for which a whole chunk of babbles is waited.
#[test]
fn interrupted_babbling_is_where_it_was() {
    let task = task();
    let (whole, babbles) = experience(4, &[3], 2);
    for threads in [1, 2] {
        let mut babbling = Babbling::new(4, InHand);
        let mut impatient = pool(threads).interrupted_by(|| true);
        let began = Instant::now();
        let result = babbling.experience(&task, 10_000, &mut impatient);
        assert_eq!(result, Err(AgentError::Env(EnvError::Interrupted)));
        let result = trials(&task, 0.05, 10_000, &mut impatient);
        assert_eq!(result, Err(EnvError::Interrupted));
        let seconds = began.elapsed().as_secs_f64();
        println!("{threads} threads: interrupted twice in {seconds:.3} s");
        assert!(seconds < 2.0, "{seconds} s");
        let rest = babbling.experience(&task, 3, &mut pool(threads)).unwrap();
        assert_eq!((rest, babbling.babbled()), (whole.clone(), babbles));
    }
}

/// A body whose hand keeps nothing is an error that counts what was tried, never an endless search.
#[test]
fn nothing_held_is_an_error() {
    // An open hand, and a palm so near that no object is before it. Long physics steps make a babble
    // short.
    let task = task_with(
        r#"{"body": {"grip": {"reflex_deg": [0, 0]}},
            "grasp": {"palm_reach_m": 0.01, "control_period_s": 0.02, "physics_steps": 1}}"#,
    );
    let result = Babbling::new(0, InHand).experience(&task, 64, &mut pool(2));
    match result.map(|found| found.len()) {
        Err(AgentError::NothingToLearn { learnt, babbled }) => {
            assert!(
                learnt == 0 && (500..600).contains(&babbled),
                "{learnt} of {babbled}"
            );
        }
        other => panic!("{other:?}"),
    }
}

/// The reflex holds what it encloses: of ten objects of either size that are carried about for 10 s
/// without support at least nine stay in the hand, and none sinks 3 mm into it. Catches contacts
/// that are too soft or too hard, and fingers that crush or eject.
#[test]
fn the_reflex_holds() {
    let task = task();
    for diameter in DIAMETERS {
        let trials = trials(&task, diameter, 10, &mut pool(2)).unwrap();
        let held = trials.iter().filter(|trial| trial.held).count();
        let deepest = trials
            .iter()
            .map(|trial| trial.penetration)
            .fold(0.0, f64::max);
        println!(
            "{diameter} m: {held} of 10 held, {:.2} mm deep",
            1e3 * deepest
        );
        assert!(held >= 9, "{diameter} m: {held} of 10");
        assert!(deepest < 3e-3 && deepest > 0.0, "{deepest} m");
        let spread = |i: usize| {
            let all = trials.iter().map(|trial| trial.flexion[i].to_degrees());
            let low = all.clone().fold(f64::INFINITY, f64::min);
            all.fold(0.0, f64::max) - low
        };
        assert!(
            spread(0) < 5.0 && spread(1) < 5.0,
            "{} {}",
            spread(0),
            spread(1)
        );
    }
}

fn learnt(experiences: &[Experience], portions: &[usize], threads: usize) -> GraspNetwork {
    let mut hebb = GraspNetwork::new(GraspBrain::default()).unwrap();
    let mut rest = experiences;
    for &n in portions {
        let (now, later) = rest.split_at(n);
        pool(threads).run(|| hebb.learn(now)).unwrap().unwrap();
        rest = later;
    }
    hebb
}

/// Made-up experiences: the network does not ask where they come from.
fn made_up(n: usize) -> Vec<Experience> {
    let mut stream = babble_env::Stream::new(babble_env::Purpose::Test, 8, 0);
    let mut share = || stream.uniform(0.0, 1.0) as f32;
    let mut all = Vec::new();
    for _ in 0..n {
        let mut fovea = Box::new([0.0; 441]);
        fovea.iter_mut().for_each(|edge| *edge = share().powi(3));
        all.push(Experience {
            eye: [share(), share()],
            fovea,
            arm: [share(), share()],
            hand: [90.0 * share(), 90.0 * share()],
            pregrasp: None,
            diameter: 0.03,
            outcome: Outcome::Success,
        });
    }
    all
}

/// Learning in two calls is learning in one, on any number of threads, to the bit. Catches running
/// averages that start anew with each call.
#[test]
fn learning_goes_on() {
    let experiences = made_up(30);
    let whole = learnt(&experiences, &[30], 1);
    for (portions, threads) in [(&[30][..], 8), (&[11, 19][..], 2)] {
        let other = learnt(&experiences, portions, threads);
        assert_eq!(other.reach(), whole.reach());
        assert_eq!(other.grasp(), whole.grasp());
    }
}

/// A map of the paper's size over [0, `high`]².
fn map(high: f64) -> PopulationMap {
    PopulationMap::new(&MapConfig::square(21, 0.0, high, 0.7)).unwrap()
}

/// Eq. 7 written down: weights of connections from `g` to `a`.
fn eq7(pairs: &[(Vec<f32>, Vec<f32>)]) -> Vec<f64> {
    let (mut w, mut g_mean, mut a_mean) = (vec![0.0; 441 * 441], [0.0; 441], [0.0; 441]);
    for (g, a) in pairs {
        for j in 0..441 {
            for i in 0..441 {
                let old: f64 = w[441 * j + i];
                let (da, dg) = (f64::from(a[j]) - a_mean[j], f64::from(g[i]) - g_mean[i]);
                w[441 * j + i] = old + da * dg * (0.2 - old.abs());
            }
        }
        for k in 0..441 {
            a_mean[k] = 0.2 * a_mean[k] + 0.8 * f64::from(a[k]);
            g_mean[k] = 0.2 * g_mean[k] + 0.8 * f64::from(g[k]);
        }
    }
    w
}

/// The weights are those of Eq. 7 from eye to arm and from fovea to hand. Catches maps wired
/// crosswise, a fovea that is encoded once more, and a hand's map over other angles.
#[test]
fn learning_is_eq_7() {
    let experiences = made_up(20);
    let hebb = learnt(&experiences, &[20], 1);
    let encode = |map: &PopulationMap, x: [f32; 2]| {
        let mut activity = vec![0.0; 441];
        map.encode(&x.map(f64::from), &mut activity).unwrap();
        activity
    };
    let (unit, hand) = (map(1.0), map(90.0));
    let both = experiences.iter().map(|one| {
        let reach = (encode(&unit, one.eye), encode(&unit, one.arm));
        (reach, (one.fovea.to_vec(), encode(&hand, one.hand)))
    });
    let (reach, grasp): (Vec<_>, Vec<_>) = both.unzip();
    for (pairs, learnt) in [(reach, hebb.reach()), (grasp, hebb.grasp())] {
        let expected = eq7(&pairs);
        let largest = expected.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
        assert!(largest > 0.05, "{largest}");
        for (now, expected) in learnt.weights().iter().zip(&expected) {
            assert!(
                (f64::from(*now) - expected).abs() < 1e-5,
                "{now} {expected}"
            );
        }
    }
}

fn mean(values: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| values.iter().map(|value| value[i]).sum::<f64>() / values.len() as f64)
}

/// After 200 babbles the sight of an object that lies on its support, as an episode begins, recalls
/// the hand posture that was babbled with objects of its size, within 2°, and the two sizes apart;
/// where it is recalls an arm that brings the palm near it. A newborn network recalls the middle of
/// its maps. Catches a fovea that does not tell the sizes, and a read-out between them.
#[test]
fn sight_recalls_arm_and_hand() {
    let mut env = Batch::new(task().into(), 40, Autoreset::Disabled, 1).unwrap();
    env.reset(&[true; 40]).unwrap();
    let task = env.task().clone();
    let seen: Vec<(GraspCase, [f32; 2], Vec<f32>)> = (0..40)
        .zip(env.records())
        .map(|(i, record)| {
            let eye = [at::EYE, at::EYE + 1].map(|i| record.senses[i]);
            let case = env.state(i).unwrap().case;
            (
                case,
                eye,
                record.senses[at::FOVEA..][..FOVEA_NEURONS].to_vec(),
            )
        })
        .collect();
    let mut hebb = GraspNetwork::new(GraspBrain::default()).unwrap();
    let nothing = hebb.decide(seen[0].1, &seen[0].2).unwrap();
    assert_eq!((nothing.arm, nothing.hand), ([0.5; 2], [45.0; 2]));

    let mut babbling = Babbling::<GraspTask>::new(0, InHand);
    let experiences = babbling.experience(&task, 200, &mut pool(2)).unwrap();
    assert!(babbling.babbled() < 220, "{} babbles", babbling.babbled());
    hebb.learn(&experiences).unwrap();
    let mut fingers = Vec::new();
    for diameter in DIAMETERS {
        let of_size = experiences.iter().filter(|one| one.diameter == diameter);
        let babbled: Vec<_> = of_size.map(|one| one.hand.map(f64::from)).collect();
        let babbled = mean(&babbled);
        let recalled = seen.iter().filter(|(case, ..)| case.diameter == diameter);
        let recalled = recalled.map(|(_, eye, fovea)| hebb.decide(*eye, fovea).unwrap().hand);
        let recalled: Vec<_> = recalled.collect();
        assert!(recalled.len() > 10);
        for hand in recalled {
            let off = [0, 1].map(|i| (hand[i] - babbled[i]).abs());
            assert!(
                off[0].max(off[1]) < 2.0,
                "{diameter} m: {hand:?} {babbled:?}"
            );
        }
        fingers.push(babbled[1]);
    }
    let apart = fingers[1] - fingers[0];
    assert!(apart > 15.0, "fingers {apart}° apart");
    let mut distances: Vec<f64> = seen
        .iter()
        .map(|(case, eye, fovea)| {
            let arm = task.arm.denormalised(hebb.decide(*eye, fovea).unwrap().arm);
            let [x, y] = task.before_palm(arm, case.radius(), 0.0);
            (x - case.object[0]).hypot(y - case.object[1])
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    println!("palm from object: median {:.3} m", distances[20]);
    assert!(distances[20] < 0.04, "{distances:?}");
}

/// Numbers of the maps out of bounds are named; percepts that are no activities are refused.
#[test]
fn bad_configs_and_percepts_are_named() {
    let base = GraspBrain::default();
    let cases = [
        (
            GraspBrain {
                neurons: 1,
                ..base.clone()
            },
            "neurons",
        ),
        (
            GraspBrain {
                neurons: 102,
                ..base.clone()
            },
            "neurons",
        ),
        (
            GraspBrain {
                sigma: 0.0,
                ..base.clone()
            },
            "sigma",
        ),
        (
            GraspBrain {
                squeeze_deg: f64::NAN,
                ..base.clone()
            },
            "squeeze_deg",
        ),
        (
            GraspBrain {
                squeeze_deg: -1.0,
                ..base.clone()
            },
            "squeeze_deg",
        ),
    ];
    for (config, field) in cases {
        let error = GraspNetwork::new(config).unwrap_err().to_string();
        assert!(error.contains(field), "{error}");
    }
    let mut hebb = GraspNetwork::new(base).unwrap();
    assert!(hebb.recall_hand(&[f32::NAN; 441]).is_err());
    assert!(hebb.recall_hand(&[0.5; 440]).is_err());
    let nan = hebb.decide([f32::NAN; 2], &[0.0; 441]);
    assert!(nan.is_err() || nan.unwrap().arm.iter().all(|x| x.is_finite()));
    // Nothing is learnt from a babble that cannot be.
    let mut broken = made_up(2);
    broken[1].fovea[7] = 2.0;
    assert!(matches!(hebb.learn(&broken), Err(AgentError::Brain(_))));
    assert!(hebb.grasp().weights().iter().all(|&w| w == 0.0));
}
