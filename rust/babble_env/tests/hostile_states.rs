//! States that were written well and hold nonsense: refused with what is wrong, and the environment
//! is as it was. Each is one that a step, an observation or a picture could not bear.

mod playing;

use babble_body::Obstacle;
use babble_env::progress::Phase;
use babble_env::tasks::grasp::{Contacts, Enclosure, GraspRequest, GraspState, Grip};
use babble_env::tasks::reach::ReachState;
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Autoreset, Batch, Config, Control, EnvError, GraspOptions, GraspTask, Outcome, ReachOptions,
    Task, snapshot,
};
use babble_eye::Gaze;
use nalgebra::Vector2;
use playing::grasping::{before_the_palm, grasp, grasp_with, obstacle, script, with_control};
use playing::{bits, control, seeded, task};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

type Spoil<'a, S> = &'a dyn Fn(&mut S);

/// Loads what `spoil` makes of an environment's state, and expects a refusal that says `named`.
fn refused<T: Task>(env: &mut Batch<T>, named: &str, spoil: impl FnOnce(&mut T::State)) {
    let before = bits(env);
    let mut state = env.state(0).unwrap().clone();
    spoil(&mut state);
    let bytes = snapshot::save(&**env.task(), &state).unwrap();
    match env.load(0, &bytes) {
        Err(EnvError::Snapshot { problem }) => {
            assert!(problem.contains(named), "{named}: {problem}");
        }
        other => panic!("{named}: {other:?}"),
    }
    assert!(bits(env) == before, "{named}");
}

#[test]
fn nonsense_of_reaching_is_refused() {
    for of in [Control::DeltaPosture, Control::Torque, Control::Pattern] {
        let options = ReachOptions {
            record: true,
            ..control(of)
        };
        let mut env = seeded(task(options), 1, Autoreset::NextStep, 1, 3);
        env.step(&[0.2, 0.2]).unwrap();
        let most = options.max_episode_steps;
        let far = Some(Obstacle {
            centre: Vector2::new(1e300, 0.0),
            radius: 0.02,
        });
        let cases: [(&str, Spoil<ReachState>); 25] = [
            ("arm.q = NaN", &|s| s.arm.q[0] = NAN),
            ("arm.q", &|s| s.arm.q[1] = 3.0),
            ("arm.v = NaN", &|s| s.arm.v[1] = NAN),
            ("arm.v = inf", &|s| s.arm.v[0] = INF),
            ("arm.v", &|s| s.arm.v[0] = 1e9),
            ("equilibrium = NaN", &|s| s.equilibrium[0] = NAN),
            ("equilibrium", &|s| s.equilibrium[1] = -1e6),
            ("case.start", &|s| s.case.start[0] = 1e3),
            ("case.hand", &|s| s.case.hand[0] = NAN),
            ("case.target", &|s| s.case.target[1] = INF),
            ("case.target", &|s| s.case.target = [0.5, 0.0]),
            ("obstacle", &|s| s.case.obstacle = far),
            ("obstacle", &|s| {
                s.case.obstacle = Some(obstacle([0.1, NAN], 0.02));
            }),
            ("obstacle", &|s| {
                s.case.obstacle = Some(obstacle([0.1, 0.1], -1.0));
            }),
            ("gaze.pan", &|s| s.gaze.pan = NAN),
            ("gaze.tilt", &|s| s.gaze.tilt = 1.3),
            ("distance", &|s| s.distance = -INF),
            ("steps", &|s| s.progress.steps = u32::MAX),
            ("steps", &|s| {
                s.lifecycle.phase = Phase::Running;
                s.progress.steps = most;
            }),
            ("outcome lost", &|s| s.progress.outcome = Outcome::Lost),
            ("start", &|s| s.lifecycle.request.start = Some([NAN, 0.0])),
            ("target", &|s| {
                s.lifecycle.request = CaseRequest {
                    target: Some([9.0, 9.0]),
                    ..s.lifecycle.request
                };
            }),
            ("obstacle", &|s| {
                s.lifecycle.request.obstacle = ObstacleRequest::At(obstacle([INF, 0.0], 0.02));
            }),
            ("trail", &|s| s.trail[0] = [NAN, 0.3]),
            ("moments", &|s| s.trail = vec![[0.3, 0.3]; 400]),
        ];
        for (named, spoil) in cases {
            refused(&mut env, named, spoil);
        }
    }
}

