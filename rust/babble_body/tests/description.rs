//! The robot as plain data, against what moves and against parry's mass properties.

mod grasping;

use std::collections::HashSet;

use babble_body::config::Fingers;
use babble_body::description::{self, LinkDescription};
use babble_body::geometry::mass::MassProperties;
use babble_body::geometry::solid::Solid;
use babble_body::{Body, Dynamics, PlanarArm, Robot};
use babble_eye::Shape;
use grasping::{DT, FAR, setup};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use parry3d::mass_properties::MassProperties as ParryMass;
use parry3d::math::Vector;
use proptest::prelude::*;

fn point() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-0.2..0.2_f64).prop_map(Vector3::from)
}

fn solid() -> impl Strategy<Value = Solid> {
    let capsule = (point(), point(), 0.003..0.05_f64)
        .prop_filter("a capsule is long", |(a, b, _)| (b - a).norm() > 1e-3)
        .prop_map(|(a, b, radius)| Solid::Capsule { a, b, radius });
    let cuboid =
        (point(), prop::array::uniform3(0.005..0.1_f64)).prop_map(|(centre, half)| Solid::Cuboid {
            centre,
            half: half.into(),
        });
    prop_oneof![capsule, cuboid]
}

/// The same by parry.
fn reference(solid: &Solid, density: f64) -> ParryMass {
    let vector = |v: &Vector3<f64>| Vector::new(v.x as f32, v.y as f32, v.z as f32);
    match solid {
        Solid::Capsule { a, b, radius } => {
            ParryMass::from_capsule(density as f32, vector(a), vector(b), *radius as f32)
        }
        Solid::Cuboid { centre, half } => {
            let mut properties = ParryMass::from_cuboid(density as f32, vector(half));
            properties.local_com = vector(centre);
            properties
        }
    }
}

fn agree(ours: &MassProperties, theirs: &ParryMass) -> Result<(), TestCaseError> {
    let mass = f64::from(theirs.mass());
    prop_assert!(
        (ours.mass / mass - 1.0).abs() < 1e-5,
        "{} {mass}",
        ours.mass
    );
    let centre = Vector3::from(theirs.local_com.to_array().map(f64::from));
    prop_assert!((ours.centre - centre).norm() < 1e-6);
    let tensor = theirs.reconstruct_inertia_matrix().to_cols_array();
    let tensor = Matrix3::from_iterator(tensor.map(f64::from));
    let error = (ours.inertia - tensor).norm() / tensor.norm();
    // parry adds in single precision, and keeps the tensor as roots of its inverse.
    prop_assert!(error < 1e-3, "{} {tensor}", ours.inertia);
    Ok(())
}

proptest! {
    /// Catches a capsule without its round ends or with ends that are balls of their own, a
    /// diagonal for a turned capsule, and half an edge for a whole one.
    #[test]
    fn solids_weigh_what_parry_says(solid in solid(), density in 1.0..1e4_f64) {
        agree(&MassProperties::of(&solid, density), &reference(&solid, density))?;
    }

    /// Catches a sum that forgets how far its parts are apart, or adds it with the wrong sign.
    #[test]
    fn sums_weigh_what_parry_says(solids in prop::collection::vec(solid(), 1..5)) {
        let ours = MassProperties::sum(solids.iter().map(|solid| MassProperties::of(solid, 1100.0)));
        let theirs = solids.iter().map(|solid| reference(solid, 1100.0)).reduce(|a, b| a + b);
        agree(&ours, &theirs.unwrap())?;
    }
}

/// The hand out of line: a bent wrist, a thumb to the side, two fingers that leave the plane.
fn bent() -> Body {
    let mut body = Body::paper();
    for (joint, angle) in [
        ("wrist_flexion", 20.0),
        ("thumb_1", 60.0),
        ("index_pivot", 15.0),
        ("little_pivot", -15.0),
    ] {
        body.joints.get_mut(joint).unwrap().locked_deg = Some(angle);
    }
    body.arm.density_kg_m3 = 5000.0;
    body.validate().unwrap();
    body
}

/// The two links of reaching weigh what the equation of motion has. Catches a centre from the wrong
/// end, a moment about the joint for one about the centre, and bones on the wrong link.
#[test]
fn reaching_weighs_what_moves() {
    for body in [Body::paper(), Body::icub(), bent()] {
        let inertia = *Dynamics::new(&body, &PlanarArm::new(&body)).inertia();
        let [upper, fore] = description::reaching(&body);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(upper.inertia.mass, inertia.upper_mass);
        close(fore.inertia.mass, inertia.fore_mass);
        close(upper.inertia.centre.x, inertia.upper_centre);
        close(fore.inertia.centre.x, inertia.fore_centre[0]);
        close(fore.inertia.centre.y, inertia.fore_centre[1]);
        for (link, moment) in [(&upper, inertia.upper), (&fore, inertia.fore)] {
            let MassProperties {
                mass,
                centre,
                inertia,
            } = link.inertia;
            close(inertia[(2, 2)] + mass * centre.xy().norm_squared(), moment);
            // A rigid body's: no moment exceeds the sum of the others.
            let moments = inertia.symmetric_eigenvalues();
            assert!(
                2.0 * moments.max() <= moments.sum() && moments.min() > 0.0,
                "{moments}"
            );
        }
    }
}

