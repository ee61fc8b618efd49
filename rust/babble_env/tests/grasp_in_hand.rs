//! Cases that begin with the object in the hand, as babbling puts it there.

mod playing;

use babble_body::robot::Posture;
use babble_env::tasks::grasp::{GraspCase, GraspRequest, InHand, ObjectPlace, protocol};
use babble_env::{
    Config, EnvError, Executor, GraspOptions, GraspTask, Outcome, Purpose, Stop, Stream,
};
use playing::ended;
use playing::grasping::{asked, asking_for, goal_form, grasp, with_control};

fn with_share(in_hand_starts: f64) -> GraspOptions {
    GraspOptions {
        in_hand_starts,
        ..GraspOptions::default()
    }
}

fn tasks(options: GraspOptions) -> [GraspTask; 2] {
    ["paper", "icub"].map(|body| GraspTask::new(Config::profile(body).unwrap(), options).unwrap())
}

fn cases(task: &GraspTask, n: usize) -> Vec<GraspCase> {
    let executor = &mut Executor::new(2).unwrap();
    protocol::random(task, n, 7, Purpose::Environment, executor).unwrap()
}

fn in_hand(task: &GraspTask, case: &GraspCase) -> bool {
    case.object == task.at_palm(case.start, case.radius())
}

/// So many cases begin in the hand as the share says, none at 0 and all at 1, in both forms and on
/// both bodies. Catches a share of tries in place of cases: cases in the hand are refused less often.
#[test]
fn the_share_is_of_cases() {
    for form in [with_share(0.0), goal_form(GraspOptions::default().control)] {
        for (share, least, most) in [(0.0, 0, 0), (0.3, 240, 360), (1.0, 1000, 1000)] {
            let options = GraspOptions {
                in_hand_starts: share,
                ..form
            };
            for task in tasks(options) {
                let found = cases(&task, 1000);
                let held = found.iter().filter(|case| in_hand(&task, case)).count();
                assert!((least..=most).contains(&held), "{share}: {held}");
            }
        }
    }
}

/// An episode begins in the very world in which a babble does, the object clear of the upper arm, and
/// arms start in all of their joint ranges. Catches a gap of its own, a closed hand, and postures of
/// the region.
#[test]
fn it_begins_as_a_babble_does() {
    for task in tasks(with_share(1.0)) {
        let found = cases(&task, 300);
        for case in &found {
            let env = asked(
                task.clone().into(),
                0,
                GraspRequest {
                    start: Some(case.start),
                    object: ObjectPlace::At(case.object),
                    diameter: Some(case.diameter),
                    ..GraspRequest::default()
                },
            );
            let babble = InHand::new(&task, case.start, case.diameter);
            let worlds = [&env.state(0).unwrap().world, babble.world()];
            let [episode, babble] = worlds.map(|world| format!("{world:?}"));
            assert_eq!(episode, babble);
            assert!(task.clears_upper_arm(case.start[1], case.radius()));
        }
        for i in 0..2 {
            let width = task.arm.upper_limit[i] - task.arm.lower[i];
            let share = |case: &GraspCase| (case.start[i] - task.arm.lower[i]) / width;
            let low = found.iter().map(share).fold(f64::INFINITY, f64::min);
            let high = found.iter().map(share).fold(0.0, f64::max);
            assert!(low < 0.3 && high > 0.95, "joint {i}: {low} to {high}");
        }
    }
}

/// The hand that closes where it is holds objects of 6 cm mostly, as in babbling. Catches a hand that
/// begins with no room to close, and an object that is not at rest.
#[test]
fn a_hand_that_closes_holds_the_object() {
    let task = grasp(GraspOptions {
        in_hand_starts: 1.0,
        ..with_control(babble_env::Control::Posture)
    });
    let big = GraspRequest {
        diameter: Some(0.06),
        ..GraspRequest::default()
    };
    let outcomes = (0..20).map(|seed| {
        let mut env = asked(task.clone(), seed, big);
        let [shoulder, elbow] = env.state(0).unwrap().case.start;
        let [thumb, finger] = task.reflex();
        let closed: Posture = [shoulder, elbow, thumb, finger];
        loop {
            let action = asking_for(&task, env.state(0).unwrap(), closed);
            env.step(&action).unwrap();
            if ended(&playing::record(&env)) {
                return env.state(0).unwrap().progress.outcome;
            }
        }
    });
    let held = outcomes.filter(|&outcome| outcome == Outcome::Success);
    assert!(held.count() >= 15);
}

/// Without the option cases are those of a task that has no such option: the others of a share are
/// drawn from the same region. A case of which a place is given never begins in the hand.
#[test]
fn given_places_are_kept() {
    let [task, _] = tasks(with_share(1.0));
    let draw = |request: GraspRequest, seed: u64| {
        let mut stream = Stream::new(Purpose::Environment, seed, 0);
        request.draw(&task, &mut stream, &Stop::default()).unwrap()
    };
    let start = GraspRequest {
        start: Some([0.7, 0.9]),
        ..GraspRequest::default()
    };
    let object = GraspRequest {
        object: ObjectPlace::At([0.05, 0.25]),
        ..GraspRequest::default()
    };
    for seed in 0..50 {
        assert!(!in_hand(&task, &draw(start, seed)));
        assert_eq!(draw(object, seed).object, [0.05, 0.25]);
    }
}

/// A share beyond [0, 1] is refused by name, NaN too.
#[test]
fn other_shares_are_refused() {
    for share in [-0.1, 1.1, f64::NAN] {
        let made = GraspTask::new(Config::profile("paper").unwrap(), with_share(share));
        assert!(matches!(
            made,
            Err(EnvError::OutOfBounds {
                option: "in_hand_starts",
                ..
            })
        ));
    }
}

/// An object that is asked to be in the hand lies at the palm, from any start and of any size that are
/// asked for too; one that is asked to be apart never does. Catches a request that the share of starts
/// overrules, a start that is drawn anew, and an answer that moves the cases of others.
#[test]
fn the_hand_can_be_asked_for() {
    for share in [0.0, 1.0] {
        for task in tasks(with_share(share)) {
            for seed in 0..50 {
                let draw = |request: GraspRequest| {
                    let mut stream = Stream::new(Purpose::Test, seed, 0);
                    request.draw(&task, &mut stream, &Stop::default()).unwrap()
                };
                let of = |object| GraspRequest {
                    object,
                    ..GraspRequest::default()
                };
                assert!(in_hand(&task, &draw(of(ObjectPlace::InHand))));
                assert!(!in_hand(&task, &draw(of(ObjectPlace::Apart))));
                let case = draw(GraspRequest {
                    start: Some([0.1, 0.6]),
                    diameter: Some(0.05),
                    ..of(ObjectPlace::InHand)
                });
                assert!(in_hand(&task, &case));
                assert_eq!((case.start, case.diameter), ([0.1, 0.6], 0.05));
            }
        }
    }
}

/// A hand that cannot hold the object asked for, as the upper arm is in the way, is refused at once.
#[test]
fn a_hand_without_room_is_refused() {
    let task = &tasks(with_share(0.0))[0];
    let request = GraspRequest {
        start: Some([0.0, task.arm.upper_limit[1]]),
        object: ObjectPlace::InHand,
        diameter: Some(0.2),
        ..GraspRequest::default()
    };
    let drawn = request.draw(
        task,
        &mut Stream::new(Purpose::Test, 0, 0),
        &Stop::default(),
    );
    assert!(
        matches!(drawn, Err(EnvError::Case { what: "object", .. })),
        "{drawn:?}"
    );
}
