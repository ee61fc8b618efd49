//! Arm and hand as plain data, for exporters: links, joints, muscles, masses and solids.

use nalgebra::Vector3;
use serde::Serialize;

use crate::arm::{Dynamics, PlanarArm, cross_section};
use crate::config::{Body, Muscles};
use crate::geometry::mass::MassProperties;
use crate::geometry::solid::Solid;
use crate::joints::ARM_JOINTS;
use crate::skeleton::{self, Bone, BoneKind};

/// A link, the joint that carries it, and the muscles of that joint.
///
/// All joints turn about the vertical. Vectors and the inertia are in the frame of the link, whose
/// origin is its joint and whose x axis runs along it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkDescription {
    /// Name of the link.
    pub name: String,
    /// Name of the joint.
    pub joint: String,
    /// Index of the link that it hangs on; none for the shoulder's fixed base.
    pub parent: Option<usize>,
    /// Place of the joint in the parent's frame \[m\].
    pub origin: [f64; 3],
    /// Direction of the link at zero in the parent's frame, counter-clockwise \[rad\].
    pub direction: f64,
    /// Whether the joint turns clockwise.
    pub clockwise: bool,
    /// Lowest and highest equilibrium point of the muscles \[rad\].
    pub range: [f64; 2],
    /// Whether the joint itself stops at the ends of that range, and not its equilibrium point alone.
    pub stops: bool,
    /// The muscles of Eq. 2.
    pub muscles: Muscles,
    /// Mass, its centre and its inertia.
    #[serde(flatten)]
    pub inertia: MassProperties,
    /// What can touch.
    pub solids: Vec<NamedSolid>,
}

/// A solid and its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedSolid {
    /// Name, which no other solid of the robot has.
    pub name: String,
    /// The solid \[m\].
    #[serde(flatten)]
    pub solid: Solid,
}

/// The arm as it reaches: upper arm, and forearm with its rigid hand.
///
/// Mass, its centre and the moment about the vertical are those of [`Dynamics`]. The solids are what
/// touches an obstacle: every bone with the arm's half-width.
#[must_use]
pub fn reaching(body: &Body) -> [LinkDescription; 2] {
    let arm = PlanarArm::new(body);
    let (bones, _) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, [0.0, 0.0]));
    let named: Vec<_> = bone_names().into_iter().zip(bones).collect();
    let (upper, fore) = named.split_at(1);
    let elbow = Vector3::new(arm.upper, 0.0, 0.0);
    let moments = *Dynamics::new(body, &arm).inertia();
    let link = |i: usize, named: &[(String, Bone)], origin: Vector3<f64>, moment: f64| {
        let placed = named
            .iter()
            .map(|(name, bone)| (name, moved(bone, -origin)));
        let mut inertia = MassProperties::sum(placed.clone().map(|(_, bone)| rod(body, &bone)));
        // The equation of motion's: the same but for bones that leave the plane, by some 1e-5 of it.
        inertia.inertia[(2, 2)] = moment - inertia.mass * inertia.centre.xy().norm_squared();
        LinkDescription {
            name: ["upper_arm", "forearm"][i].to_owned(),
            joint: ARM_JOINTS[i].to_owned(),
            parent: i.checked_sub(1),
            origin: origin.into(),
            direction: 0.0,
            clockwise: false,
            range: [arm.lower[i], arm.upper_limit[i]],
            stops: true,
            muscles: body.muscles,
            inertia,
            solids: placed
                .map(|(name, bone)| touching(body, name, &bone))
                .collect(),
        }
    };
    [
        link(0, upper, Vector3::zeros(), moments.upper),
        link(1, fore, elbow, moments.fore),
    ]
}

/// Names of the bones, in their order.
fn bone_names() -> Vec<String> {
    let digits = ["thumb", "index", "middle", "ring", "little"];
    let segments = ["pivot", "1", "2", "3"];
    let hand = digits
        .iter()
        .flat_map(|digit| segments.map(|segment| format!("{digit}_{segment}")));
    let arm = ["upper_arm", "forearm", "palm"].map(str::to_owned);
    arm.into_iter().chain(hand).collect()
}

fn moved(bone: &Bone, by: Vector3<f64>) -> Bone {
    Bone {
        a: bone.a + by,
        b: bone.b + by,
        ..*bone
    }
}

/// The bone as the equation of motion has it: with flat ends.
fn rod(body: &Body, bone: &Bone) -> MassProperties {
    let (section, beside) = cross_section(body, bone.kind);
    let above = match bone.kind {
        BoneKind::Palm => body.hand.palm_height_m * body.hand.palm_height_m / 12.0,
        _ => beside,
    };
    let length = (bone.b - bone.a).norm();
    let along = (bone.b - bone.a) / length;
    // An upright bone has no side of its own.
    let side = Vector3::z().cross(&along).try_normalize(1e-9);
    let side = side.unwrap_or_else(Vector3::y);
    let up = along.cross(&side);
    let mass = body.arm.density_kg_m3 * section * length;
    let square = |v: Vector3<f64>| v * v.transpose();
    let spread =
        square(along) * (length * length / 12.0) + square(side) * beside + square(up) * above;
    MassProperties::from_spread(mass, (bone.a + bone.b) / 2.0, spread * mass)
}

fn touching(body: &Body, name: &str, bone: &Bone) -> NamedSolid {
    NamedSolid {
        name: name.to_owned(),
        solid: Solid::Capsule {
            a: bone.a,
            b: bone.b,
            radius: body.arm.half_width_m,
        },
    }
}