/// The bones out of which reaching's forearm is made sum to its whole inertia, not to its moment
/// about the vertical alone. Catches a palm that lies flat, and rods that are thin.
#[test]
fn reaching_is_made_of_cylinders_and_a_box() {
    let body = Body::paper();
    let [_, fore] = description::reaching(&body);
    let density = body.arm.density_kg_m3 as f32;
    let cylinder = |a: [f64; 3], length: f64, radius: f64| {
        let mut rod = ParryMass::from_cylinder(density, length as f32 / 2.0, radius as f32);
        // parry's cylinders lie along y.
        rod.principal_inertia_local_frame =
            parry3d::math::Rotation::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        rod.local_com = Vector::new((a[0] + length / 2.0) as f32, a[1] as f32, a[2] as f32);
        rod
    };
    let mut palm = ParryMass::from_cuboid(density, Vector::new(0.0275, 0.01, 0.03));
    palm.local_com = Vector::new(0.13 + 0.0275, 0.0, 0.0);
    let fingers = [-1.5, -0.5, 0.5, 1.5].map(|i| cylinder([0.185, 0.0, 0.015 * i], 0.061, 0.006));
    let whole = fingers.into_iter().fold(palm, |sum, finger| sum + finger)
        + cylinder([0.0; 3], 0.13, 0.01)
        + cylinder([0.13, 0.0, 0.0], 0.071, 0.006);
    agree(&fore.inertia, &whole).unwrap();
}

/// Where each link is: its frame in the world.
fn placed(
    links: &[LinkDescription],
    angle: impl Fn(&LinkDescription) -> f64,
) -> Vec<Isometry3<f64>> {
    let mut frames: Vec<Isometry3<f64>> = Vec::new();
    for link in links {
        let sense = if link.clockwise { -1.0 } else { 1.0 };
        let turn = Vector3::z() * (link.direction + sense * angle(link));
        let own = Isometry3::from_parts(
            Translation3::from(Vector3::from(link.origin)),
            UnitQuaternion::from_scaled_axis(turn),
        );
        let parent = link
            .parent
            .map_or(Isometry3::identity(), |parent| frames[parent]);
        frames.push(parent * own);
    }
    frames
}

proptest! {
    /// A reader of the description finds every solid where the engine has it. Catches a joint that
    /// turns the wrong way, a place in the wrong frame, links out of order and lost solids.
    #[test]
    fn solids_are_where_the_engine_has_them(
        q1 in -1.3..3.1_f64, q2 in 0.1..2.2_f64, thumb in 0.0..1.5_f64, finger in 0.0..1.5_f64,
        independent: bool,
    ) {
        let mut body = Body::paper();
        if independent {
            body.grip.fingers = Fingers::Independent;
        }
        let robot = Robot::new(&body, DT);
        let mut scene = Vec::new();
        robot.push_visible(&robot.world(&setup([q1, q2, thumb, finger], FAR)), &mut scene);
        let links = robot.description();
        let frames = placed(&links, |link| match link.joint.as_str() {
            "shoulder" => q1,
            "elbow" => q2,
            joint if joint.starts_with("thumb") => thumb,
            _ => finger,
        });
        let solids = links.iter().zip(&frames).flat_map(|(link, frame)| {
            link.solids.iter().map(move |named| (frame, &named.solid))
        });
        let at = |frame: &Isometry3<f64>, point: &Vector3<f64>| (frame * Point3::from(*point)).coords;
        prop_assert_eq!(solids.clone().count(), scene.len());
        for ((frame, solid), seen) in solids.zip(&scene) {
            let error = match (solid, &seen.shape) {
                (Solid::Capsule { a, b, radius }, Shape::Capsule { a: c, b: d, radius: r }) => {
                    (at(frame, a) - c).norm() + (at(frame, b) - d).norm() + (radius - r).abs()
                }
                (Solid::Cuboid { centre, half }, Shape::Cuboid { centre: c, rotation, half_extents }) => {
                    let turn = frame.rotation.to_rotation_matrix().into_inner() - rotation;
                    (at(frame, centre) - c).norm() + (half - half_extents).norm() + turn.norm()
                }
                (ours, theirs) => panic!("{ours:?} {theirs:?}"),
            };
            prop_assert!(error < 1e-5, "{error} m");
        }
    }
}

/// Names tell links, joints and solids apart, and joints are named as the config names them.
#[test]
fn names_are_unique() {
    let mut body = Body::paper();
    let mut all = vec![description::reaching(&body).to_vec()];
    for fingers in [Fingers::Virtual, Fingers::Independent] {
        body.grip.fingers = fingers;
        all.push(Robot::new(&body, DT).description());
    }
    for links in &all {
        let unique = |names: Vec<&String>| {
            assert_eq!(
                names.iter().collect::<HashSet<_>>().len(),
                names.len(),
                "{names:?}"
            );
        };
        unique(links.iter().map(|link| &link.name).collect());
        unique(links.iter().map(|link| &link.joint).collect());
        unique(
            links
                .iter()
                .flat_map(|link| &link.solids)
                .map(|solid| &solid.name)
                .collect(),
        );
    }
    let independent = all[2].iter().map(|link| &link.joint);
    assert!(
        independent
            .clone()
            .all(|joint| body.joints.contains_key(joint))
    );
    // The index is on top, as the skeleton has it.
    let height = |name: &str| {
        let link = all[2].iter().find(|link| link.name == name).unwrap();
        link.origin[2]
    };
    assert!(height("index_1") > height("middle_1") && height("middle_1") > height("ring_1"));
    assert!(height("ring_1") > height("little_1"));
}
