//! The solver's function along the line of a step.

use super::moving_contact::MovingContact;

/// The function that the solver minimises, along a line.
pub(super) struct Line<'a> {
    pub(super) linear: f64,
    pub(super) quadratic: f64,
    pub(super) contacts: &'a [MovingContact<'a>],
}

impl Line<'_> {
    /// Its slope after a share of the step \[J\].
    pub(super) fn slope(&self, share: f64) -> f64 {
        let pushed = self.contacts.iter().map(|moving| moving.pushed(share));
        self.linear + share * self.quadratic - pushed.sum::<f64>()
    }
}
