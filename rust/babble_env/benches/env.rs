//! Costs of a step, a movement and a reset.

use std::hint::black_box;
use std::sync::Arc;

use babble_env::batch::Batch;
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::{CaseRequest, ObstacleRequest};
use babble_env::{
    Autoreset, Config, Control, Purpose, ReachCase, ReachOptions, ReachTask, Stop, Stream,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Random actions are drawn before the clock runs.
const ACTIONS: usize = 4096;

fn task(control: Control) -> Arc<ReachTask> {
    let options = ReachOptions {
        control,
        ..ReachOptions::default()
    };
    Arc::new(ReachTask::new(Config::profile("paper").unwrap(), options).unwrap())
}

fn batch(control: Control, n: usize, threads: usize) -> Batch<ReachTask> {
    let mut batch = Batch::new(task(control), n, Autoreset::NextStep, threads).unwrap();
    batch.reset(&vec![true; n]).unwrap();
    batch
}

fn actions(n: usize) -> Vec<Vec<f32>> {
    let mut stream = Stream::new(Purpose::Policy, 0, 0);
    let mut action = || {
        (0..2 * n)
            .map(|_| stream.uniform(-1.0, 1.0) as f32)
            .collect()
    };
    (0..ACTIONS / n).map(|_| action()).collect()
}

/// One step of a random agent, automatic resets included.
fn steps(c: &mut Criterion) {
    let actions = actions(1);
    for &control in Control::ALL {
        let mut env = batch(control, 1, 1);
        let mut next = actions.iter().cycle();
        c.bench_function(&format!("step, {control}"), |b| {
            b.iter(|| env.step(next.next().unwrap()).unwrap());
        });
    }
}

/// One step of 64 environments; the time of one environment is a 64th.
fn batches(c: &mut Criterion) {
    let actions = actions(64);
    let mut group = c.benchmark_group("batch of 64");
    group.throughput(Throughput::Elements(64));
    for control in [Control::DeltaPosture, Control::Pattern] {
        for threads in [1, 2] {
            let mut env = batch(control, 64, threads);
            let mut next = actions.iter().cycle();
            group.bench_function(format!("{control}, threads {threads}"), |b| {
                b.iter(|| env.step(next.next().unwrap()).unwrap());
            });
        }
    }
    group.finish();
}

/// Whole movements over random geometries: the path, and the path played.
fn movements(c: &mut Criterion) {
    let task = task(Control::Pattern);
    let mut stream = Stream::new(Purpose::Validation, 0, 0);
    let cases: Vec<(ReachCase, [f64; 2])> = (0..200)
        .map(|_| {
            let case = ReachCase::draw_geometry(&task, &mut stream).unwrap();
            let b1 = stream.uniform(0.01, 0.99);
            (case, [b1, 1.0 - b1])
        })
        .collect();
    let mut next = cases.iter().cycle();
    c.bench_function("movement, path", |b| {
        b.iter(|| {
            let (case, parameters) = next.next().unwrap();
            MovementPath::new(&task, black_box(case), *parameters).unwrap()
        });
    });
    for (name, fidelity) in [
        ("full", Fidelity::Full),
        ("quasi-static", Fidelity::QuasiStatic),
    ] {
        let mut next = cases.iter().cycle();
        c.bench_function(&format!("movement, {name}"), |b| {
            b.iter(|| {
                let (case, parameters) = next.next().unwrap();
                let path = MovementPath::new(&task, black_box(case), *parameters).unwrap();
                path.play(&task, case, fidelity, |_| {})
            });
        });
    }
}

/// A reset with a given case, and what drawing one costs beside it.
fn resets(c: &mut Criterion) {
    let mut env = batch(Control::DeltaPosture, 1, 1);
    let task = env.task().clone();
    let case = env.state(0).unwrap().case;
    let request = CaseRequest {
        start: Some(case.hand),
        target: Some(case.target),
        obstacle: ObstacleRequest::Halfway,
    };
    c.bench_function("reset, case given", |b| {
        b.iter(|| {
            env.request(0, black_box(request)).unwrap();
            env.reset(&[true]).unwrap();
        });
    });
    let mut stream = Stream::new(Purpose::Validation, 1, 0);
    c.bench_function("draw a case, geometry alone", |b| {
        b.iter(|| ReachCase::draw_geometry(&task, &mut stream).unwrap());
    });
    for (name, fidelity) in [
        ("full", Fidelity::Full),
        ("quasi-static", Fidelity::QuasiStatic),
    ] {
        c.bench_function(&format!("draw a legal case, {name}"), |b| {
            b.iter(|| {
                ReachCase::draw_legal(&task, &mut stream, fidelity, &Stop::default()).unwrap()
            });
        });
    }
}

criterion_group!(benches, steps, batches, movements, resets);
criterion_main!(benches);
