//! Costs of babbling, learning and deciding.

use std::hint::black_box;

use babble_agent::reach::reference::{oracle, scripted};
use babble_agent::{Babbling, Network, ReachBabbling, ReachBrain, ReachNetwork, Variant};
use babble_env::tasks::reach::movement::{Fidelity, MovementPath};
use babble_env::tasks::reach::protocol;
use babble_env::{Config, Executor, Outcome, Purpose, ReachOptions, ReachTask};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Legal movements babbled in one go: several of babbling's own chunks.
const MOVEMENTS: usize = 500;

fn task() -> ReachTask {
    ReachTask::new(Config::profile("paper").unwrap(), ReachOptions::default()).unwrap()
}

/// The time of one legal movement is that of an element.
fn babbling(c: &mut Criterion) {
    let task = task();
    let mut group = c.benchmark_group("babble");
    group.throughput(Throughput::Elements(MOVEMENTS as u64));
    group.sample_size(10);
    for (name, quasi_static) in [("full", false), ("quasi-static", true)] {
        let options = ReachBabbling { quasi_static };
        for threads in [1, 2] {
            let mut pool = Executor::new(threads).unwrap();
            group.bench_function(format!("{name}, threads {threads}"), |b| {
                b.iter(|| {
                    let mut babbling = Babbling::new(black_box(0), options);
                    babbling.experience(&task, MOVEMENTS, &mut pool).unwrap()
                });
            });
        }
    }
    group.finish();
}

fn hebb(c: &mut Criterion) {
    let task = task();
    let mut pool = Executor::new(1).unwrap();
    let experiences = Babbling::new(0, ReachBabbling { quasi_static: true })
        .experience(&task, MOVEMENTS, &mut pool)
        .unwrap();
    for variant in [Variant::Paper, Variant::Conjunctive] {
        let mut hebb = ReachNetwork::new(ReachBrain::variant(variant)).unwrap();
        let mut group = c.benchmark_group(format!("hebb, {variant}"));
        group.sample_size(20);
        group.throughput(Throughput::Elements(MOVEMENTS as u64));
        group.bench_function("learn", |b| {
            b.iter(|| {
                pool.run(|| hebb.learn(black_box(&experiences)))
                    .unwrap()
                    .unwrap();
            });
        });
        group.throughput(Throughput::Elements(1));
        let mut next = experiences.iter().cycle();
        group.bench_function("decide", |b| {
            b.iter(|| {
                let seen = next.next().unwrap();
                hebb.decide(black_box(seen.eye), seen.obstacle).unwrap()
            });
        });
        group.finish();
    }
}

fn references(c: &mut Criterion) {
    let task = task();
    let mut pool = Executor::new(1).unwrap();
    let cases = protocol::table1(&task, 50, 0, Purpose::Validation, &mut pool).unwrap();
    let mut next = cases.iter().cycle();
    c.bench_function("scripted, decide and play", |b| {
        b.iter(|| {
            let case = next.next().unwrap();
            let path = MovementPath::new(&task, case, scripted(case)).unwrap();
            path.play(&task, case, Fidelity::Full, |_| {}).outcome == Outcome::Success
        });
    });
    c.bench_function("oracle, decide", |b| {
        b.iter(|| oracle(&task, next.next().unwrap()).unwrap());
    });
}

criterion_group!(benches, babbling, hebb, references);
criterion_main!(benches);