/// An episode in mid-contact that records its moments.
fn in_contact(engine: &str) -> Batch<GraspTask> {
    let options = GraspOptions {
        enclosure_reflex: true,
        record: true,
        ..with_control(Control::DeltaPosture)
    };
    let task = grasp_with(&format!(r#"{{"body": {{"engine": "{engine}"}}}}"#), options);
    let near = before_the_palm(&task, 0.05);
    let mut env = seeded(task, 1, Autoreset::NextStep, 1, 3);
    env.request(0, near).unwrap();
    env.reset(&[true]).unwrap();
    for _ in 0..30 {
        let action = script(env.task(), env.state(0).unwrap(), false);
        env.step(&action).unwrap();
    }
    let state = env.state(0).unwrap();
    assert!(state.palm_reach && env.task().robot.touch(&state.world).any());
    env
}

#[test]
fn nonsense_of_grasping_is_refused() {
    for engine in ["tree", "rapier"] {
        let mut env = in_contact(engine);
        let cases: [(&str, Spoil<GraspState>); 25] = [
            ("case.start", &|s| s.case.start[0] = NAN),
            ("case.object", &|s| s.case.object[0] = INF),
            ("case.diameter", &|s| s.case.diameter = NAN),
            ("case.diameter", &|s| s.case.diameter = 1e-9),
            ("not the case's", &|s| s.case.diameter *= 1.5),
            ("goal", &|s| s.case.goal = Some([0.1, 0.1])),
            ("not the case's", &|s| {
                s.case.obstacle = Some(obstacle([0.0, 0.3], 0.02));
            }),
            ("equilibrium", &|s| s.equilibrium[3] = NAN),
            ("equilibrium", &|s| s.equilibrium[0] = 1e9),
            ("gaze.pan", &|s| {
                s.gaze = Gaze {
                    pan: NAN,
                    tilt: 0.0,
                }
            }),
            ("touch", &|s| s.touch[1] = -1.0),
            ("touch", &|s| s.touch[2] = NAN),
            ("distance", &|s| s.distance = NAN),
            ("steps", &|s| s.progress.steps = 1 << 30),
            ("outcome joint_limit", &|s| {
                s.progress.outcome = Outcome::JointLimit;
            }),
            ("support", &|s| s.enclosure.grip = Grip::Tried(3)),
            ("tried still", &|s| s.enclosure.grip = Grip::Tried(u32::MAX)),
            ("one side of the hand", &|s| {
                let numbers = Config::profile("paper").unwrap().grasp;
                let enclosing = Contacts {
                    enclosing: 1,
                    ..Contacts::default()
                };
                s.enclosure = Enclosure::default();
                s.enclosure.step(&numbers, enclosing, false);
            }),
            ("start", &|s| s.lifecycle.request.start = Some([NAN, 0.0])),
            ("diameter", &|s| {
                s.lifecycle.request = GraspRequest {
                    diameter: Some(9.0),
                    ..s.lifecycle.request
                };
            }),
            ("a moment has 3 joints", &|s| {
                s.trail[1].joints.truncate(3);
            }),
            ("trail", &|s| s.trail[0].joints[0] = NAN),
            ("trail", &|s| s.trail[0].object[2] = INF),
            ("trail.pan", &|s| s.trail[2].gaze.pan = 9.0),
            ("moments", &|s| {
                let moment = s.trail[0].clone();
                s.trail.resize(500, moment);
            }),
        ];
        for (named, spoil) in cases {
            refused(&mut env, named, spoil);
        }
    }
}

/// A state of rapier in a world that the tree engine steps, and the other way round.
#[test]
fn worlds_of_another_engine_are_refused() {
    let general = in_contact("rapier").state(0).unwrap().clone();
    let special = in_contact("tree").state(0).unwrap().clone();
    refused(&mut in_contact("tree"), "rapier", |s| {
        s.world = general.world;
    });
    refused(&mut in_contact("rapier"), "tree", |s| {
        s.world = special.world;
    });
}

/// What is written of a state of rapier is what the robot was made to do, so a state that its past
/// does not lead to is refused: with a step less, from another start, pulled further than muscles do.
#[test]
fn worlds_that_their_past_does_not_lead_to_are_refused() {
    let mut env = in_contact("rapier");
    refused(&mut env, "steps", |s| s.progress.steps -= 1);
    // A world is written from its joints on: the last bit of the first angle.
    refused(&mut env, "past", |s| {
        let mut bytes = postcard::to_stdvec(&s.world).unwrap();
        bytes[0] ^= 1;
        s.world = postcard::from_bytes(&bytes).unwrap();
    });
    refused(&mut env, "did not begin", |s| s.case.start[0] += 0.01);
    let task = env.task().clone();
    let state = env.state(0).unwrap().clone();
    let far = babble_body::robot::towards([9.0; 4]);
    refused(&mut env, "a muscle pulled to 9", |s| {
        s.progress.steps += 1;
        task.robot.step(&mut s.world, &far);
    });
    env.load(0, &snapshot::save(&*task, &state).unwrap())
        .unwrap();
}

/// The least and the most that a state can be: before the first reset, after an end, after a failure
/// in the goal form. Catches a check that refuses what episodes do.
#[test]
fn what_episodes_do_is_taken() {
    for of in [Control::DeltaPosture, Control::Posture, Control::Torque] {
        let options = GraspOptions {
            max_episode_steps: 4,
            ..playing::grasping::goal_form(of)
        };
        let mut env = Batch::new(grasp(options), 1, Autoreset::NextStep, 1).unwrap();
        let fresh = env.save(0).unwrap();
        env.load(0, &fresh).unwrap();
        env.reset(&[true]).unwrap();
        for step in 0..12 {
            let action = [if step % 2 == 0 { 1.0 } else { -1.0 }; 4];
            env.step(&action).unwrap();
            let bytes = env.save(0).unwrap();
            env.load(0, &bytes).unwrap();
            assert_eq!(env.save(0).unwrap(), bytes);
        }
    }
}

/// A stream of random numbers at its fixed point would draw the same case for ever.
#[test]
fn a_stream_that_stands_still_is_refused() {
    let mut env = seeded(
        task(control(Control::Posture)),
        1,
        Autoreset::NextStep,
        1,
        3,
    );
    refused(&mut env, "stands still", |s| {
        // Its two words, of 128 bits each, as numbers of one byte.
        s.lifecycle.stream = postcard::from_bytes(&[0, 0]).unwrap();
    });
}
