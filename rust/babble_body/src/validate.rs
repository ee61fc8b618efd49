//! Checks of a body's numbers, and that its parts fit together.

use crate::arm::PlanarArm;
use crate::config::{Body, Muscles};
use crate::error::{BodyError, within};
use crate::joints;
use crate::skeleton;

impl Body {
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
        validate_plane(self)?;
        validate_elbow(&PlanarArm::new(self))
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

/// The elbow must turn about the vertical and the fingertip lie in the plane of motion, or the
/// inverse kinematics of Sect. III-A does not exist; the obstacle must be as tall as the arm.
fn validate_plane(body: &Body) -> Result<(), BodyError> {
    const TOLERANCE_M: f64 = 1e-9;
    let (bones, tip) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, [0.0, 0.5]));
    if bones[0].b.z.abs() > TOLERANCE_M || body.joints["shoulder_roll"].locked_deg != Some(0.0) {
        return Err(BodyError::Geometry {
            problem:
                "shoulder_pitch and shoulder_roll must be locked at 0: the arm moves in its plane"
                    .to_owned(),
        });
    }
    if tip.z.abs() > TOLERANCE_M {
        return Err(BodyError::Geometry {
            problem: format!(
                "the locked joints put the fingertip {:.4} m off the arm's plane",
                tip.z
            ),
        });
    }
    let half = body.obstacle.height_m / 2.0;
    let top = bones
        .iter()
        .flat_map(|bone| [bone.a.z.abs(), bone.b.z.abs()])
        .fold(0.0, f64::max);
    let top = top.max(body.hand.palm_height_m / 2.0);
    if top > half {
        return Err(BodyError::Geometry {
            problem: format!(
                "obstacle.height_m = {} must be at least {:.3}, so that arm and hand cannot pass above it",
                body.obstacle.height_m,
                2.0 * top
            ),
        });
    }
    Ok(())
}

/// The elbow must stay on one side, so that inverse kinematics has one branch (item 3).
fn validate_elbow(arm: &PlanarArm) -> Result<(), BodyError> {
    let (low, high) = (
        arm.lower[1] + arm.tip_angle,
        arm.upper_limit[1] + arm.tip_angle,
    );
    if low < 0.0 || high > std::f64::consts::PI {
        return Err(BodyError::Geometry {
            problem: format!(
                "the elbow's range puts the fingertip at {:.1}…{:.1}° from the upper arm; it must stay in \
                 0…180°, or inverse kinematics has two branches",
                low.to_degrees(),
                high.to_degrees()
            ),
        });
    }
    Ok(())
}
