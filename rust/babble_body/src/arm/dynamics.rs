//! Motion of the arm's two joints under its muscles, Eq. 2.
//!
//! The arm is light beside the muscles' damping, so the equation is stiff: an explicit step
//! diverges even at half a millisecond. With position and velocity taken at the end of the step,
//!
//! ```text
//! (M + dt·K_D + dt²·K_P) Δv = dt (K_P (q_des − q) − K_D v − dt·K_P v − C)
//! ```
//!
//! is stable at any step. M is the arm's inertia, C its Coriolis and centrifugal torque; gravity is
//! compensated (Sect. II-B).

use super::planar_arm::PlanarArm;
use crate::config::{Body, Muscles};
use crate::skeleton::{self, BoneKind};

/// Posture and joint speeds of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct ArmState {
    /// Joint angles \[rad\].
    pub q: [f64; 2],
    /// Joint speeds \[rad/s\].
    pub v: [f64; 2],
}

impl ArmState {
    /// At rest in posture `q`.
    #[must_use]
    pub const fn at_rest(q: [f64; 2]) -> Self {
        Self { q, v: [0.0; 2] }
    }
}

/// What pulls at the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pull {
    /// The muscles, towards an equilibrium point \[rad\].
    Towards([f64; 2]),
    /// Torques T = torque − `K_D` q̇ \[N·m\], whose torque is given.
    Torques([f64; 2]),
}

/// Masses, centres of mass and moments of inertia of the two links.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmInertia {
    /// Moment of the upper arm about the shoulder \[kg·m²\].
    pub upper: f64,
    /// Moment of forearm and hand about the elbow \[kg·m²\].
    pub fore: f64,
    /// Mass of forearm and hand \[kg\].
    pub fore_mass: f64,
    /// Mass of the upper arm \[kg\].
    pub upper_mass: f64,
    /// Centre of mass of the upper arm along its length \[m\].
    pub upper_centre: f64,
    /// Centre of mass of forearm and hand in the forearm's frame \[m\].
    pub fore_centre: [f64; 2],
}

/// The equations of motion of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    muscles: Muscles,
    inertia: ArmInertia,
    upper_length: f64,
    lower: [f64; 2],
    upper: [f64; 2],
}

impl Dynamics {
    /// Equations of motion of `body`.
    #[must_use]
    pub fn new(body: &Body, arm: &PlanarArm) -> Self {
        Self {
            muscles: body.muscles,
            inertia: inertia(body),
            upper_length: arm.upper,
            lower: arm.lower,
            upper: arm.upper_limit,
        }
    }

    /// Masses and moments, for references and exporters.
    #[must_use]
    pub const fn inertia(&self) -> &ArmInertia {
        &self.inertia
    }

    /// One step of `dt` \[s\] under a pull.
    #[inline]
    #[must_use]
    pub fn step(&self, state: ArmState, pull: Pull, dt: f64) -> ArmState {
        let (mass, coriolis) = self.mass_and_coriolis(state);
        let Muscles { kp, kd, .. } = self.muscles;
        let (torque, damping, diagonal) = match pull {
            Pull::Towards(q_des) => (
                [0, 1].map(|i| kp * (q_des[i] - state.q[i])),
                kd + dt * kp,
                dt * kd + dt * dt * kp,
            ),
            Pull::Torques(torque) => (torque, kd, dt * kd),
        };
        let rhs = [0, 1].map(|i| dt * (torque[i] - damping * state.v[i] - coriolis[i]));
        self.advance(state, mass, diagonal, rhs, dt)
    }

    /// Kinetic energy \[J\].
    #[must_use]
    pub fn kinetic_energy(&self, state: ArmState) -> f64 {
        let ([m11, m12, m22], _) = self.mass_and_coriolis(state);
        let [v1, v2] = state.v;
        0.5 * (m11 * v1 * v1 + 2.0 * m12 * v1 * v2 + m22 * v2 * v2)
    }

