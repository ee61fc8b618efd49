//! A contact as it moves in a step of the solver.

use nalgebra::{Matrix3, Vector3};

use super::contact_cost::{ContactCost, Motion};
use super::factor::Velocities;

/// A contact at the velocities that the solver has come to.
pub(super) struct MovingContact<'a> {
    pub(super) cost: &'a ContactCost<'a>,
    /// Velocity of the ball's side against the link's \[m/s\].
    relative: Vector3<f64>,
    motion: Motion,
    /// Impulse on the ball's side \[N·s\].
    pub(super) impulse: Vector3<f64>,
    /// What the step that is searched along adds to the relative velocity \[m/s\].
    pub(super) change: Vector3<f64>,
}

impl<'a> MovingContact<'a> {
    /// A contact at rest.
    pub(super) fn new(cost: &'a ContactCost<'a>) -> Self {
        let relative = Vector3::zeros();
        let motion = cost.motion(&relative);
        Self {
            cost,
            relative,
            motion,
            impulse: relative,
            change: relative,
        }
    }

    /// Moves it with these velocities.
    pub(super) fn move_with(&mut self, velocities: &Velocities) {
        self.relative = self.cost.contact.relative(velocities);
        self.motion = self.cost.motion(&self.relative);
        self.impulse = self.cost.impulse(&self.motion);
    }

    /// How the impulse falls with the relative velocity \[kg\].
    pub(super) fn curvature(&self) -> Matrix3<f64> {
        self.cost.curvature(&self.motion)
    }

    /// Work of its impulse along the line after a share of the step \[J\].
    pub(super) fn pushed(&self, share: f64) -> f64 {
        let motion = self.cost.motion(&(self.relative + self.change * share));
        self.cost.impulse(&motion).dot(&self.change)
    }
}
