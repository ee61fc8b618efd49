//! What grasping costs: a control step with its senses, free and with the object held, resets.

use std::hint::black_box;

use babble_env::tasks::grasp::{GraspRequest, Grip, ObjectPlace};
use babble_env::{
    Config, Control, Episode, GraspOptions, GraspTask, Purpose, Stop, Stream, Task, snapshot,
};
use criterion::{Criterion, criterion_group, criterion_main};

fn task(control: Control) -> GraspTask {
    let options = GraspOptions {
        control,
        max_episode_steps: 1_000_000,
        enclosure_reflex: true,
        ..GraspOptions::default()
    };
    GraspTask::new(Config::profile("paper").expect("there is one"), options).expect("it is valid")
}

fn begun(task: &GraspTask, request: GraspRequest) -> Episode<GraspTask> {
    let mut episode = Episode::new(task, Stream::new(Purpose::Validation, 1, 0));
    episode.request(request);
    let drawn = episode
        .draw(task, &Stop::default())
        .expect("it can be played");
    episode.begin(task, drawn);
    episode
}

/// The hand around an object, support and all.
fn held(task: &GraspTask) -> Episode<GraspTask> {
    let object = [0.05, 0.25];
    let request = GraspRequest {
        start: Some([-0.5, 0.6]),
        object: ObjectPlace::At(object),
        diameter: Some(0.05),
        ..GraspRequest::default()
    };
    let mut episode = begun(task, request);
    let there = task.grasp_posture(object, 0.01).expect("it is in reach");
    let action = task.robot.normalised(task.robot.open_hand(there));
    let action = action.map(|share| (2.0 * share - 1.0) as f32);
    while episode.state().enclosure.grip == Grip::Open {
        episode.step(task, &action).expect("it runs");
    }
    episode
}

fn steps(c: &mut Criterion) {
    let mut senses = vec![0.0; task(Control::DeltaPosture).senses_len()];
    let free = task(Control::DeltaPosture);
    let mut episode = begun(&free, GraspRequest::default());
    let mut k = 0_u32;
    c.bench_function("grasp: control step with senses, free", |b| {
        b.iter(|| {
            // To and fro, away from the object.
            k += 1;
            let action = if k % 40 < 20 { 0.3 } else { -0.3 };
            let step = episode.step(&free, black_box(&[action, -action, 0.0, 0.0]));
            episode.observe(&free, &mut senses);
            black_box(step)
        });
    });
    let posture = task(Control::Posture);
    let enclosed = held(&posture).state().clone();
    let action = [0.0, 0.2, 0.0, 0.0];
    c.bench_function("grasp: control step with senses, object held", |b| {
        let mut episode = Episode::from_state(&posture, enclosed.clone());
        b.iter(|| {
            if episode.step(&posture, black_box(&action)).is_err() {
                episode = Episode::from_state(&posture, enclosed.clone());
            }
            episode.observe(&posture, &mut senses);
        });
    });
}

fn resets(c: &mut Criterion) {
    let task = task(Control::DeltaPosture);
    let mut episode = begun(&task, GraspRequest::default());
    let case = episode.state().case;
    let mut reset = |name: &str, request: GraspRequest| {
        episode.request(request);
        c.bench_function(name, |b| {
            b.iter(|| {
                let drawn = episode
                    .draw(&task, &Stop::default())
                    .expect("it can be played");
                episode.begin(&task, drawn);
            });
        });
    };
    reset(
        "grasp: reset with a given case",
        GraspRequest {
            start: Some(case.start),
            object: ObjectPlace::At(case.object),
            diameter: Some(case.diameter),
            ..GraspRequest::default()
        },
    );
    reset("grasp: reset that draws its case", GraspRequest::default());
    c.bench_function("grasp: snapshot", |b| {
        b.iter(|| snapshot::save(&task, black_box(episode.state())));
    });
}

criterion_group!(benches, steps, resets);
criterion_main!(benches);
