//! Costs of one call of each part of the brain.

use babble_brain::{
    Association, ConjunctiveMap, CovarianceRule, MapConfig, PopulationMap, TimeBaseGenerator,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const MOVEMENTS: usize = 512;

fn map(neurons: usize) -> PopulationMap {
    PopulationMap::new(&MapConfig::square(neurons, 0.0, 1.0, 0.7)).unwrap()
}

/// The k-th point of a low-discrepancy sequence in the unit square.
fn stimulus(k: usize) -> [f64; 2] {
    [0.754_877_666, 0.569_840_296].map(|step: f64| (k as f64 * step).fract())
}

/// Inputs on a plain map, outputs on the line b2 = 1 - b1, as babbling gives them.
fn babbled_outputs(map: &PopulationMap) -> Vec<f32> {
    let mut a = vec![0.0; MOVEMENTS * map.len()];
    for (k, a) in a.chunks_exact_mut(map.len()).enumerate() {
        let b1 = stimulus(k + MOVEMENTS)[0];
        map.encode(&[b1, 1.0 - b1], a).unwrap();
    }
    a
}

fn maps(c: &mut Criterion) {
    let map_21 = map(21);
    let mut g = vec![0.0; map_21.len()];
    c.bench_function("encode 21x21", |b| {
        b.iter(|| map_21.encode(black_box(&[0.3, 0.6]), &mut g));
    });
    let mut x = [0.0; 2];
    c.bench_function("read out 21x21", |b| {
        b.iter(|| map_21.read_out(black_box(&g), &mut x));
    });
    let pairs = ConjunctiveMap::new(map(11), map(5));
    let mut g = vec![0.0; pairs.len()];
    c.bench_function("encode 11x11 by 5x5", |b| {
        b.iter(|| pairs.encode(black_box(&[0.3, 0.6]), black_box(&[0.1, 0.8]), &mut g));
    });
}

fn generator(c: &mut Criterion) {
    let mut out = vec![[0.0; 2]; 160];
    c.bench_function("generator, 160 samples", |b| {
        b.iter(|| {
            let movement = TimeBaseGenerator::new(black_box(0.7), black_box(0.3), 8.0).unwrap();
            movement.sample_into(&mut out);
        });
    });
}

fn covariance(c: &mut Criterion) {
    let map_21 = map(21);
    let pairs = ConjunctiveMap::new(map(11), map(5));
    let outputs = babbled_outputs(&map_21);
    let mut plain = vec![0.0; MOVEMENTS * map_21.len()];
    for (k, g) in plain.chunks_exact_mut(map_21.len()).enumerate() {
        map_21.encode(&stimulus(k), g).unwrap();
    }
    let mut conjunctive = vec![0.0; MOVEMENTS * pairs.len()];
    for (k, g) in conjunctive.chunks_exact_mut(pairs.len()).enumerate() {
        pairs.encode(&stimulus(k), &stimulus(3 * k + 1), g).unwrap();
    }
    for (n_in, inputs) in [(map_21.len(), plain), (pairs.len(), conjunctive)] {
        let rule = CovarianceRule::default();
        let mut association = Association::new(n_in, map_21.len()).unwrap();
        let mut group = c.benchmark_group(format!("{n_in} to 441"));
        group.throughput(Throughput::Elements(MOVEMENTS as u64));
        group.sample_size(20);
        group.bench_function("learn in a batch", |b| {
            b.iter(|| association.learn(&rule, &inputs, &outputs).unwrap());
        });
        group.bench_function("learn one by one", |b| {
            b.iter(|| {
                let movements = inputs.chunks_exact(n_in).zip(outputs.chunks_exact(441));
                for (g, a) in movements {
                    association.learn(&rule, g, a).unwrap();
                }
            });
        });
        group.throughput(Throughput::Elements(1));
        let mut out = vec![0.0; 441];
        group.bench_function("recall", |b| {
            b.iter(|| {
                association
                    .recall(black_box(&inputs[..n_in]), &mut out)
                    .unwrap();
            });
        });
        group.finish();
    }
}

criterion_group!(benches, maps, generator, covariance);
criterion_main!(benches);
