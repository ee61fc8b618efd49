//! The solver's function along the line of a step.

use nalgebra::Vector3;

use super::contact_cost::ContactCost;

/// A contact along a line.
pub(super) struct LinePoint<'a> {
    pub(super) cost: &'a ContactCost,
    pub(super) relative: Vector3<f64>,
    pub(super) change: Vector3<f64>,
}

impl LinePoint<'_> {
    /// Work of its impulse along the line after a share of the step \[J\].
    pub(super) fn pushed(&self, share: f64) -> f64 {
        let relative = self.relative + self.change * share;
        self.cost.impulse(&relative).dot(&self.change)
    }
}

/// The function that the solver minimises, along a line.
pub(super) struct Line<'a> {
    pub(super) linear: f64,
    pub(super) quadratic: f64,
    pub(super) points: Vec<LinePoint<'a>>,
}

impl Line<'_> {
    /// Its slope after a share of the step \[J\].
    pub(super) fn slope(&self, share: f64) -> f64 {
        let pushed: f64 = self.points.iter().map(|point| point.pushed(share)).sum();
        self.linear + share * self.quadratic - pushed
    }
}
