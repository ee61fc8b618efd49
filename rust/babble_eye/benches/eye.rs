//! What the eye costs.

#[path = "../tests/eye_scene/mod.rs"]
mod eye_scene;

use std::hint::black_box;

use babble_eye::{
    Eye, EyeConfig, Primitive, SHAPE_LEN, foveal_shape, rasterise, red_centroid, render_rgb_into,
    render_smooth, third_person,
};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;

/// Targets spread over the reachable ring by the golden angle.
fn targets() -> Vec<Vector3<f64>> {
    (0..200)
        .map(|k| {
            let share = (f64::from(k) + 0.5) / 200.0;
            let radius = (0.01 + share * (0.39 * 0.39 - 0.01)).sqrt();
            let angle = 2.399_963 * f64::from(k);
            Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        })
        .collect()
}

fn pictures(c: &mut Criterion) {
    let scene = eye_scene::example();
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&Vector3::new(-0.16, 0.27, 0.0)));
    let mut pixels = vec![0; 3 * camera.width * camera.height];
    c.bench_function("eye id and depth 630", |b| {
        b.iter(|| rasterise(black_box(&scene), &camera));
    });
    c.bench_function("eye rgb 630", |b| {
        b.iter(|| render_rgb_into(black_box(&scene), &camera, &mut pixels));
    });
    c.bench_function("eye fovea id and depth 63", |b| {
        let fovea = camera.middle(63, 63);
        b.iter(|| rasterise(black_box(&scene), &fovea));
    });
    let onlooker = third_person(480, 480);
    let with_trail: Vec<Primitive> = scene.iter().cloned().chain(eye_scene::trail()).collect();
    c.bench_function("third person smooth 480", |b| {
        b.iter(|| render_smooth(black_box(&scene), &onlooker));
    });
    c.bench_function("third person smooth 480, trail of 40", |b| {
        b.iter(|| render_smooth(black_box(&with_trail), &onlooker));
    });
}

fn centroid(c: &mut Criterion) {
    let scene = eye_scene::example();
    let target = Vector3::new(-0.16, 0.27, 0.0);
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&target));
    c.bench_function("red centroid, target alone", |b| {
        b.iter(|| red_centroid(black_box(&scene[1..2]), &camera));
    });
    c.bench_function("red centroid, whole scene", |b| {
        b.iter(|| red_centroid(black_box(&scene), &camera));
    });
    let hidden = eye_scene::reaching(0.15, 0.75, Vector3::new(0.10, 0.03, -0.02), target);
    let camera = eye.camera(eye.fixate(&Vector3::new(0.10, 0.03, -0.02)));
    c.bench_function("red centroid, behind the arm", |b| {
        b.iter(|| red_centroid(black_box(&hidden), &camera));
    });
    let camera = eye.camera(eye.fixate(&eye_scene::grasped()));
    for (name, across) in [("beside", 0.06), ("over", 0.0)] {
        let scene = eye_scene::grasping(across);
        c.bench_function(&format!("red centroid of 42 pixels, hand {name}"), |b| {
            b.iter(|| red_centroid(black_box(&scene), &camera));
        });
    }
}

fn fovea(c: &mut Criterion) {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&eye_scene::grasped()));
    let mut shape = [0.0; SHAPE_LEN];
    for (name, across) in [("beside", 0.06), ("over", 0.0)] {
        let scene = eye_scene::grasping(across);
        c.bench_function(&format!("foveal shape, hand {name}"), |b| {
            b.iter(|| foveal_shape(black_box(&scene), &camera, &mut shape));
        });
    }
}

fn reflex(c: &mut Criterion) {
    for (name, config) in [
        ("helmholtz", EyeConfig::helmholtz()),
        ("fick", EyeConfig::fick()),
    ] {
        let eye = Eye::new(config).unwrap();
        let scenes: Vec<_> = targets()
            .iter()
            .map(|target| [Primitive::target(*target, 0.012)])
            .collect();
        let mut next = scenes.iter().cycle();
        c.bench_function(&format!("foveate, {name}"), |b| {
            b.iter(|| eye.foveate(black_box(next.next().unwrap()), eye.rest()));
        });
    }
}

criterion_group!(benches, pictures, centroid, fovea, reflex);
criterion_main!(benches);
