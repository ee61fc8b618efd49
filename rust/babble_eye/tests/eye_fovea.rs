//! The shape of the foveated object: Sobel edges in the middle of the image.

mod eye_scene;

use babble_eye::{
    Eye, EyeConfig, FOVEA_BLOCK, FOVEA_BLOCKS, FOVEA_PIXELS, Material, Pinhole, Primitive,
    SHAPE_LEN, Shape, foveal_edges, foveal_picture, foveal_shape, is_red, render_rgb,
    shape_picture,
};
use image::RgbImage;
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

type V = Vector3<f64>;

/// First column and row of the fovea in the image, by the definition.
const FIRST: u32 = 283;
const EDGE: u32 = FOVEA_PIXELS as u32;

/// The camera of the default eye that looks at a point.
fn looking_at(point: &V) -> Pinhole {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    eye.camera(eye.fixate(point))
}

fn shape_of(scene: &[Primitive], camera: &Pinhole) -> [f32; SHAPE_LEN] {
    let mut shape = [f32::NAN; SHAPE_LEN];
    foveal_shape(scene, camera, &mut shape);
    shape
}

fn luminance(image: &RgbImage, i: u32, j: u32) -> f64 {
    let [r, g, b] = image.get_pixel(i, j).0.map(f64::from);
    (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0
}

/// The Sobel filter by its definition, over its greatest possible value.
fn sobel(image: &RgbImage, i: u32, j: u32) -> f64 {
    let y = |di: u32, dj: u32| luminance(image, i + di - 1, j + dj - 1);
    let gx = y(2, 0) + 2.0 * y(2, 1) + y(2, 2) - y(0, 0) - 2.0 * y(0, 1) - y(0, 2);
    let gy = y(0, 2) + 2.0 * y(1, 2) + y(2, 2) - y(0, 0) - 2.0 * y(1, 0) - y(2, 0);
    (gx * gx + gy * gy).sqrt() / 32.0_f64.sqrt()
}

/// Mean of a block of the whole image's edges.
fn block(image: &RgbImage, k: usize) -> f64 {
    let corner = [k % FOVEA_BLOCKS, k / FOVEA_BLOCKS].map(|b| FIRST + (FOVEA_BLOCK * b) as u32);
    let offsets = (0..9).map(|p| (p % 3, p / 3));
    offsets
        .map(|(i, j)| sobel(image, corner[0] + i, corner[1] + j))
        .sum::<f64>()
        / 9.0
}

fn plain(level: u8) -> Material {
    Material::plain([level; 3])
}

/// A slab whose upper face is at height `top` and covers x and y from `low` to `high`.
fn slab(low: [f64; 2], high: [f64; 2], top: f64, material: Material) -> Primitive {
    let [x, y] = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
    let shape = Shape::Cuboid {
        centre: Vector3::new(x, y, top - 0.001),
        rotation: Matrix3::identity(),
        half_extents: Vector3::new(high[0] - x, high[1] - y, 0.001),
    };
    Primitive::new(shape, material)
}

fn table(level: u8) -> Primitive {
    slab([-2.0; 2], [2.0; 2], -0.05, plain(level))
}

/// A point within a few centimetres of another.
fn near(point: V) -> impl Strategy<Value = V> {
    [-0.06..0.06, -0.06..0.06, -0.06..0.06].prop_map(move |offset| point + Vector3::from(offset))
}

fn solid(around: V) -> impl Strategy<Value = Shape> {
    let radius = 0.003..0.04;
    prop_oneof![
        (near(around), radius.clone())
            .prop_map(|(centre, radius)| Shape::Sphere { centre, radius }),
        (near(around), near(around), radius.clone()).prop_map(|(a, b, radius)| Shape::Capsule {
            a,
            b,
            radius
        }),
        (near(around), near(around), radius).prop_map(|(a, b, radius)| Shape::Cylinder {
            a,
            b,
            radius
        }),
        (
            near(around),
            -3.0..3.0,
            -3.0..3.0,
            [0.003..0.05, 0.003..0.05, 0.003..0.05]
        )
            .prop_map(|(centre, about_z, about_x, half)| Shape::Cuboid {
                centre,
                rotation: eye_scene::turned(about_z, about_x),
                half_extents: Vector3::from(half),
            }),
    ]
}

/// Where the random scenes are.
fn middle() -> V {
    Vector3::new(0.08, 0.25, 0.0)
}

/// Solids around the middle over a ground with their shadows.
fn scene() -> impl Strategy<Value = Vec<Primitive>> {
    let material = (any::<[u8; 3]>(), any::<bool>());
    let solids = proptest::collection::vec((solid(middle()), material), 1..12);
    solids.prop_map(|solids| {
        let ground = Shape::Ground {
            height: -0.08,
            centre: [0.05, 0.2],
            half_extents: [0.13, 0.2],
            cell: 0.02,
        };
        let ground = Primitive::new(ground, plain(190));
        let solids = solids
            .into_iter()
            .map(|(shape, (colour, target))| Primitive::new(shape, Material { colour, target }));
        std::iter::once(ground).chain(solids).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Catches a shape that is cut from the image at a wrong place, a filter
    /// that invents the fovea's surroundings, is transposed or lacks a weight,
    /// and a surface that is left out or coloured otherwise in the fovea alone.
    #[test]
    fn shape_is_that_of_the_whole_image(
        scene in scene(), at in near(middle()), level in 0.2..3.0,
    ) {
        // Also from farther and nearer than usual.
        let mut camera = looking_at(&at);
        camera.position = at + (camera.position - at) * level;
        let image = render_rgb(&scene, &camera);
        for (k, value) in shape_of(&scene, &camera).into_iter().enumerate() {
            prop_assert!((f64::from(value) - block(&image, k)).abs() < 1e-6, "block {k}");
            prop_assert!((0.0..=1.0).contains(&value));
        }
    }

    /// Catches a picture that is made in another way than the shape.
    #[test]
    fn pictures_are_those_of_the_whole_image(scene in scene(), at in near(middle())) {
        let camera = looking_at(&at);
        let image = render_rgb(&scene, &camera);
        let (picture, edges) = (foveal_picture(&scene, &camera), foveal_edges(&scene, &camera));
        for (x, y, pixel) in picture.enumerate_pixels() {
            let (i, j) = (FIRST + x, FIRST + y);
            prop_assert_eq!(pixel, image.get_pixel(i, j));
            let level = 255.0 * sobel(&image, i, j);
            prop_assert!((f64::from(edges.get_pixel(x, y).0[0]) - level).abs() < 0.501);
        }
        let shape = shape_of(&scene, &camera);
        for (value, pixel) in shape.iter().zip(shape_picture(&shape).pixels()) {
            prop_assert!((f32::from(pixel.0[0]) - 255.0 * value).abs() < 0.501);
        }
    }

    /// What is behind a lid makes no edge: not within the lid, nor, if the lid
    /// covers all, anywhere. Catches edges of depth instead of light, and a
    /// piece that is drawn over a nearer one.
    #[test]
    fn what_is_hidden_makes_no_edge(scene in scene(), edge in -0.02..0.02) {
        let camera = looking_at(&middle());
        let lid = slab([edge, -1.0], [1.0, 1.0], 0.15, plain(120));
        let lidded: Vec<_> = scene.iter().cloned().chain([lid]).collect();
        let all = slab([-1.0; 2], [1.0; 2], 0.16, plain(120));
        let covered: Vec<_> = lidded.iter().cloned().chain([all]).collect();
        prop_assert_eq!(shape_of(&covered, &camera), [0.0; SHAPE_LEN]);
        let picture = foveal_picture(&lidded, &camera);
        let lid = *picture.get_pixel(EDGE - 1, 0);
        let edges = foveal_edges(&lidded, &camera);
        for (x, y) in (1..EDGE - 1).flat_map(|x| (1..EDGE - 1).map(move |y| (x, y))) {
            let within = (0..9).all(|k| *picture.get_pixel(x + k % 3 - 1, y + k / 3 - 1) == lid);
            prop_assert!(!within || edges.get_pixel(x, y).0[0] == 0);
        }
    }
}

#[test]
fn an_even_image_has_no_edges() {
    for level in [0, 1, 100, 254, 255] {
        let camera = looking_at(&Vector3::new(0.1, 0.2, 0.0));
        assert_eq!(shape_of(&[table(level)], &camera), [0.0; SHAPE_LEN]);
    }
}

/// A step of luminance Y gives 4 Y in each of the two pixels beside it, so
/// Y / √2, and n such pixels in a block of three n / 3 of that. Catches an
/// exchange of rows and columns, a shift by a pixel, and another scale.
#[test]
fn straight_edges_have_their_closed_form() {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.rest());
    for (across, first) in [
        (0, 290_usize),
        (0, 291),
        (0, 292),
        (1, 290),
        (1, 291),
        (1, 292),
    ] {
        // From column or row `first` on, as seen from 20 cm: left and above of
        // the middle, so that no side of the slab is seen.
        let from = (first as f64 - 315.0) / camera.focal_px * 0.20;
        let (mut low, mut high) = ([-1.0, -0.9], [1.0, 1.1]);
        if across == 0 {
            low[0] = from;
        } else {
            high[1] = 0.10 - from;
        }
        let scene = [table(60), slab(low, high, 0.05, plain(230))];
        let image = render_rgb(&scene, &camera);
        let step = luminance(&image, 320, 320) - luminance(&image, FIRST, FIRST);
        assert!(step > 0.4, "{step}");
        for (k, value) in shape_of(&scene, &camera).into_iter().enumerate() {
            let block = [k % FOVEA_BLOCKS, k / FOVEA_BLOCKS][across];
            let pixels = (0..3).map(|p| FIRST as usize + 3 * block + p);
            let beside = pixels.filter(|p| [first - 1, first].contains(p)).count();
            let expected = step / 2.0_f64.sqrt() * beside as f64 / 3.0;
            assert!(
                (f64::from(value) - expected).abs() < 1e-6,
                "{first}: {k}, {value}"
            );
        }
    }
}

/// A ball in the middle is a ring of radius f tan(asin(r / d)) about the eye's
/// axis, 32 pixels from the fovea's left and upper border. Catches a fovea
/// beside the axis and another field of view.
#[test]
fn a_ball_is_a_ring() {
    for (diameter, expected) in [(0.024, 8.4), (0.06, 21.1)] {
        let way = Vector3::new(0.25, 0.35, -0.9).normalize();
        let centre = Vector3::new(0.0, 0.10, 0.25) + way * 0.26;
        let camera = looking_at(&centre);
        let scene = [Primitive::target(centre, 0.5 * diameter), table(240)];
        let radius = camera.focal_px * (0.5 * diameter / 0.26_f64).asin().tan();
        assert!((radius - expected).abs() < 0.1, "{radius}");
        let edges = foveal_edges(&scene, &camera);
        for k in 0..64 {
            let angle = f64::from(k) * std::f64::consts::TAU / 64.0;
            let at = |r: f64| [r * angle.cos(), r * angle.sin()].map(|c| (32.0 + c) as u32);
            let strength = |r: f64| edges.get_pixel(at(r)[0], at(r)[1]).0[0];
            let radii = (8..120).map(|step| 0.25 * f64::from(step));
            let peak = radii.clone().map(strength).max().unwrap();
            let ring: Vec<_> = radii.filter(|r| strength(*r) == peak).collect();
            let found = ring.iter().sum::<f64>() / ring.len() as f64;
            assert!((found - radius).abs() < 1.5, "{found}, not {radius} at {k}");
            assert!(peak > 80, "{peak}");
        }
    }
}

/// The image of a ball in the middle stays as it is in a quarter turn and a
/// mirror about the eye's axis.
#[test]
fn a_ball_in_the_middle_has_fourfold_symmetry() {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let centre = Vector3::new(0.0, 0.10, -0.01);
    let scene = [Primitive::target(centre, 0.03), table(240)];
    let picture = foveal_picture(&scene, &eye.camera(eye.rest()));
    let red = |x: u32, y: u32| is_red(picture.get_pixel(x, y).0);
    for (x, y) in (1..EDGE).flat_map(|x| (1..EDGE).map(move |y| (x, y))) {
        assert_eq!(red(x, y), red(EDGE - y, x), "turned at {x}, {y}");
        assert_eq!(red(x, y), red(EDGE - x, y), "mirrored at {x}, {y}");
    }
}

/// Whatever the eye's own pixels, the fovea is that of 630. Catches a fovea
/// that is 63 pixels of any image.
#[test]
fn fovea_does_not_depend_on_the_eyes_pixels() {
    let scene = eye_scene::grasping(0.06);
    let expected = shape_of(&scene, &looking_at(&eye_scene::grasped()));
    assert!(expected.iter().filter(|value| **value > 0.1).count() > 40);
    for pixels in [8, 126, 1260, 4096] {
        let config = EyeConfig {
            pixels,
            ..EyeConfig::helmholtz()
        };
        let eye = Eye::new(config).unwrap();
        let shape = shape_of(&scene, &eye.camera(eye.fixate(&eye_scene::grasped())));
        for (value, expected) in shape.iter().zip(expected) {
            assert!(
                (value - expected).abs() < 1e-3,
                "{pixels}: {value}, not {expected}"
            );
        }
    }
}
