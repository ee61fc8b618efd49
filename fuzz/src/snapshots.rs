//! Snapshots: refused without a trace, or gone on with.

use std::sync::{Arc, LazyLock};

use babble_env::picture::View;
use babble_env::{
    Autoreset, Batch, Config, Control, EnvError, GraspOptions, GraspTask, ReachOptions, ReachTask,
    Reward, Task,
};
use xxhash_rust::xxh3::xxh3_64;

const CONTROLS: [Control; 4] = [
    Control::DeltaPosture,
    Control::Posture,
    Control::Torque,
    Control::Pattern,
];

/// Ways to choose the options.
pub const CHOICES: u8 = 64;

/// A snapshot of reaching: a byte of options, then the state. Whether it is one.
pub fn reach_snapshot(data: &[u8]) -> bool {
    static TASKS: LazyLock<Vec<Arc<ReachTask>>> = LazyLock::new(|| all(reaching));
    data.split_first()
        .is_some_and(|(&choice, body)| tried(&TASKS[usize::from(choice % CHOICES)], body))
}

/// A snapshot of grasping likewise.
pub fn grasp_snapshot(data: &[u8]) -> bool {
    static TASKS: LazyLock<Vec<Arc<GraspTask>>> = LazyLock::new(|| all(grasping));
    data.split_first()
        .is_some_and(|(&choice, body)| tried(&TASKS[usize::from(choice % CHOICES)], body))
}

fn all<T>(of: impl Fn(u8) -> T) -> Vec<Arc<T>> {
    (0..CHOICES).map(|choice| Arc::new(of(choice))).collect()
}

/// The goal form has one reward alone.
fn reward(goal: bool) -> Reward {
    if goal {
        Reward::Sparse
    } else {
        Reward::Progress
    }
}

/// The task of reaching that a byte stands for.
pub fn reaching(choice: u8) -> ReachTask {
    let goal = choice & 4 != 0;
    let options = ReachOptions {
        control: CONTROLS[usize::from(choice % 4)],
        goal,
        reward: reward(goal),
        max_episode_steps: 20,
        record: choice & 8 != 0,
        ..ReachOptions::default()
    };
    let profile = if choice & 16 == 0 { "paper" } else { "icub" };
    ReachTask::new(Config::profile(profile).expect("a profile"), options).expect("a task")
}

/// The task of grasping that a byte stands for.
pub fn grasping(choice: u8) -> GraspTask {
    let goal = choice & 4 != 0;
    let options = GraspOptions {
        control: CONTROLS[usize::from(choice % 3)],
        goal,
        reward: reward(goal),
        max_episode_steps: 20,
        record: choice & 8 != 0,
        enclosure_reflex: choice & 16 != 0,
        ..GraspOptions::default()
    };
    let engine = if choice & 32 == 0 { "tree" } else { "rapier" };
    let json = format!(r#"{{"body": {{"engine": "{engine}"}}}}"#);
    GraspTask::new(Config::from_json(&json).expect("a config"), options).expect("a task")
}

/// Magic, version, fingerprint of the task, checksum of the state.
type Header = ([u8; 4], u16, u64, u64);

/// A snapshot that holds `body` and is right in all else.
fn with_header(good: &[u8], body: &[u8]) -> Vec<u8> {
    let (header, _): (Header, _) = postcard::take_from_bytes(good).expect("a header");
    let (magic, version, task, _) = header;
    let header: Header = (magic, version, task, xxh3_64(body));
    let mut bytes = postcard::to_stdvec(&header).expect("a header");
    bytes.extend_from_slice(body);
    bytes
}

/// What follows the header of a snapshot.
pub fn body_of(snapshot: &[u8]) -> &[u8] {
    let (_, body): (Header, _) = postcard::take_from_bytes(snapshot).expect("a header");
    body
}

fn tried<T: Task>(task: &Arc<T>, body: &[u8]) -> bool {
    let mut env = Batch::new(task.clone(), 1, Autoreset::Disabled, 1).expect("an environment");
    let before = env.save(0).expect("a snapshot");
    let forged = with_header(&before, body);
    let mut taken = false;
    for bytes in [body, &forged] {
        match env.load(0, bytes) {
            Ok(()) => {
                played_on(&mut env, bytes);
                taken = true;
            }
            Err(EnvError::Snapshot { .. }) => {
                assert_eq!(env.save(0).expect("a snapshot"), before, "loaded in part");
            }
            Err(other) => panic!("refused by another name: {other}"),
        }
    }
    taken
}

/// What can be done with an episode that was loaded.
fn played_on<T: Task>(env: &mut Batch<T>, bytes: &[u8]) {
    let task = env.task().clone();
    finite(env);
    look(&*task, env.state(0).expect("a state"));
    let again = env.save(0).expect("a snapshot");
    env.load(0, &again).expect("a snapshot of what was loaded");
    assert!(again == env.save(0).expect("a snapshot"), "another state");
    // Numbers may be written in more ways than one, but the state is the same.
    assert!(again.len() <= bytes.len(), "more than was read");
    for action in [1.0, -1.0, 0.3] {
        match env.step(&vec![action; task.action_len()]) {
            Ok(()) => finite(env),
            Err(EnvError::NeedsReset { env: 0 }) => {}
            Err(other) => panic!("a step failed: {other}"),
        }
    }
    look(&*task, env.state(0).expect("a state"));
}

fn look<T: Task>(task: &T, state: &T::State) {
    for view in [View::ThirdPerson, View::Eye, View::Edges] {
        task.picture(state, view, [16, 16], None)
            .expect("a picture");
    }
    if task.moments(state) > 0 {
        let first = task.picture(state, View::ThirdPerson, [16, 16], Some(0));
        first.expect("a picture");
    }
}

fn finite<T: Task>(env: &Batch<T>) {
    for record in env.records() {
        assert!(record.senses.iter().all(|x| x.is_finite()), "{record:?}");
        assert!(record.step.reward.is_finite(), "{record:?}");
        let mut goals = record.achieved.iter().chain(&record.desired);
        assert!(goals.all(|x| x.is_finite()), "{record:?}");
    }
}
