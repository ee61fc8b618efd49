//! What a contact adds to the function that the solver minimises, and what it leaves in the world.

use nalgebra::{Matrix3, Vector3};

use super::contact::Contact;
use super::{Tree, Velocities};
use crate::config;
use crate::robot::touch::{SLOTS, SOLIDS};
use crate::robot::world::World;

/// A contact in the function that is minimised.
pub(super) struct Term {
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

impl Term {
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
    pub(super) fn terms(&self, world: &World, contacts: Vec<Contact>) -> Vec<Term> {
        let config::ContactModel {
            stiffness_n_m,
            relaxation_s,
            stiction_m_s,
        } = self.contact;
        let term = |contact: Contact| {
            let time = if contact.depth > 0.0 {
                relaxation_s + self.dt
            } else {
                self.dt
            };
            let last = contact.slot.map_or(0.0, |slot| world.impulses[slot]);
            Term {
                aim: contact.depth / time,
                stiffness: self.dt * stiffness_n_m * (relaxation_s + self.dt),
                grip: contact.friction * last,
                stiction: stiction_m_s,
                contact,
            }
        };
        contacts.into_iter().map(term).collect()
    }
}

/// Writes down what touched.
pub(super) fn note_contacts(world: &mut World, velocities: &Velocities, terms: &[Term]) {
    world.impulses = [0.0; SLOTS];
    world.hit = false;
    world.depth = 0.0;
    for term in terms {
        let pressed = term.pressed(&term.contact.relative(velocities));
        match term.contact.slot {
            Some(slot) => {
                world.impulses[slot] = pressed;
                if slot < SOLIDS {
                    world.depth = world.depth.max(term.contact.depth);
                }
            }
            None => world.hit |= pressed > 0.0,
        }
    }
}
