//! Every number of the body, with its unit and source.
//!
//! Sources: \[P\] the paper, \[A\] derived, \[F\] fitted to the paper's tables, \[C\] a free choice.

use serde::{Deserialize, Serialize};

use crate::arm::PlanarArm;
use crate::error::{BodyError, within};
use crate::joints::{self, Joints};
use crate::skeleton;
use babble_eye::EyeConfig;

/// The arm's two segments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// Length of the upper arm \[m\]; 0.15 \[P\].
    pub upper_arm_m: f64,
    /// Length of the forearm \[m\]; 0.13 \[P\].
    pub forearm_m: f64,
    /// Half-width of arm and hand \[m\]; 0.01 \[F\]. Larger touches obstacles earlier.
    pub half_width_m: f64,
    /// Density of arm and hand \[kg/m³\]; 1100 \[C\]. Hardly matters beside the muscles' damping.
    pub density_kg_m3: f64,
}

/// The hand's segments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// Length of the palm from the wrist to the fingers' pivots \[m\]; 0.055 \[C\].
    pub palm_m: f64,
    /// Height of the palm across the plane of motion \[m\]; 0.06 \[C\].
    pub palm_height_m: f64,
    /// Pivot segment and three phalanges of each finger \[m\]; 0.01, 0.02, 0.017, 0.014 \[P\].
    pub finger_m: [f64; 4],
    /// Pivot segment and three phalanges of the thumb \[m\]; 0.02, 0.02, 0.017, 0.014 \[P\].
    pub thumb_m: [f64; 4],
    /// Distance between neighbouring fingers \[m\]; 0.015 \[C\].
    pub finger_spacing_m: f64,
}

/// The muscles of Eq. 2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Muscles {
    /// Stiffness `K_P` \[N·m/rad\]; 50 \[P\].
    pub kp: f64,
    /// Damping `K_D` \[N·m·s/rad\]; 40 \[P\]. The arm's time constant is `kd / kp` seconds.
    pub kd: f64,
    /// Torque of an action of 1 in torque control \[N·m\]; 50 \[C\]. At most 1000 `kd`, which is a speed of
    /// 1000 rad/s.
    pub torque_max: f64,
}

/// Whether the four fingers flex as one or each for itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fingers {
    /// One "virtual finger" of three joints that carries the four fingers \[P\].
    Virtual,
    /// Twelve joints, which share the virtual finger's equilibrium point: the fingers envelop an
    /// object one by one. Costs about three times as much.
    Independent,
}

/// The hand as it grasps. Flexion is counted from the open hand; the paper's equilibrium points
/// are opening angles, EP = 90° − flexion \[F\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grip {
    /// Whether the fingers flex as one; `virtual` \[P\].
    pub fingers: Fingers,
    /// Where the thumb sits: along the forearm from the wrist, and towards the palm's side
    /// \[m\]; 0, 0.006 \[C\].
    pub thumb_base_m: [f64; 2],
    /// Direction of the open thumb, counter-clockwise from the forearm \[deg\]; 154.7, that is
    /// 2.7 rad \[C\]. Its four joints flex clockwise, against the fingers.
    pub thumb_direction_deg: f64,
    /// Lowest and highest flexion of every joint of thumb and fingers \[deg\]; 0 and 90 \[C\].
    pub flexion_deg: [f64; 2],
    /// Flexion that the enclosure reflex asks of thumb and fingers \[deg\]; 57 and 80 \[C\]. Less
    /// holds small objects loosely; with rapier, more ejects them.
    pub reflex_deg: [f64; 2],
    /// Muscles of shoulder and elbow; 200 and 200 \[P\], 200 N·m in torque control \[C\].
    pub arm_muscles: Muscles,
    /// Muscles of the hand's joints; 0.5, 0.5 and 0.5 N·m \[C\]. The paper's 200 and 200 crush or
    /// eject a light ball; the time constant, 1 s, is the same.
    pub hand_muscles: Muscles,
}

/// The red sphere to be grasped and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Object {
    /// Density \[kg/m³\]; 500 \[C\].
    pub density_kg_m3: f64,
    /// Coulomb friction between object and hand; 0.8 \[C\].
    pub friction: f64,
    /// Coulomb friction between object and support, at most that of the object; 0.5 \[C\].
    pub support_friction: f64,
    /// Damping of its motion \[1/s\]; 0.5 \[C\].
    pub linear_damping: f64,
    /// Damping of its rotation, which stands for rolling friction \[1/s\]; 20 \[C\].
    pub angular_damping: f64,
}