    /// M as (M11, M12, M22) and C.
    #[inline]
    fn mass_and_coriolis(&self, state: ArmState) -> ([f64; 3], [f64; 2]) {
        let ArmInertia {
            upper,
            fore,
            fore_mass,
            fore_centre: [cx, cy],
            ..
        } = self.inertia;
        let lever = fore_mass * self.upper_length;
        let (s, c) = libm::sincos(state.q[1]);
        let coupling = lever * (cx * c - cy * s);
        let h = -lever * (cx * s + cy * c);
        let m11 = upper + fore + fore_mass * self.upper_length * self.upper_length + 2.0 * coupling;
        let [v1, v2] = state.v;
        (
            [m11, fore + coupling, fore],
            [h * (2.0 * v1 * v2 + v2 * v2), -h * v1 * v1],
        )
    }

    #[inline]
    fn advance(
        &self,
        state: ArmState,
        mass: [f64; 3],
        diagonal: f64,
        rhs: [f64; 2],
        dt: f64,
    ) -> ArmState {
        let [a, b, d] = [mass[0] + diagonal, mass[1], mass[2] + diagonal];
        let determinant = a * d - b * b;
        let mut dv = [
            (d * rhs[0] - b * rhs[1]) / determinant,
            (a * rhs[1] - b * rhs[0]) / determinant,
        ];
        let end = |i: usize, dv: f64| state.q[i] + dt * (state.v[i] + dv);
        let stops = |i: usize, dv: f64| end(i, dv) < self.lower[i] || end(i, dv) > self.upper[i];
        // A joint at the end of its range stops there, inelastically: Δv = −v is then given, and
        // the other joint's row of the equation is solved with it.
        match [stops(0, dv[0]), stops(1, dv[1])] {
            [true, false] => dv[1] = (rhs[1] + b * state.v[0]) / d,
            [false, true] => dv[0] = (rhs[0] + b * state.v[1]) / a,
            _ => {}
        }
        let mut next = state;
        for i in 0..2 {
            next.q[i] = end(i, dv[i]).clamp(self.lower[i], self.upper[i]);
            next.v[i] = if stops(i, dv[i]) {
                0.0
            } else {
                state.v[i] + dv[i]
            };
        }
        next
    }
}

/// Sums the bones as solid rods of the body's density.
fn inertia(body: &Body) -> ArmInertia {
    let (bones, _) = skeleton::bones(body, &skeleton::joint_angles(&body.joints, [0.0, 0.0]));
    let mut total = ArmInertia {
        upper: 0.0,
        fore: 0.0,
        fore_mass: 0.0,
        upper_mass: 0.0,
        upper_centre: 0.0,
        fore_centre: [0.0; 2],
    };
    let elbow = nalgebra::Vector2::new(body.arm.upper_arm_m, 0.0);
    for bone in bones {
        let origin = if bone.kind == BoneKind::UpperArm {
            nalgebra::Vector2::zeros()
        } else {
            elbow
        };
        let (a, b) = (bone.a.xy() - origin, bone.b.xy() - origin);
        let (section, across) = cross_section(body, bone.kind);
        let mass = body.arm.density_kg_m3 * section * (bone.b - bone.a).norm();
        let moment = mass * ((a.norm_squared() + a.dot(&b) + b.norm_squared()) / 3.0 + across);
        let centre = (a + b) / 2.0;
        if bone.kind == BoneKind::UpperArm {
            total.upper += moment;
            total.upper_mass += mass;
            total.upper_centre = centre.x;
        } else {
            total.fore += moment;
            total.fore_centre[0] += mass * centre.x;
            total.fore_centre[1] += mass * centre.y;
            total.fore_mass += mass;
        }
    }
    total.fore_centre = total.fore_centre.map(|moment| moment / total.fore_mass);
    total
}

/// Area of a bone's cross-section \[m²\] and its mean square distance from the bone's line in the
/// plane of motion \[m²\]: a box for the palm, circles for the rest.
pub(crate) fn cross_section(body: &Body, kind: BoneKind) -> (f64, f64) {
    let half_width = body.arm.half_width_m;
    let radius = match kind {
        BoneKind::Palm => {
            let area = 2.0 * half_width * body.hand.palm_height_m;
            return (area, half_width * half_width / 3.0);
        }
        // A digit's radius is bounded by the spacing of the fingers.
        BoneKind::Thumb | BoneKind::Finger => half_width.min(0.4 * body.hand.finger_spacing_m),
        BoneKind::UpperArm | BoneKind::Forearm => half_width,
    };
    let square = radius * radius;
    (std::f64::consts::PI * square, square / 4.0)
}
