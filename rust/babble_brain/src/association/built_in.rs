//! Learning by the rules of this crate, compiled as this crate is rather than as its user.

use super::Association;
use crate::error::BrainError;
use crate::rules::{CovarianceRule, HebbRule, OjaRule};

impl CovarianceRule {
    /// [`Association::learn`] by this rule.
    ///
    /// # Errors
    /// As there.
    pub fn learn(
        &self,
        association: &mut Association,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), BrainError> {
        association.learn(self, g, a)
    }
}

impl HebbRule {
    /// [`Association::learn`] by this rule.
    ///
    /// # Errors
    /// As there.
    pub fn learn(
        &self,
        association: &mut Association,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), BrainError> {
        association.learn(self, g, a)
    }
}

impl OjaRule {
    /// [`Association::learn`] by this rule.
    ///
    /// # Errors
    /// As there.
    pub fn learn(
        &self,
        association: &mut Association,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), BrainError> {
        association.learn(self, g, a)
    }
}
