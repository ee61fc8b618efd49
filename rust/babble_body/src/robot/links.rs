//! The links of arm and hand as they grasp: which solid hangs on which joint.
//!
//! All joints turn about the vertical. At zero the arm lies along +x, the fingers are stretched and
//! the thumb is open.

use nalgebra::Vector3;

use crate::config::{Body, Fingers, Muscles};
use crate::geometry::mass::MassProperties;
use crate::geometry::solid::Solid;

/// The part of arm and hand whose contacts are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ContactRegion {
    /// Upper arm or forearm.
    Arm,
    /// The palm.
    Palm,
    /// A segment of the thumb.
    Thumb,
    /// A segment of a finger.
    Fingers,
}

/// Which of the four equilibrium points moves a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Muscle {
    Shoulder,
    Elbow,
    Thumb,
    Finger,
}

impl Muscle {
    /// Place in a posture of four.
    pub(super) const fn index(self) -> usize {
        self as usize
    }

    pub(super) const fn settings(self, body: &Body) -> Muscles {
        match self {
            Self::Shoulder | Self::Elbow => body.grip.arm_muscles,
            Self::Thumb | Self::Finger => body.grip.hand_muscles,
        }
    }
}

/// A link and the joint that carries it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link {
    /// The link that it hangs on; none for the shoulder's fixed base.
    pub(super) parent: Option<usize>,
    pub(super) muscle: Muscle,
    /// Place of the joint in the parent's frame \[m\].
    pub(super) origin: Vector3<f64>,
    /// Direction of the link at zero in the parent's frame, counter-clockwise \[rad\].
    pub(super) direction: f64,
    /// Whether the joint turns clockwise.
    pub(super) clockwise: bool,
    pub(super) solids: Vec<(ContactRegion, Solid)>,
}

impl Link {
    /// 1 if the joint turns counter-clockwise, −1 if clockwise.
    pub(super) const fn sense(&self) -> f64 {
        if self.clockwise { -1.0 } else { 1.0 }
    }

    /// Its mass, as the sum of its solids, which may overlap.
    pub(super) fn inertia(&self, density: f64) -> MassProperties {
        let solids = self.solids.iter();
        MassProperties::sum(solids.map(|(_, solid)| MassProperties::of(solid, density)))
    }
}

/// Forearm and palm.
pub(super) const FOREARM: usize = 1;

/// Length of the palm with the fingers' pivot segments, which do not flex \[m\].
pub(super) fn palm_length(body: &Body) -> f64 {
    body.hand.palm_m + body.hand.finger_m[0]
}

/// Radius of thumb and fingers \[m\]; bounded by the spacing of the fingers.
pub(super) fn digit_radius(body: &Body) -> f64 {
    body.arm.half_width_m.min(0.4 * body.hand.finger_spacing_m)
}

/// All links, each after the one that it hangs on.
pub(super) fn links(body: &Body) -> Vec<Link> {
    let mut links = vec![upper_arm(body), forearm(body)];
    let heights = [-1.5, -0.5, 0.5, 1.5].map(|i: f64| i * body.hand.finger_spacing_m);
    match body.grip.fingers {
        Fingers::Virtual => finger(&mut links, body, 0.0, &heights),
        Fingers::Independent => {
            for height in heights {
                finger(&mut links, body, height, &[0.0]);
            }
        }
    }
    thumb(&mut links, body);
    links
}

fn upper_arm(body: &Body) -> Link {
    Link {
        parent: None,
        muscle: Muscle::Shoulder,
        origin: Vector3::zeros(),
        direction: 0.0,
        clockwise: false,
        solids: vec![(
            ContactRegion::Arm,
            capsule(body.arm.upper_arm_m, 0.0, body.arm.half_width_m),
        )],
    }
}

fn forearm(body: &Body) -> Link {
    let (length, half_width) = (body.arm.forearm_m, body.arm.half_width_m);
    let half_palm = palm_length(body) / 2.0;
    let palm = Solid::Cuboid {
        centre: Vector3::new(length + half_palm, 0.0, 0.0),
        half: Vector3::new(half_palm, half_width, body.hand.palm_height_m / 2.0),
    };
    Link {
        parent: Some(0),
        muscle: Muscle::Elbow,
        origin: Vector3::new(body.arm.upper_arm_m, 0.0, 0.0),
        direction: 0.0,
        clockwise: false,
        solids: vec![
            (ContactRegion::Arm, capsule(length, 0.0, half_width)),
            (ContactRegion::Palm, palm),
        ],
    }
}

/// Three phalanges; each carries a capsule at every one of `heights`, relative to `height`.
fn finger(links: &mut Vec<Link>, body: &Body, height: f64, heights: &[f64]) {
    let knuckle = Vector3::new(body.arm.forearm_m + palm_length(body), 0.0, height);
    let base = Digit {
        part: ContactRegion::Fingers,
        muscle: Muscle::Finger,
        origin: knuckle,
        direction: 0.0,
        clockwise: false,
    };
    digit(
        links,
        &base,
        &body.hand.finger_m[1..],
        heights,
        digit_radius(body),
    );
}

fn thumb(links: &mut Vec<Link>, body: &Body) {
    let [along, aside] = body.grip.thumb_base_m;
    let base = Digit {
        part: ContactRegion::Thumb,
        muscle: Muscle::Thumb,
        origin: Vector3::new(body.arm.forearm_m + along, aside, 0.0),
        direction: body.grip.thumb_direction_deg.to_radians(),
        clockwise: true,
    };
    digit(links, &base, &body.hand.thumb_m, &[0.0], digit_radius(body));
}

/// Where a digit begins and how it flexes.
struct Digit {
    part: ContactRegion,
    muscle: Muscle,
    origin: Vector3<f64>,
    direction: f64,
    clockwise: bool,
}

fn digit(links: &mut Vec<Link>, base: &Digit, lengths: &[f64], heights: &[f64], radius: f64) {
    let mut parent = FOREARM;
    for (i, &length) in lengths.iter().enumerate() {
        // The last segment's round end is its tip.
        let reach = if i + 1 == lengths.len() {
            length - radius
        } else {
            length
        };
        let (origin, direction) = if i == 0 {
            (base.origin, base.direction)
        } else {
            (Vector3::new(lengths[i - 1], 0.0, 0.0), 0.0)
        };
        let solids = heights
            .iter()
            .map(|&height| (base.part, capsule(reach, height, radius)))
            .collect();
        links.push(Link {
            parent: Some(parent),
            muscle: base.muscle,
            origin,
            direction,
            clockwise: base.clockwise,
            solids,
        });
        parent = links.len() - 1;
    }
}

fn capsule(length: f64, height: f64, radius: f64) -> Solid {
    Solid::Capsule {
        a: Vector3::new(0.0, 0.0, height),
        b: Vector3::new(length, 0.0, height),
        radius,
    }
}
