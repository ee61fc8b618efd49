//! What the eye sees: rasteriser, red centroid and pictures.

mod eye_scene;

use babble_eye::{
    Eye, EyeConfig, EyeError, Material, Pinhole, Primitive, Shape, TOWARDS_KEY, draw_red_over,
    is_red, rasterise, red_centroid, render_rgb, render_rgb_into, render_smooth, third_person,
};
use eye_scene::caster::{blocked, cast};
use nalgebra::Vector3;
use proptest::prelude::*;

type V = Vector3<f64>;

/// The eye's image at a gaze, at a size that is no multiple of anything.
fn view(pan: f64, tilt: f64) -> Pinhole {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    eye.camera_sized(babble_eye::Gaze { pan, tilt }, 157)
        .middle(157, 131)
}

fn point(reach: f64) -> impl Strategy<Value = V> {
    [-reach..reach, -reach..reach, -0.08..0.40].prop_map(|[x, y, z]| Vector3::new(x, y + 0.1, z))
}

fn shape() -> impl Strategy<Value = Shape> {
    let radius = 0.004..0.06;
    prop_oneof![
        (point(0.5), radius.clone()).prop_map(|(centre, radius)| Shape::Sphere { centre, radius }),
        (point(0.5), point(0.5), radius.clone()).prop_map(|(a, b, radius)| Shape::Capsule {
            a,
            b,
            radius
        }),
        (point(0.5), point(0.5), radius).prop_map(|(a, b, radius)| Shape::Cylinder {
            a,
            b,
            radius
        }),
        (
            point(0.5),
            -3.0..3.0,
            -3.0..3.0,
            [0.005..0.06, 0.005..0.06, 0.005..0.06]
        )
            .prop_map(|(centre, about_z, about_x, half)| Shape::Cuboid {
                centre,
                rotation: eye_scene::turned(about_z, about_x),
                half_extents: Vector3::from(half),
            }),
    ]
}

/// Some solids, the second and fifth of them targets, over a ground.
fn scene() -> impl Strategy<Value = Vec<Primitive>> {
    proptest::collection::vec((shape(), any::<[u8; 3]>()), 1..9).prop_map(|shapes| {
        let ground = Shape::Ground {
            height: -0.15,
            centre: [0.05, 0.1],
            half_extents: [0.3, 0.5],
            cell: 0.07,
        };
        let mut scene = vec![Primitive::new(ground, Material::plain([190; 3]))];
        scene.extend(shapes.into_iter().enumerate().map(|(k, (shape, colour))| {
            let target = k == 1 || k == 4;
            Primitive::new(shape, Material { colour, target })
        }));
        scene
    })
}

fn gaze() -> impl Strategy<Value = (f64, f64)> {
    (-1.1..1.1, -1.1..1.1)
}

fn centroid_where(camera: &Pinhole, red: impl Fn(usize, usize) -> bool) -> Option<[f64; 2]> {
    let (mut count, mut x, mut y) = (0.0, 0.0, 0.0);
    for j in 0..camera.height {
        for i in (0..camera.width).filter(|i| red(*i, j)) {
            count += 1.0;
            x += i as f64 + 0.5;
            y += j as f64 + 0.5;
        }
    }
    (count > 0.0).then(|| [x / count, y / count])
}

/// Centroid over every pixel of the whole image.
fn whole_image_centroid(scene: &[Primitive], camera: &Pinhole) -> Option<[f64; 2]> {
    let raster = rasterise(scene, camera);
    centroid_where(camera, |i, j| {
        raster
            .primitive(i, j)
            .is_some_and(|index| scene[index].material.target)
    })
}

/// Centroid of the red pixels of the whole picture.
fn red_in_picture(scene: &[Primitive], camera: &Pinhole) -> Option<[f64; 2]> {
    let picture = render_rgb(scene, camera);
    centroid_where(camera, |i, j| {
        is_red(picture.get_pixel(i as u32, j as u32).0)
    })
}