/// How hard surfaces are. Each contact is a spring and a damper, both implicit, and Coulomb friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactModel {
    /// Stiffness of a contact \[N/m\]; 20 000 \[C\].
    pub stiffness_n_m: f64,
    /// Damping of a contact divided by its stiffness: the time in which surfaces part when nothing
    /// presses them \[s\]; 0.013 \[C\].
    pub relaxation_s: f64,
    /// Sliding speed at which friction is 0.7 of its full force \[m/s\]; 0.0001 \[C\]. What seems to
    /// stick creeps at a fraction of it.
    pub stiction_m_s: f64,
}

/// What steps arm, hand and object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EngineName {
    /// Made for this robot: a tree of joints about the vertical, in double precision.
    Tree,
    /// rapier3d with settings of its own for contacts: the reference, some ten times slower. Its bits
    /// are those of one platform's maths library.
    Rapier,
}

/// The vertical cylinder in the way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Radius \[m\]; 0.035 \[F\] (body `icub`: 0.02 \[C\]).
    pub radius_m: f64,
    /// Height \[m\], half of it above the arm's plane; 0.12 \[C\].
    pub height_m: f64,
}

/// The red sphere to be reached. It is immaterial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Radius \[m\]; 0.012 \[C\].
    pub radius_m: f64,
}

/// The whole body and the things in its world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// What steps the world in grasping; `tree` \[C\].
    pub engine: EngineName,
    /// Upper arm and forearm.
    pub arm: Arm,
    /// Palm, thumb and fingers.
    pub hand: Hand,
    /// Ranges and locks of the 26 joints.
    pub joints: Joints,
    /// Stiffness and damping.
    pub muscles: Muscles,
    /// Camera and its frame.
    pub eye: EyeConfig,
    /// The obstacle.
    pub obstacle: Cylinder,
    /// The target of reaching.
    pub target: Target,
    /// The hand as it grasps.
    pub grip: Grip,
    /// What is grasped.
    pub object: Object,
    /// How hard surfaces are.
    pub contact: ContactModel,
}

impl Body {
    /// The body fitted to the paper's Table I: shoulder −75…180°, elbow 5…130° \[F\], camera in
    /// Helmholtz coordinates \[F\].
    #[must_use]
    pub fn paper() -> Self {
        Self {
            engine: EngineName::Tree,
            arm: Arm {
                upper_arm_m: 0.15,
                forearm_m: 0.13,
                half_width_m: 0.01,
                density_kg_m3: 1100.0,
            },
            hand: Hand {
                palm_m: 0.055,
                palm_height_m: 0.06,
                finger_m: [0.01, 0.02, 0.017, 0.014],
                thumb_m: [0.02, 0.02, 0.017, 0.014],
                finger_spacing_m: 0.015,
            },
            joints: joints::reaching_joints([-75.0, 180.0], [5.0, 130.0]),
            muscles: Muscles {
                kp: 50.0,
                kd: 40.0,
                torque_max: 50.0,
            },
            eye: EyeConfig::helmholtz(),
            obstacle: Cylinder {
                radius_m: 0.035,
                height_m: 0.12,
            },
            target: Target { radius_m: 0.012 },
            grip: Grip {
                fingers: Fingers::Virtual,
                thumb_base_m: [0.0, 0.006],
                thumb_direction_deg: 154.7,
                flexion_deg: [0.0, 90.0],
                reflex_deg: [57.0, 80.0],
                arm_muscles: Muscles {
                    kp: 200.0,
                    kd: 200.0,
                    torque_max: 200.0,
                },
                hand_muscles: Muscles {
                    kp: 0.5,
                    kd: 0.5,
                    torque_max: 0.5,
                },
            },
            object: Object {
                density_kg_m3: 500.0,
                friction: 0.8,
                support_friction: 0.5,
                linear_damping: 0.5,
                angular_damping: 20.0,
            },
            contact: ContactModel {
                stiffness_n_m: 20_000.0,
                relaxation_s: 0.013,
                stiction_m_s: 1e-4,
            },
        }
    }

    /// The iCub's joint ranges (shoulder −10…95°, elbow 15…106°), a pan-tilt head in Fick
    /// coordinates and a thinner obstacle \[C\].
    #[must_use]
    pub fn icub() -> Self {
        Self {
            joints: joints::reaching_joints([-10.0, 95.0], [15.0, 106.0]),
            eye: EyeConfig::fick(),
            obstacle: Cylinder {
                radius_m: 0.02,
                height_m: 0.12,
            },
            ..Self::paper()
        }
    }

