//! Learning rules that users write in a line: the change Δw of a weight as an expression.
//!
//! ```text
//! eta * (a - a_mean) * (g - g_mean) * (w_max - abs(w))                               (Eq. 7)
//! ```
//!
//! | in an expression | stands for |
//! | --- | --- |
//! | `a`, `a_mean` or `ā` | activity of the output neuron, and its running average |
//! | `g`, `g_mean` or `ḡ` | activity of the input neuron, and its running average |
//! | `w` | the weight before the change |
//! | `eta` or `η`, `w_max` | learning rate, and bound of the weights |
//! | `0.5`, `1e-3` | numbers |
//! | `+ - * / ^`, `( )` | as on paper: `-a^2` is −(a²), and `a^b^c` is a^(b^c) |
//! | `abs(x)`, `sign(x)`, `sqrt(x)`, `exp(x)`, `tanh(x)` | functions; `sign(0)` is 0 |
//! | `min(x, y)`, `max(x, y)` | the smaller and the greater of two |
//!
//! Everything is computed in single precision, in the order that is written. As in the rules that are built in,
//! a difference `a - a_mean` or `g - g_mean` below 1e-10 counts as zero, `w_max - abs(w)` is never below zero, and
//! a product with a factor of `a` and `a_mean` alone that is zero is zero. So Eq. 7, Hebb's and Oja's rule written
//! as expressions learn the same bits as those that are built in.

mod compile;
mod learn;
mod parse;
mod program;
mod scan;
mod syntax;
#[cfg(test)]
mod tests;

use std::fmt;
use std::str::FromStr;

use babble_agent::AgentError;
use babble_agent::rule::OwnRule;
use babble_brain::Association;

use syntax::Expr;

/// Most characters of an expression.
pub const MOST_CHARACTERS: usize = 500;

/// What is wrong with an expression, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("character {}: {problem}", at + 1)]
pub struct RuleFault {
    /// A sentence that says what was found and what was expected.
    pub problem: String,
    /// Characters before the place.
    pub at: usize,
}

/// A learning rule that was written as an expression.
///
/// ```
/// use babble_agent::rule::OwnRule;
/// use babble_brain::Association;
/// use babble_lab::expression::RuleExpression;
///
/// let rule = RuleExpression::parse("eta * a * (g - w)")?;
/// let mut association = Association::new(2, 1)?;
/// rule.learn(OwnRule { eta: 0.5, ..OwnRule::default() }, &mut association, &[1.0, 0.0], &[1.0])?;
/// assert_eq!(association.weights(), [0.5, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RuleExpression(Expr);

impl RuleExpression {
    /// The rule in a text of at most 500 characters.
    ///
    /// # Errors
    /// [`RuleFault`] names the character where the text stops making sense.
    pub fn parse(text: &str) -> Result<Self, RuleFault> {
        parse::expression(text).map(Self)
    }

    /// Learns from m movements in their order: `g` holds m · `n_in` activities, `a` m · `n_out`, all in
    /// \[0, 1\]. For each movement the weights change by the rule, then the running averages move on.
    ///
    /// # Errors
    /// [`AgentError::Brain`] for slices of other lengths or with other numbers, [`AgentError::Rule`] for a
    /// change that is no finite number; nothing is learnt then.
    pub fn learn(
        &self,
        numbers: OwnRule,
        association: &mut Association,
        g: &[f32],
        a: &[f32],
    ) -> Result<(), AgentError> {
        let compiled = compile::compiled(&self.0, numbers);
        learn::learn(&compiled, numbers.xi, association, g, a)
    }
}

/// The expression with as few parentheses as it needs.
impl fmt::Display for RuleExpression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for RuleExpression {
    type Err = RuleFault;

    fn from_str(text: &str) -> Result<Self, RuleFault> {
        Self::parse(text)
    }
}