/// A hand over a ball, with more fingers: each lies beside the ball \[4 cm\], points in a direction
/// \[rad\] and is some share of the way to the camera, or below the ball.
fn behind_fingers(across: f64, fingers: Vec<([f64; 2], f64, f64)>) -> (Vec<Primitive>, Pinhole) {
    let ball = eye_scene::grasped();
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&ball));
    let mut scene = eye_scene::grasping(across);
    scene.extend(fingers.into_iter().map(|([x, y], turn, lift)| {
        let middle = ball + (camera.position - ball) * lift + Vector3::new(x, y, 0.0) * 0.04;
        let half = Vector3::new(turn.cos(), turn.sin(), 0.2) * 0.03;
        let shape = Shape::Capsule {
            a: middle - half,
            b: middle + half,
            radius: 0.007,
        };
        Primitive::new(shape, Material::plain([240, 205, 160]))
    }));
    (scene, camera)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Catches a wrong root, a window or row that is too small, a surface cut
    /// at the wrong end. On an edge, a hundredth of a pixel may decide. At the
    /// outline of a round surface the root in its depth makes some 10⁻³ of the
    /// 10⁻⁷ that f32 rounds by.
    #[test]
    fn rasteriser_agrees_with_ray_caster(scene in scene(), (pan, tilt) in gaze()) {
        let camera = view(pan, tilt);
        let raster = rasterise(&scene, &camera);
        for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
            let (seen, depth) = (raster.primitive(i, j), f64::from(raster.depth(i, j)));
            let agrees = |du: f64, dv: f64| {
                let at = [i as f64 + 0.5 + du, j as f64 + 0.5 + dv];
                match (cast(&scene, &camera, at), seen) {
                    (Some((index, z)), Some(seen)) => {
                        index == seen && (z - depth).abs() < 5e-3 * z
                    }
                    (expected, seen) => expected.is_none() && seen.is_none(),
                }
            };
            let nudges = [(0.0, 0.0), (0.01, 0.0), (-0.01, 0.0), (0.0, 0.01), (0.0, -0.01)];
            prop_assert!(
                nudges.iter().any(|(du, dv)| agrees(*du, *dv)),
                "pixel ({i}, {j}): {seen:?} at {depth}, not {:?}",
                cast(&scene, &camera, [i as f64 + 0.5, j as f64 + 0.5])
            );
        }
    }

    /// Catches a centroid that misses an occluder or a part of the target.
    #[test]
    fn centroid_of_the_window_is_that_of_the_image(scene in scene(), (pan, tilt) in gaze()) {
        let camera = view(pan, tilt);
        prop_assert_eq!(red_centroid(&scene, &camera), whole_image_centroid(&scene, &camera));
    }

    #[test]
    fn picture_is_red_where_targets_are_seen(scene in scene(), (pan, tilt) in gaze()) {
        let camera = view(pan, tilt);
        prop_assert_eq!(red_centroid(&scene, &camera), red_in_picture(&scene, &camera));
    }

    /// A window that is too small, or off by a pixel, would lose or shift some of the red.
    #[test]
    fn red_drawn_over_a_picture_is_all_of_the_targets_alone(
        scene in scene(),
        over in scene(),
        (pan, tilt) in gaze(),
    ) {
        let camera = view(pan, tilt);
        let before = render_rgb(&scene, &camera);
        let mut after = before.clone();
        draw_red_over(&mut after, &over, &camera);
        let alone = render_rgb(&over, &camera);
        for ((after, before), alone) in after.pixels().zip(before.pixels()).zip(alone.pixels()) {
            prop_assert_eq!(after, if is_red(alone.0) { alone } else { before });
        }
        draw_red_over(&mut after, &[], &camera);
    }

    /// But where two surfaces have the same depth to the last bit.
    #[test]
    fn order_of_primitives_does_not_matter(scene in scene(), (pan, tilt) in gaze()) {
        let camera = view(pan, tilt);
        let reversed: Vec<_> = scene.iter().rev().cloned().collect();
        let [forwards, backwards] = [&scene, &reversed].map(|scene| rasterise(scene, &camera));
        let mut ties = 0;
        for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
            let other = backwards.primitive(i, j).map(|index| scene.len() - 1 - index);
            ties += u32::from(forwards.primitive(i, j) != other);
            prop_assert_eq!(forwards.depth(i, j), backwards.depth(i, j));
        }
        if ties == 0 {
            prop_assert_eq!(red_centroid(&scene, &camera), red_centroid(&reversed, &camera));
            prop_assert!(render_rgb(&scene, &camera) == render_rgb(&reversed, &camera));
        }
        prop_assert!(ties < 5, "{ties} pixels");
    }

    /// Ground is dark where a solid is between it and the key light, or below
    /// it on the same line. On a shadow's edge a tenth of a millimetre may
    /// decide.
    #[test]
    fn shadows_fall_where_the_light_is_blocked(scene in scene(), (pan, tilt) in gaze()) {
        let camera = view(pan, tilt);
        let (lit, shaded) = (render_rgb(&scene[..1], &camera), render_rgb(&scene, &camera));
        let raster = rasterise(&scene, &camera);
        let light = Vector3::from(TOWARDS_KEY).normalize();
        for (x, y, pixel) in shaded.enumerate_pixels() {
            if raster.primitive(x as usize, y as usize) != Some(0) {
                continue;
            }
            let z = f64::from(raster.depth(x as usize, y as usize));
            let image = [f64::from(x) + 0.5 - 78.5, 65.5 - f64::from(y) - 0.5];
            let ray = Vector3::new(image[0], image[1], camera.focal_px) / camera.focal_px;
            let foot = camera.position + camera.rotation.tr_mul(&(ray * z));
            let dark = pixel.0[0] < lit.get_pixel(x, y).0[0];
            let agrees = |dx, dy| {
                let from = Vector3::new(foot.x + dx, foot.y + dy, -0.15 + 1e-9);
                let above = blocked(&scene[1..], &from, &light);
                above == dark || dark && blocked(&scene[1..], &from, &-light)
            };
            let nudges = [(0.0, 0.0), (1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4)];
            prop_assert!(nudges.iter().any(|(dx, dy)| agrees(*dx, *dy)), "{foot}, dark: {dark}");
        }
    }

    /// Fingers across a ball 26 cm from the eye and around it, as in a grasp. Catches an
    /// occluder that is left out beside the ball or for its depth, and a ball
    /// that is counted where it is hidden.
    #[test]
    fn centroid_behind_a_hand_is_that_of_the_image(
        across in -0.08..0.08,
        fingers in proptest::collection::vec(([-1.0..1.0, -1.0..1.0], 0.0..3.2, -0.15..0.2), 0..12),
    ) {
        let (scene, camera) = behind_fingers(across, fingers);
        prop_assert_eq!(red_centroid(&scene, &camera), red_in_picture(&scene, &camera));
    }

    /// A lone ball, also across the border: rows in closed form.
    #[test]
    fn centroid_of_a_lone_ball_is_that_of_the_image(
        centre in point(0.9), radius in 0.001..0.2, (pan, tilt) in gaze(),
    ) {
        let (scene, camera) = ([Primitive::target(centre, radius)], view(pan, tilt));
        prop_assert_eq!(red_centroid(&scene, &camera), whole_image_centroid(&scene, &camera));
    }
}

