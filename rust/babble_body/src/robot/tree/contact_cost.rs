//! What a contact adds to the function that the solver minimises, and what it leaves in the mechanics.

use nalgebra::{Matrix3, Vector3};

use super::contact::Contact;
use super::factor::Velocities;
use super::model::Tree;
use crate::config;
use crate::robot::contact_slots::{SLOTS, SOLIDS};
use crate::robot::mechanics::MechanicalState;

/// A contact and the numbers of its cost.
pub(super) struct ContactCost<'a> {
    pub(super) contact: Contact<'a>,
    /// v̂ \[m/s\]
    aim: f64,
    /// 1/γ \[kg\]
    stiffness: f64,
    /// μ λ₀ \[N·s\]
    grip: f64,
    /// `v_s` \[m/s\]
    stiction: f64,
}

/// How a contact moves: what its impulse and its curvature have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// Impulse along the normal \[N·s\].
    pressed: f64,
    /// Sliding velocity \[m/s\].
    along: Vector3<f64>,
    /// Its smoothed speed \[m/s\].
    speed: f64,
}

impl ContactCost<'_> {
    /// The motion at a relative velocity \[m/s\].
    pub(super) fn motion(&self, relative: &Vector3<f64>) -> Motion {
        let normal = &self.contact.normal;
        let closing = normal.dot(relative);
        let along = relative - normal * closing;
        Motion {
            pressed: self.stiffness * above_zero(self.aim - closing),
            along,
            speed: (along.norm_squared() + self.stiction * self.stiction).sqrt(),
        }
    }

    /// Impulse on the ball's side \[N·s\].
    pub(super) fn impulse(&self, motion: &Motion) -> Vector3<f64> {
        self.contact.normal * motion.pressed - motion.along * (self.grip / motion.speed)
    }

    /// How the impulse falls with the relative velocity \[kg\].
    pub(super) fn curvature(&self, motion: &Motion) -> Matrix3<f64> {
        let normal = &self.contact.normal;
        let rub = self.grip / motion.speed;
        let press = if motion.pressed > 0.0 {
            self.stiffness
        } else {
            0.0
        };
        let along = motion.along / motion.speed;
        Matrix3::from_diagonal_element(rub) + normal * normal.transpose() * (press - rub)
            - along * along.transpose() * rub
    }
}

impl Tree {
    /// A contact with the numbers of its cost.
    pub(super) fn contact_cost<'a>(
        &self,
        mechanics: &MechanicalState,
        contact: Contact<'a>,
    ) -> ContactCost<'a> {
        let config::ContactModel {
            stiffness_n_m,
            relaxation_s,
            stiction_m_s,
        } = self.contact;
        let time = if contact.depth > 0.0 {
            relaxation_s + self.dt
        } else {
            self.dt
        };
        let last = contact.slot.map_or(0.0, |slot| mechanics.impulses[slot]);
        ContactCost {
            aim: contact.depth / time,
            stiffness: self.dt * stiffness_n_m * (relaxation_s + self.dt),
            grip: contact.friction * last,
            stiction: stiction_m_s,
            contact,
        }
    }
}

/// The greater of a number and zero, without the call that `max` is in WebAssembly.
pub(super) const fn above_zero(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}

/// Writes impulses and depths of the contacts into the state.
pub(super) fn note_contacts(
    mechanics: &mut MechanicalState,
    velocities: &Velocities,
    costs: &[ContactCost<'_>],
) {
    mechanics.impulses = [0.0; SLOTS];
    mechanics.hit = false;
    mechanics.depth = 0.0;
    for cost in costs {
        let Motion { pressed, .. } = cost.motion(&cost.contact.relative(velocities));
        match cost.contact.slot {
            Some(slot) => {
                mechanics.impulses[slot] = pressed;
                if slot < SOLIDS {
                    mechanics.depth = mechanics.depth.max(cost.contact.depth);
                }
            }
            None => mechanics.hit |= pressed > 0.0,
        }
    }
}
