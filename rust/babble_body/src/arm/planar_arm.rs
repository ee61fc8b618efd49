//! Kinematics of the two joints that move in reaching.
//!
//! The hand is rigid, so the arm is a planar chain of the upper arm and one link from the elbow to
//! the fingertips.

use nalgebra::Vector2;

use super::outline::{Segment, TOLERANCE_M, merge};
use crate::config::Body;
use crate::geometry::frame::rotate;
use crate::skeleton::{self, BoneKind};

/// The arm in its plane: lengths, ranges and outline.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarArm {
    /// Length of the upper arm \[m\].
    pub upper: f64,
    /// Distance from elbow to fingertip \[m\].
    pub reach: f64,
    /// Direction of the fingertip in the forearm's frame \[rad\]; 0 for a straight wrist.
    pub tip_angle: f64,
    /// Lower ends of the joint ranges \[rad\].
    pub lower: [f64; 2],
    /// Upper ends of the joint ranges \[rad\].
    pub upper_limit: [f64; 2],
    /// Half-width of every segment \[m\].
    pub half_width: f64,
    /// Outline of the upper arm, in the frame of the shoulder.
    pub upper_segments: Vec<Segment>,
    /// Outline of forearm and hand, in the frame of the elbow.
    pub fore_segments: Vec<Segment>,
    /// Largest distance of a point of forearm and hand from the elbow \[m\].
    pub fore_radius: f64,
}

/// Where the arm is in its plane for a posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmPose {
    /// Position of the elbow \[m\].
    pub elbow: Vector2<f64>,
    /// Position of the fingertip \[m\].
    pub tip: Vector2<f64>,
    /// (cos, sin) of the upper arm's direction.
    pub upper_direction: Vector2<f64>,
    /// (cos, sin) of the forearm's direction.
    pub fore_direction: Vector2<f64>,
}

impl PlanarArm {
    /// Derives the planar arm from the skeleton of `body`.
    #[must_use]
    pub fn new(body: &Body) -> Self {
        let (bones, tip) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, [0.0, 0.0]));
        let elbow = Vector2::new(body.arm.upper_arm_m, 0.0);
        let outline = |of_upper_arm: bool, origin: Vector2<f64>| {
            let own = bones
                .iter()
                .filter(|bone| (bone.kind == BoneKind::UpperArm) == of_upper_arm);
            let flat = own.map(|bone| Segment {
                a: bone.a.xy() - origin,
                b: bone.b.xy() - origin,
            });
            // A bone that stands upright is a point of its neighbours.
            merge(
                flat.filter(|segment| (segment.b - segment.a).norm() > TOLERANCE_M)
                    .collect(),
            )
        };
        let fore_segments = outline(false, elbow);
        let tip = tip.xy() - elbow;
        let range = |name: &str| {
            let joint = &body.joints[name];
            (joint.lower_deg.to_radians(), joint.upper_deg.to_radians())
        };
        let ((shoulder_low, shoulder_high), (elbow_low, elbow_high)) =
            (range("shoulder"), range("elbow"));
        Self {
            upper: body.arm.upper_arm_m,
            reach: tip.norm(),
            tip_angle: libm::atan2(tip.y, tip.x),
            lower: [shoulder_low, elbow_low],
            upper_limit: [shoulder_high, elbow_high],
            half_width: body.arm.half_width_m,
            upper_segments: outline(true, Vector2::zeros()),
            fore_radius: fore_segments
                .iter()
                .map(|s| s.a.norm().max(s.b.norm()))
                .fold(0.0, f64::max),
            fore_segments,
        }
    }

    /// The same arm, reaching with another point of forearm or hand, given in the forearm's frame
    /// \[m\].
    #[must_use]
    pub fn with_tip(&self, tip: Vector2<f64>) -> Self {
        Self {
            reach: tip.norm(),
            tip_angle: libm::atan2(tip.y, tip.x),
            ..self.clone()
        }
    }

    /// Forward kinematics of posture `q` \[rad\].
    #[must_use]
    pub fn place(&self, q: [f64; 2]) -> ArmPose {
        let (s1, c1) = libm::sincos(q[0]);
        let (s12, c12) = libm::sincos(q[0] + q[1]);
        let elbow = Vector2::new(self.upper * c1, self.upper * s1);
        let fore_direction = Vector2::new(c12, s12);
        let (st, ct) = if self.tip_angle == 0.0 {
            (0.0, 1.0)
        } else {
            libm::sincos(self.tip_angle)
        };
        let tip = elbow
            + rotate(
                Vector2::new(self.reach * ct, self.reach * st),
                fore_direction,
            );
        ArmPose {
            elbow,
            tip,
            upper_direction: Vector2::new(c1, s1),
            fore_direction,
        }
    }

    /// Position of the fingertip for posture `q`.
    #[must_use]
    pub fn fingertip(&self, q: [f64; 2]) -> Vector2<f64> {
        self.place(q).tip
    }

    /// Inverse kinematics: the posture that puts the fingertip at `point`, or none where the arm is
    /// too short or too long. The joint ranges are not looked at; the shoulder's angle is the one
    /// nearest to the middle of its range.
    #[must_use]
    pub fn posture_at(&self, point: Vector2<f64>) -> Option<[f64; 2]> {
        let (l1, l2) = (self.upper, self.reach);
        let cos_elbow = (point.norm_squared() - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
        if cos_elbow.is_nan() || cos_elbow.abs() > 1.0 {
            return None;
        }
        let sin_elbow = (1.0 - cos_elbow * cos_elbow).sqrt();
        let elbow = libm::atan2(sin_elbow, cos_elbow) - self.tip_angle;
        // Angle of the point minus angle of the fingertip at shoulder 0, in one arctangent.
        let (along, across) = (l1 + l2 * cos_elbow, l2 * sin_elbow);
        let shoulder = libm::atan2(
            point.y * along - point.x * across,
            point.x * along + point.y * across,
        );
        Some([self.nearest_turn(shoulder), elbow])
    }

    /// Whether posture `q` lies inside the joint ranges.
    #[must_use]
    pub fn in_range(&self, q: [f64; 2]) -> bool {
        (0..2).all(|i| self.lower[i] <= q[i] && q[i] <= self.upper_limit[i])
    }

    /// `q` moved into the joint ranges.
    #[must_use]
    pub fn clamp(&self, q: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| q[i].clamp(self.lower[i], self.upper_limit[i]))
    }

    /// `q` as shares of the joint ranges.
    #[must_use]
    pub fn normalised(&self, q: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| (q[i] - self.lower[i]) / (self.upper_limit[i] - self.lower[i]))
    }

    /// The posture at the given shares of the joint ranges.
    #[must_use]
    pub fn denormalised(&self, share: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.lower[i] + share[i] * (self.upper_limit[i] - self.lower[i]))
    }

    /// Greatest distance of the fingertip from the shoulder \[m\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.upper + self.reach
    }

    fn nearest_turn(&self, angle: f64) -> f64 {
        use std::f64::consts::{PI, TAU};
        let middle = 0.5 * (self.lower[0] + self.upper_limit[0]);
        if angle < middle - PI {
            angle + TAU
        } else if angle > middle + PI {
            angle - TAU
        } else {
            angle
        }
    }
}