/// A finger and the ball at the same depth in one pixel: the ball comes earlier in the scene, so it is
/// seen, by the reflex too. A fresh draw found it.
#[test]
fn centroid_breaks_ties_as_the_picture_does() {
    let finger = (
        [-0.176_748_061_478_128_85, 0.492_668_206_160_597_26],
        2.996_890_242_712_029_6,
        0.142_406_480_882_862_67,
    );
    let (scene, camera) = behind_fingers(0.048_866_383_030_076_12, vec![finger]);
    assert_eq!(
        red_centroid(&scene, &camera),
        red_in_picture(&scene, &camera)
    );
}

/// A ball's image is an ellipse with its centre at c z / (z² − r²), c = x, y,
/// which is farther out than the image of the ball's centre.
#[test]
fn centroid_is_the_centre_of_the_ellipse() {
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.rest());
    for (x, y) in [(0.0, 0.1), (0.2, 0.1), (-0.15, 0.3), (0.24, -0.15)] {
        let (centre, radius) = (Vector3::new(x, y, 0.0), 0.04);
        let scene = [Primitive::target(centre, radius)];
        let [u, v] = red_centroid(&scene, &camera).unwrap();
        let c = camera.camera_from_world(&centre);
        let stretch = camera.focal_px * c.z / (c.z * c.z - radius * radius);
        assert!((u - (315.0 + stretch * c.x)).abs() < 0.05, "{u}");
        assert!((v - (315.0 - stretch * c.y)).abs() < 0.05, "{v}");
        if x == 0.2 {
            assert!(u - camera.project(&centre).unwrap()[0] > 3.0);
        }
    }
}

#[test]
fn a_capsule_in_front_hides_the_target() {
    let target = Vector3::new(0.1, 0.2, 0.0);
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&target));
    let bar = |shift: f64, height: f64| {
        let ends = [-0.1, 0.1].map(|y| target + Vector3::new(shift, y, height));
        Primitive::new(
            Shape::Capsule {
                a: ends[0],
                b: ends[1],
                radius: 0.02,
            },
            Material::plain([200; 3]),
        )
    };
    let seen = |bar: Primitive| red_centroid(&[bar, Primitive::target(target, 0.012)], &camera);
    let free = red_centroid(&[Primitive::target(target, 0.012)], &camera);
    assert_eq!(seen(bar(-0.015, 0.05)), None);
    assert_eq!(seen(bar(0.0, -0.05)), free);
    // A large ball whose centre lies beyond the target.
    let away = (target - camera.position).normalize() * 0.08;
    let ball = Shape::Sphere {
        centre: target + away,
        radius: 0.1,
    };
    assert_eq!(seen(Primitive::new(ball, Material::plain([200; 3]))), None);
    // Half hidden from the left: what is left lies to the right of the middle.
    let half = seen(bar(-0.035, 0.05)).unwrap();
    assert!(half[0] > free.unwrap()[0] + 1.0, "{half:?}");
}

