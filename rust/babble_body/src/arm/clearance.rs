//! Clearance between the whole arm and the vertical cylinder, without gaps in time.
//!
//! Arm and hand stay inside the cylinder's height, so the distance in space is the distance in the
//! plane of motion.

use nalgebra::Vector2;

use super::outline::Segment;
use super::planar_arm::{ArmPose, PlanarArm};
use crate::geometry::frame::unrotate;
use crate::geometry::obstacle::Obstacle;

impl Obstacle {
    /// Distance between the surfaces of obstacle and arm in posture `q` \[m\]; negative inside.
    #[must_use]
    pub fn clearance(&self, arm: &PlanarArm, q: [f64; 2]) -> f64 {
        self.clearance_at(arm, &arm.place(q))
    }

    /// [`Self::clearance`] for an arm whose pose is known.
    #[must_use]
    pub fn clearance_at(&self, arm: &PlanarArm, pose: &ArmPose) -> f64 {
        let upper = least_distance_squared(
            &arm.upper_segments,
            unrotate(self.centre, pose.upper_direction),
        );
        let fore = least_distance_squared(
            &arm.fore_segments,
            unrotate(self.centre - pose.elbow, pose.fore_direction),
        );
        upper.min(fore).sqrt() - self.radius - arm.half_width
    }

    /// First share in [0, 1] of the straight joint motion `from` → `to` at which the arm touches,
    /// to within a micrometre of clearance; none if it passes.
    ///
    /// `clearances` are those at `from` and `to`. A point of the arm moves by at most L on the way, so
    /// clearances d0 and d1 at the ends with d0 + d1 > L leave room for no touch in between;
    /// otherwise the halves are looked at (conservative advancement).
    #[must_use]
    pub fn first_touch(
        &self,
        arm: &PlanarArm,
        from: [f64; 2],
        to: [f64; 2],
        clearances: [f64; 2],
    ) -> Option<f64> {
        let [at_from, at_to] = clearances;
        if at_from <= 0.0 {
            return Some(0.0);
        }
        self.touch_between(arm, (from, at_from), (to, at_to), (0.0, 1.0))
    }

    fn touch_between(
        &self,
        arm: &PlanarArm,
        (from, d0): ([f64; 2], f64),
        (to, d1): ([f64; 2], f64),
        (s0, s1): (f64, f64),
    ) -> Option<f64> {
        const RESOLUTION_M: f64 = 1e-6;
        let length = sweep(arm, from, to);
        if d0 + d1 > length {
            return None;
        }
        if length < RESOLUTION_M {
            return (d1 <= 0.0).then_some(s1);
        }
        let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        let (d, s) = (self.clearance(arm, middle), 0.5 * (s0 + s1));
        let first = self.touch_between(arm, (from, d0), (middle, d), (s0, s));
        if first.is_some() || d <= 0.0 {
            return first.or(Some(s));
        }
        self.touch_between(arm, (middle, d), (to, d1), (s, s1))
    }
}

/// The most that any point of the arm can move between two postures \[m\].
#[inline]
#[must_use]
pub fn sweep(arm: &PlanarArm, from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).abs() * (arm.upper + arm.fore_radius)
        + (to[1] - from[1]).abs() * arm.fore_radius
}

fn least_distance_squared(segments: &[Segment], point: Vector2<f64>) -> f64 {
    segments
        .iter()
        .map(|segment| segment.distance_squared(point))
        .fold(f64::INFINITY, f64::min)
}

/// Watches a moving arm for its first touch of an obstacle.
///
/// Holds a lower bound of the clearance that shrinks by what the arm may have moved; distances are
/// queried only when the bound is used up.
#[derive(Debug, Clone, Copy)]
pub struct ContactWatch {
    obstacle: Option<Obstacle>,
    bound: f64,
    /// The posture at which the clearance was last queried, and that clearance.
    queried: ([f64; 2], f64),
}

impl ContactWatch {
    /// A watch over `obstacle`, if there is one, from posture `q` on.
    #[must_use]
    pub fn new(obstacle: Option<Obstacle>, arm: &PlanarArm, q: [f64; 2]) -> Self {
        let bound = obstacle.map_or(f64::INFINITY, |obstacle| obstacle.clearance(arm, q));
        Self {
            obstacle,
            bound,
            queried: (q, bound),
        }
    }

    /// Looks at the straight joint motion `from` → `to`: the share of it at which the arm first
    /// touches, or none.
    pub fn touch(&mut self, arm: &PlanarArm, from: [f64; 2], to: [f64; 2]) -> Option<f64> {
        self.bound -= sweep(arm, from, to);
        if self.bound > 0.0 {
            return None;
        }
        let obstacle = self.obstacle?;
        let before = match self.queried {
            (posture, clearance) if posture == from => clearance,
            _ => obstacle.clearance(arm, from),
        };
        self.bound = obstacle.clearance(arm, to);
        self.queried = (to, self.bound);
        obstacle.first_touch(arm, from, to, [before, self.bound])
    }
}
