//! Velocities at the end of a step in which things touch.
//!
//! They are the least of a convex function, with `H v = b` the equations without contacts,
//!
//! ```text
//! ½ vᵀH v − bᵀv + Σ (1/2γ) max(0, v̂ − v_n)² + Σ μ λ₀ √(|v_t|² + v_s²)
//! ```
//!
//! A contact's normal impulse λ = max(0, v̂ − v_n)/γ is that of a spring of stiffness k and a damper
//! k τ at the end of the step: v̂ = d/(τ + dt), γ = 1/(dt k (τ + dt)) for a depth d; surfaces that are
//! apart may close their gap, v̂ = d/dt. Friction is Coulomb's with the normal impulse λ₀ of the last
//! step, which keeps the function convex without lifting what slides (Castro et al., *Irrotational
//! contact fields*, 2023); v_s smooths it at rest.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::contact::Contact;
use super::factor::BALL;
use super::{Equations, Tree, Velocities};
use crate::config;
use crate::robot::touch::{SLOTS, SOLIDS};
use crate::robot::world::World;

/// Newton steps at most; a handful is usual.
const MAX_STEPS: usize = 50;
/// The last step's gain, as a share of the energy of a ball at 1 m/s.
const TOLERANCE: f64 = 1e-12;

/// A contact in the function that is minimised.
pub(super) struct Term {
    contact: Contact,
    /// v̂ \[m/s\]
    aim: f64,
    /// 1/γ \[kg\]
    stiffness: f64,
    /// μ λ₀ \[N·s\]
    grip: f64,
    /// v_s \[m/s\]
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
    fn impulse(&self, relative: &Vector3<f64>) -> Vector3<f64> {
        let (along, speed) = self.sliding(relative);
        self.contact.normal * self.pressed(relative) - along * (self.grip / speed)
    }

    /// How the impulse falls with the relative velocity \[kg\].
    fn curvature(&self, relative: &Vector3<f64>) -> Matrix3<f64> {
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
        let config::Contact {
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

    /// Velocities at the end of the step.
    pub(super) fn with_contacts(
        &self,
        world: &World,
        equations: &Equations,
        free: Velocities,
        terms: &[Term],
    ) -> Velocities {
        if terms.is_empty() {
            return free;
        }
        let coupled = terms.iter().any(|term| term.contact.chain > 0);
        let rows = if coupled {
            self.sparsity.all()
        } else {
            self.sparsity.ball()
        };
        let mut velocities = free;
        self.begin(world, &rows, &mut velocities);
        let enough = TOLERANCE * self.mass(&world.ball);
        for _ in 0..MAX_STEPS {
            let step = self.newton_step(equations, &rows, &velocities, terms);
            let share = if step.gain <= enough {
                1.0
            } else {
                step.search()
            };
            for k in rows.clone() {
                velocities[k] += share * step.direction[k];
            }
            if step.gain <= enough {
                break;
            }
        }
        velocities
    }

    /// The last step's velocities, which a steady grasp keeps.
    fn begin(&self, world: &World, rows: &Range<usize>, velocities: &mut Velocities) {
        let ball = &world.ball;
        velocities[..3].copy_from_slice(ball.velocity.as_slice());
        velocities[3..BALL].copy_from_slice(ball.spin.as_slice());
        if rows.end > BALL {
            velocities[BALL..rows.end].copy_from_slice(&world.v[..rows.end - BALL]);
        }
    }

    fn newton_step<'a>(
        &self,
        equations: &Equations,
        rows: &Range<usize>,
        velocities: &Velocities,
        terms: &'a [Term],
    ) -> NewtonStep<'a> {
        let mut slopes = self.sparsity.product(&equations.matrix, velocities, rows);
        for k in rows.clone() {
            slopes[k] -= equations.rhs[k];
        }
        let residual = slopes;
        let mut matrix = equations.matrix;
        let mut points = Vec::with_capacity(terms.len());
        for term in terms {
            let relative = term.contact.relative(velocities);
            term.contact.apply(&-term.impulse(&relative), &mut slopes);
            term.contact.add(&term.curvature(&relative), &mut matrix);
            points.push((term, relative));
        }
        self.sparsity.factor(&mut matrix, rows);
        let mut direction = slopes.map(|slope| -slope);
        self.sparsity.solve(&matrix, &mut direction, rows);
        let changed = self.sparsity.product(&equations.matrix, &direction, rows);
        let dot = |a: &Velocities| -> f64 { rows.clone().map(|k| a[k] * direction[k]).sum() };
        NewtonStep {
            gain: -dot(&slopes),
            linear: dot(&residual),
            quadratic: dot(&changed),
            points: points
                .into_iter()
                .map(|(term, relative)| (term, relative, term.contact.relative(&direction)))
                .collect(),
            direction,
        }
    }

    /// Writes down what touched.
    pub(super) fn note_contacts(&self, world: &mut World, velocities: &Velocities, terms: &[Term]) {
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
}

/// A direction to go, and the function along it.
struct NewtonStep<'a> {
    direction: Velocities,
    /// How fast the function falls at first.
    gain: f64,
    linear: f64,
    quadratic: f64,
    /// Contacts, their relative velocities, and how those change.
    points: Vec<(&'a Term, Vector3<f64>, Vector3<f64>)>,
}

impl NewtonStep<'_> {
    /// Slope of the function after a share of the step.
    fn slope(&self, share: f64) -> f64 {
        let smooth = self.linear + share * self.quadratic;
        let pushed = |(term, relative, change): &(&Term, Vector3<f64>, Vector3<f64>)| {
            term.impulse(&(relative + change * share)).dot(change)
        };
        smooth - self.points.iter().map(pushed).sum::<f64>()
    }

    /// The share of the step after which the function rises no more, roughly.
    fn search(&self) -> f64 {
        const ROUGHLY: f64 = 0.1;
        const TRIES: usize = 30;
        let [mut low, mut high] = [(0.0, -self.gain), (1.0, self.slope(1.0))];
        if high.1 <= ROUGHLY * self.gain {
            return 1.0;
        }
        let mut share = 1.0;
        for _ in 0..TRIES {
            // Regula falsi, Illinois' way: an end that stays counts half.
            share = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let slope = self.slope(share);
            if slope.abs() <= ROUGHLY * self.gain {
                break;
            }
            if slope > 0.0 {
                high = (share, slope);
                low.1 *= 0.5;
            } else {
                low = (share, slope);
                high.1 *= 0.5;
            }
        }
        share
    }
}