/// Catches pixels that are seen through the seams of a hand: between the parts
/// of a capsule, or between capsules that touch.
#[test]
fn a_hand_hides_a_ball_completely() {
    let ball = eye_scene::grasped();
    let eye = Eye::new(EyeConfig::helmholtz()).unwrap();
    let camera = eye.camera(eye.fixate(&ball));
    let [right, up] = [0, 1].map(|row| camera.rotation.row(row).transpose());
    let middle = ball + (camera.position - ball) * 0.4;
    let mut scene = vec![Primitive::target(ball, 0.03)];
    for k in -3..=3 {
        let finger = middle + right * 0.008 * f64::from(k);
        for joints in [[-0.03, -0.007], [-0.007, 0.006], [0.006, 0.03]] {
            let [a, b] = joints.map(|at| finger + up * at);
            let shape = Shape::Capsule {
                a,
                b,
                radius: 0.006,
            };
            scene.push(Primitive::new(shape, Material::plain([240, 205, 160])));
        }
    }
    assert_eq!(red_centroid(&scene, &camera), None);
    // Without the last bones of the fingers, the ball is seen beside them.
    let open = scene
        .iter()
        .enumerate()
        .filter(|(k, _)| *k == 0 || k % 3 != 0);
    let open: Vec<_> = open.map(|(_, primitive)| primitive.clone()).collect();
    assert!(red_centroid(&open, &camera).is_some());
}

#[test]
fn targets_behind_around_and_beside_the_camera() {
    let camera = view(0.0, 0.0);
    let at = |offset: [f64; 3], radius| {
        let centre = camera.position + Vector3::from(offset);
        red_centroid(&[Primitive::target(centre, radius)], &camera)
    };
    assert_eq!(at([0.0, 0.0, 0.2], 0.05), None, "behind");
    assert_eq!(at([0.0, 0.0, -0.02], 0.05), None, "around");
    assert_eq!(at([0.4, 0.0, -0.02], 0.05), None, "outside of the field");
    let above = at([0.0, 0.06, -0.01], 0.05).expect("across the camera's plane");
    assert!(above[1] < 40.0, "{above:?}: not its mirror image below");
    let [u, v] = at([0.06, 0.0, -0.01], 0.05).expect("across the camera's plane");
    assert!(u > 120.0 && (v - 65.5).abs() < 1e-9, "{u} {v}");
}

#[test]
fn a_capsule_around_the_camera_is_invisible() {
    let camera = view(0.0, 0.0);
    let capsule = Shape::Capsule {
        a: camera.position + Vector3::new(0.0, 0.0, 0.01),
        b: camera.position - Vector3::new(0.02, 0.0, 0.2),
        radius: 0.03,
    };
    let scene = [Primitive::new(capsule, Material::TARGET)];
    assert_eq!(red_centroid(&scene, &camera), None);
}

#[test]
fn direction_angles_and_ray_are_inverse() {
    let camera = view(0.4, -0.3);
    let point = Vector3::new(0.13, 0.22, -0.04);
    let ray = camera.ray(camera.direction_angles(&point));
    let way = (point - camera.position).normalize();
    assert!((ray - way).norm() < 1e-14);
}

#[test]
fn buffer_of_the_wrong_size_is_refused() {
    let camera = view(0.0, 0.0);
    let error = render_rgb_into(&[], &camera, &mut [0; 12]).unwrap_err();
    let expected = 157 * 131 * 3;
    assert_eq!(
        error,
        EyeError::BufferSize {
            found: 12,
            expected
        }
    );
}

/// The smooth picture is that at twice the pixels, averaged, also where the
/// number of rows is no multiple of a band's.
#[test]
fn smooth_picture_is_a_mean() {
    let scene = eye_scene::example();
    let camera = third_person(75, 51);
    let smooth = render_smooth(&scene, &camera);
    let fine = render_rgb(&scene, &camera.scaled(2));
    for (x, y, pixel) in smooth.enumerate_pixels() {
        for c in 0..3 {
            let level = |dx, dy| u16::from(fine.get_pixel(2 * x + dx, 2 * y + dy).0[c]);
            let mean = (level(0, 0) + level(1, 0) + level(0, 1) + level(1, 1) + 2) / 4;
            assert_eq!(u16::from(pixel.0[c]), mean, "({x}, {y})");
        }
    }
}

/// The whole reach and the eye lie well within the onlooker's frame.
#[test]
fn onlooker_sees_the_workspace() {
    let camera = third_person(480, 360);
    let reach = (0..12).map(|k| {
        let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
        Vector3::new(0.40 * angle.cos(), 0.40 * angle.sin(), 0.0)
    });
    for point in reach.chain([Vector3::new(0.0, 0.10, 0.28)]) {
        let [u, v] = camera.project(&point).unwrap();
        assert!(
            (5.0..475.0).contains(&u) && (5.0..355.0).contains(&v),
            "{point} at {u}, {v}"
        );
    }
}
