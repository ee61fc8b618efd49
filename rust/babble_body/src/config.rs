//! Every number of the body, with its unit and source.
//!
//! Sources: \[P\] the paper, \[A\] derived from it, \[F\] fitted to its tables, \[C\] our choice.

use serde::{Deserialize, Serialize};

use crate::joints::Joints;
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
    /// Stiffness `K_P` \[N·m/rad\]; 50 \[P, unit C\].
    pub kp: f64,
    /// Damping `K_D` \[N·m·s/rad\]; 40 \[P, unit C\]. The arm's time constant is `kd / kp` seconds.
    pub kd: f64,
    /// Torque of an action of 1 in torque control \[N·m\]; 50 \[C\]. At most 1000 `kd`, which is a speed of
    /// 1000 rad/s.
    pub torque_max: f64,
}

/// How the four fingers follow the one command they share, the paper's "virtual finger" \[P\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fingers {
    /// One chain of three joints carries the four fingers \[C\].
    Virtual,
    /// Twelve joints: the fingers envelop an object one by one. A physics step costs 1.2 to 1.5 times
    /// as much.
    Independent,
}

/// The hand as it grasps. Flexion is counted from the open hand; the paper's equilibrium points
/// are opening angles, EP = 90° − flexion \[F\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grip {
    /// Whether the fingers flex as one; `virtual` \[C\].
    pub fingers: Fingers,
    /// Where the thumb sits: along the forearm from the wrist, and towards the palm's side
    /// \[m\]; 0, 0.006 \[C\].
    pub thumb_base_m: [f64; 2],
    /// Direction of the open thumb, counter-clockwise from the forearm \[deg\]; 154.7, that is
    /// 2.7 rad \[C\]. Its four joints flex clockwise, against the fingers.
    pub thumb_direction_deg: f64,
    /// Lowest and highest flexion of every joint of thumb and fingers \[deg\]; 0 and 90 \[C\].
    pub flexion_deg: [f64; 2],
    /// Flexion that the enclosure reflex asks of thumb and fingers \[deg\]; 57 and 80 \[C\]. That it asks
    /// for angles is Sect. IV-A's; Sect. IV speaks of constant torques. Less holds small objects loosely;
    /// with rapier, more ejects them.
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

/// The physics engine that steps arm, hand and object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(not(feature = "rapier"), serde(try_from = "KnownEngine"))]
pub enum EngineName {
    /// Made for this robot: a tree of joints about the vertical, in double precision.
    Tree,
    /// rapier3d with settings of its own for contacts: the reference, some ten times slower. Its bits
    /// depend on the platform's maths library. Needs the cargo feature `rapier`.
    #[cfg(feature = "rapier")]
    Rapier,
}

/// All engines that there are, so that a build without one can say so.
#[cfg(not(feature = "rapier"))]
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum KnownEngine {
    Tree,
    Rapier,
}

#[cfg(not(feature = "rapier"))]
impl TryFrom<KnownEngine> for EngineName {
    type Error = &'static str;

    fn try_from(engine: KnownEngine) -> Result<Self, Self::Error> {
        match engine {
            KnownEngine::Tree => Ok(Self::Tree),
            KnownEngine::Rapier => Err(
                "engine `rapier` is not part of this build, which has `tree` alone: compile it with the \
                 cargo feature `rapier`",
            ),
        }
    }
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
    /// The physics engine of grasping; `tree` \[C\].
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