    /// Checks every field and that the parts fit together.
    ///
    /// # Errors
    /// A [`BodyError`] that names the field, its value and its bound.
    pub fn validate(&self) -> Result<(), BodyError> {
        self.validate_lengths()?;
        within("arm.density_kg_m3", self.arm.density_kg_m3, 1.0, 1e5)?;
        validate_muscles("muscles", &self.muscles)?;
        self.validate_grasping()?;
        joints::validate(&self.joints)?;
        self.eye.validate()?;
        skeleton::validate_plane(self)?;
        PlanarArm::new(self).validate()
    }

    fn validate_grasping(&self) -> Result<(), BodyError> {
        let Self {
            grip,
            object,
            contact,
            ..
        } = self;
        validate_muscles("grip.arm_muscles", &grip.arm_muscles)?;
        validate_muscles("grip.hand_muscles", &grip.hand_muscles)?;
        let [open, closed] = grip.flexion_deg;
        for (field, value, low, high) in [
            ("grip.thumb_base_m[0]", grip.thumb_base_m[0], -0.1, 0.2),
            ("grip.thumb_base_m[1]", grip.thumb_base_m[1], -0.1, 0.1),
            (
                "grip.thumb_direction_deg",
                grip.thumb_direction_deg,
                0.0,
                180.0,
            ),
            ("grip.flexion_deg[0]", open, -45.0, 90.0),
            ("grip.flexion_deg[1]", closed, open + 1.0, 135.0),
            ("grip.reflex_deg[0]", grip.reflex_deg[0], open, closed),
            ("grip.reflex_deg[1]", grip.reflex_deg[1], open, closed),
            ("object.density_kg_m3", object.density_kg_m3, 1.0, 1e5),
            ("object.friction", object.friction, 0.0, 10.0),
            (
                "object.support_friction",
                object.support_friction,
                0.0,
                10.0,
            ),
            ("object.linear_damping", object.linear_damping, 0.0, 1e3),
            ("object.angular_damping", object.angular_damping, 0.0, 1e3),
            ("contact.stiffness_n_m", contact.stiffness_n_m, 10.0, 1e7),
            ("contact.relaxation_s", contact.relaxation_s, 0.0, 1.0),
            ("contact.stiction_m_s", contact.stiction_m_s, 1e-6, 0.1),
        ] {
            within(field, value, low, high)?;
        }
        // The last segment's round end is its tip.
        let radius = self.arm.half_width_m.min(0.4 * self.hand.finger_spacing_m);
        for (field, tip) in [
            ("hand.finger_m[3]", self.hand.finger_m[3]),
            ("hand.thumb_m[3]", self.hand.thumb_m[3]),
        ] {
            within(field, tip, radius + 1e-4, 1.0)?;
        }
        Ok(())
    }

    fn validate_lengths(&self) -> Result<(), BodyError> {
        let hand = &self.hand;
        let named = |name: &'static str, all: [f64; 4]| {
            all.into_iter()
                .enumerate()
                .map(move |(i, v)| (format!("hand.{name}[{i}]"), v))
        };
        let lengths = [
            ("arm.upper_arm_m".to_owned(), self.arm.upper_arm_m),
            ("arm.forearm_m".to_owned(), self.arm.forearm_m),
            ("arm.half_width_m".to_owned(), self.arm.half_width_m),
            ("hand.palm_m".to_owned(), hand.palm_m),
            ("hand.palm_height_m".to_owned(), hand.palm_height_m),
            ("hand.finger_spacing_m".to_owned(), hand.finger_spacing_m),
            ("obstacle.radius_m".to_owned(), self.obstacle.radius_m),
            ("obstacle.height_m".to_owned(), self.obstacle.height_m),
            ("target.radius_m".to_owned(), self.target.radius_m),
        ];
        let segments = named("finger_m", hand.finger_m).chain(named("thumb_m", hand.thumb_m));
        for (field, value) in lengths.into_iter().chain(segments) {
            within(&field, value, 1e-4, 1.0)?;
        }
        Ok(())
    }
}

/// Speed of a joint beyond which simulation says nothing of it \[rad/s\].
const FASTEST_RAD_S: f64 = 1e3;

fn validate_muscles(name: &str, muscles: &Muscles) -> Result<(), BodyError> {
    within(&format!("{name}.kp"), muscles.kp, 1e-3, 1e6)?;
    within(&format!("{name}.kd"), muscles.kd, 1e-3, 1e6)?;
    // The speed that the torque keeps up is FASTEST_RAD_S at most.
    let most = (FASTEST_RAD_S * muscles.kd).min(1e6);
    within(
        &format!("{name}.torque_max"),
        muscles.torque_max,
        1e-3,
        most,
    )
}
