//! Where along the palm a ball lies or comes to lie.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::case::GraspCase;
use super::task::GraspTask;

impl GraspTask {
    /// Centre of a ball that lies against the palm of the arm in a posture \[rad\], so far from the wrist
    /// \[m\].
    #[must_use]
    pub fn along_palm(&self, arm: [f64; 2], radius: f64, wrist_m: f64) -> [f64; 2] {
        let tip = Vector2::new(self.wrist() + wrist_m, self.beside_palm(radius));
        self.arm.with_tip(tip).fingertip(arm).into()
    }

    /// How far from the wrist the object of a case meets the palm when the elbow alone bends from the start
    /// \[m\]; none if the elbow cannot bend so far, or the object does not meet the palm.
    #[must_use]
    pub fn palm_place(&self, case: &GraspCase) -> Option<f64> {
        /// What rounding adds to an angle \[rad\] at most.
        const NOTHING: f64 = 1e-9;
        let [shoulder, elbow] = case.start;
        let upper = Vector2::new(libm::cos(shoulder), libm::sin(shoulder)) * self.arm.upper;
        let from_elbow = Vector2::from(case.object) - upper;
        let side = self.beside_palm(case.radius());
        let along = libm::sqrt(from_elbow.norm_squared() - side * side);
        let wrist_m = along - self.wrist();
        let mut bent =
            libm::atan2(from_elbow.y, from_elbow.x) - libm::atan2(side, along) - shoulder;
        // The first time that it comes there from the start on.
        while bent < elbow - NOTHING {
            bent += TAU;
        }
        let met = (0.0..=self.config.body.hand.palm_m).contains(&wrist_m);
        (met && self.arm.in_range([shoulder, bent])).then_some(wrist_m)
    }

    /// From the elbow to the wrist \[m\].
    const fn wrist(&self) -> f64 {
        self.config.body.arm.forearm_m
    }

    /// From the palm's middle line to the centre of a ball against it \[m\].
    fn beside_palm(&self, radius: f64) -> f64 {
        self.config.body.arm.half_width_m + radius
    }
}
