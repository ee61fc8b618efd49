//! The two bodies that come with the crate.

use babble_eye::EyeConfig;

use crate::config::{
    Arm, Body, ContactModel, Cylinder, EngineName, Fingers, Grip, Hand, Muscles, Object, Target,
};
use crate::joints::reaching_joints;

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
            joints: reaching_joints([-75.0, 180.0], [5.0, 130.0]),
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
            joints: reaching_joints([-10.0, 95.0], [15.0, 106.0]),
            eye: EyeConfig::fick(),
            obstacle: Cylinder {
                radius_m: 0.02,
                height_m: 0.12,
            },
            ..Self::paper()
        }
    }
}
