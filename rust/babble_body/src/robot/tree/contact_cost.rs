//! What a contact adds to the function that the solver minimises, and what it leaves in the mechanics.

use nalgebra::{Matrix3, Vector3};

use super::contact::Contact;
use super::factor::Velocities;
use super::model::Tree;
use crate::config;
use crate::robot::contact_slots::{SLOTS, SOLIDS};
use crate::robot::mechanics::MechanicalState;

/// A contact and the numbers of its cost.
pub(super) struct ContactCost {
    pub(super) contact: Contact,
    /// v̂ \[m/s\]
    aim: f64,
    /// 1/γ \[kg\]
    stiffness: f64,
    /// μ λ₀ \[N·s\]
    grip: f64,
    /// `v_s` \[m/s\]
    stiction: f64,
}

impl ContactCost {
    /// Impulse along the normal at a relative velocity \[N·s\].
    fn pressed(&self, relative: &Vector3<f64>) -> f64 {
        self.stiffness * (self.aim - self.contact.normal.dot(relative)).max(0.0)
    }

    /// Sliding velocity, and its smoothed speed \[m/s\].
    fn sliding(&self, relative: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let normal = &self.contact.normal;
        let along = relative - normal * normal.dot(relative);
        let speed = (along.norm_squared() + self.stiction * self.stiction).sqrt();
        (along, speed)
    }

    /// Impulse on the ball's side at a relative velocity \[N·s\].
    pub(super) fn impulse(&self, relative: &Vector3<f64>) -> Vector3<f64> {
        let (along, speed) = self.sliding(relative);
        self.contact.normal * self.pressed(relative) - along * (self.grip / speed)
    }

    /// How the impulse falls with the relative velocity \[kg\].
    pub(super) fn curvature(&self, relative: &Vector3<f64>) -> Matrix3<f64> {
        let normal = &self.contact.normal;
        let (along, speed) = self.sliding(relative);
        let rub = self.grip / speed;
        let press = if self.pressed(relative) > 0.0 {
            self.stiffness
        } else {
            0.0
        };
        let along = along / speed;
        Matrix3::from_diagonal_element(rub) + normal * normal.transpose() * (press - rub)
            - along * along.transpose() * rub
    }
}

impl Tree {
    pub(super) fn contact_costs(
        &self,
        mechanics: &MechanicalState,
        contacts: Vec<Contact>,
    ) -> Vec<ContactCost> {
        let config::ContactModel {
            stiffness_n_m,
            relaxation_s,
            stiction_m_s,
        } = self.contact;
        let cost = |contact: Contact| {
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
        };
        contacts.into_iter().map(cost).collect()
    }
}

/// Writes impulses and depths of the contacts into the state.
pub(super) fn note_contacts(
    mechanics: &mut MechanicalState,
    velocities: &Velocities,
    costs: &[ContactCost],
) {
    mechanics.impulses = [0.0; SLOTS];
    mechanics.hit = false;
    mechanics.depth = 0.0;
    for cost in costs {
        let pressed = cost.pressed(&cost.contact.relative(velocities));
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
