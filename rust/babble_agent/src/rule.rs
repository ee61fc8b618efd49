//! Which rule a network learns by, and its numbers.

use std::fmt;
use std::str::FromStr;

use babble_brain::{
    Association, BrainError, CovarianceRule, HebbRule, LearningRule, OjaRule, OutstarRule,
};
use serde::{Deserialize, Serialize};

use crate::error::AgentError;

/// A learning rule by name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case")]
pub enum Rule {
    /// The paper's, Eq. 7.
    Covariance(CovarianceRule),
    /// Hebb's: Eq. 7 without the averages.
    Hebb(HebbRule),
    /// Oja's.
    Oja(OjaRule),
    /// Grossberg's outstar.
    Outstar(OutstarRule),
    /// A user's own, which is not stored with the network: see [`RuleOfOnesOwn`].
    Own(OwnRule),
}

/// Numbers that a rule of a user's own is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OwnRule {
    /// Learning rate η, 0 < η ≤ 1, default 1.
    pub eta: f32,
    /// Bound of the weights, > 0, default 0.2, if the rule has one.
    pub w_max: f32,
    /// Share ξ of the old value in the running averages, 0 ≤ ξ < 1, default 0.2.
    pub xi: f32,
}

impl Default for OwnRule {
    fn default() -> Self {
        let CovarianceRule { eta, w_max, xi } = CovarianceRule::default();
        Self { eta, w_max, xi }
    }
}

/// A rule that is not local, or that is written elsewhere: it changes a whole association for each
/// movement of `g` (m · `n_in` activities) and `a` (m · `n_out`) in turn.
///
/// # Errors
/// Whatever is wrong with it; what is learnt is then forgotten.
pub type RuleOfOnesOwn<'a> =
    dyn FnMut(&mut Association, &[f32], &[f32]) -> Result<(), AgentError> + Send + 'a;

impl Rule {
    /// Names of the rules that are built in.
    pub const NAMES: [&'static str; 4] = ["covariance", "hebb", "oja", "outstar"];

    /// The numbers of a rule of the user's own, which starts from those of the paper.
    #[must_use]
    pub fn own() -> Self {
        Self::Own(OwnRule::default())
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`BrainError::OutOfRange`] names the number outside of its range.
    pub fn validate(&self) -> Result<(), BrainError> {
        match self {
            Self::Covariance(rule) => rule.validate(),
            Self::Hebb(rule) => rule.validate(),
            Self::Oja(rule) => rule.validate(),
            Self::Outstar(_) => Ok(()),
            Self::Own(OwnRule { eta, w_max, xi }) => CovarianceRule {
                eta: *eta,
                w_max: *w_max,
                xi: *xi,
            }
            .validate(),
        }
    }

    /// Learns from m movements: `g` holds m · `n_in` activities, `a` m · `n_out`.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for activities outside of \[0, 1\], [`AgentError::Config`] for a rule of
    /// the user's own, which has to be given; nothing is learnt then.
    pub fn learn(
        &self,
        association: &mut Association,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), AgentError> {
        match self {
            Self::Covariance(rule) => rule.learn(association, g, a)?,
            Self::Hebb(rule) => rule.learn(association, g, a)?,
            Self::Oja(rule) => rule.learn(association, g, a)?,
            Self::Outstar(_) => association.learn_outstar(g, a)?,
            Self::Own(_) => {
                return Err(AgentError::Config {
                    field: "rule",
                    problem: "this agent learns by a rule of your own: pass it again".to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Share ξ of the old value in the running averages.
    #[must_use]
    pub fn xi(&self) -> f32 {
        match self {
            Self::Covariance(rule) => rule.xi(),
            Self::Hebb(rule) => rule.xi(),
            Self::Oja(rule) => rule.xi(),
            Self::Outstar(_) => 0.0,
            Self::Own(rule) => rule.xi,
        }
    }

    /// Greatest absolute value of a weight, to one unit in the last place.
    #[must_use]
    pub fn w_max(&self) -> f32 {
        match self {
            Self::Covariance(rule) => rule.w_max,
            Self::Hebb(rule) => rule.w_max,
            // A mean of activities.
            Self::Outstar(_) => 1.0,
            Self::Oja(_) | Self::Own(_) => f32::MAX,
        }
    }

    /// Sets the running averages of an association that somebody else wrote, or the use of its inputs.
    ///
    /// # Errors
    /// As [`Association::set_means`] and [`Association::set_use`].
    pub fn set_means(
        &self,
        association: &mut Association,
        a_mean: &[f32],
        g_mean: &[f32],
    ) -> Result<(), BrainError> {
        if matches!(self, Self::Outstar(_)) {
            return association.set_use(g_mean);
        }
        association.set_means(a_mean, g_mean)
    }

    /// Checks weights that somebody else wrote.
    ///
    /// # Errors
    /// [`AgentError::Config`] for a weight beyond the rule's bound, or no number.
    pub fn check_weights(&self, weights: &[f32]) -> Result<(), AgentError> {
        let bound = self.w_max().next_up();
        match weights.iter().position(|w| w.is_nan() || w.abs() > bound) {
            None => Ok(()),
            Some(at) => Err(AgentError::Config {
                field: "weights",
                problem: format!(
                    "number {at} is {}, beyond the rule's w_max = {}",
                    weights[at],
                    self.w_max()
                ),
            }),
        }
    }
}

impl Default for Rule {
    fn default() -> Self {
        Self::Covariance(CovarianceRule::default())
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Covariance(_) => "covariance",
            Self::Hebb(_) => "hebb",
            Self::Oja(_) => "oja",
            Self::Outstar(_) => "outstar",
            Self::Own(_) => "own",
        })
    }
}

/// A rule by name, with the numbers that it has unless others are given.
impl FromStr for Rule {
    type Err = AgentError;

    fn from_str(name: &str) -> Result<Self, AgentError> {
        match name {
            "covariance" => Ok(Self::default()),
            "hebb" => Ok(Self::Hebb(HebbRule::default())),
            "oja" => Ok(Self::Oja(OjaRule::default())),
            "outstar" => Ok(Self::Outstar(OutstarRule::default())),
            _ => Err(AgentError::Config {
                field: "rule",
                problem: format!("{name:?} is not one of {}", Self::NAMES.join(", ")),
            }),
        }
    }
}
