//! Cases as named values, the same for all tasks: what `reset(options=...)` holds and what a server
//! sends.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::EnvError;
use crate::near;

/// The value of one part of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum CaseValue {
    /// Explicitly none: no obstacle, or a value to be sampled.
    Absent,
    /// True or false.
    Flag(bool),
    /// One number.
    Number(f64),
    /// A position, a posture, or a circle (x, y, radius).
    Numbers(Vec<f64>),
}

impl fmt::Display for CaseValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => f.write_str("none"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Numbers(numbers) => write!(f, "{numbers:?}"),
        }
    }
}

impl From<f64> for CaseValue {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<const N: usize> From<[f64; N]> for CaseValue {
    fn from(numbers: [f64; N]) -> Self {
        Self::Numbers(numbers.to_vec())
    }
}

/// What a part of a case can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CasePart {
    /// Name of the part.
    pub name: &'static str,
    /// How many numbers it has: one length, or several. A length of 0 stands for one plain number, and
    /// no length for true or false.
    pub lengths: &'static [usize],
    /// Unit of the numbers.
    pub unit: &'static str,
    /// What the part says.
    pub doc: &'static str,
}

/// A case, or what is asked of one: values of some parts of a task's cases.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CaseValues(Vec<(&'static str, CaseValue)>);

impl CaseValues {
    /// Values as a user gives them.
    ///
    /// # Errors
    /// [`EnvError::UnknownName`] for a part that cases of the task do not have, and
    /// [`EnvError::CaseValue`] for a value with the wrong count of numbers.
    pub fn read<'a>(
        parts: &'static [CasePart],
        given: impl IntoIterator<Item = (&'a str, CaseValue)>,
    ) -> Result<Self, EnvError> {
        let mut values = Self::default();
        for (name, value) in given {
            let Some(part) = parts.iter().find(|part| part.name == name) else {
                return Err(near::unknown(
                    "part of a case",
                    name,
                    parts.iter().map(|part| part.name),
                ));
            };
            part.check(&value)?;
            values.0.push((part.name, value));
        }
        Ok(values)
    }

    /// The same with one more part.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Into<CaseValue>) -> Self {
        self.0.push((name, value.into()));
        self
    }

    /// The value of a part, if there is one.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&CaseValue> {
        self.iter()
            .find_map(|(found, value)| (found == name).then_some(value))
    }

    /// The numbers of a part that has N of them; none where it is not given or absent.
    #[must_use]
    pub fn numbers<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        match self.get(name)? {
            CaseValue::Numbers(numbers) => numbers[..].try_into().ok(),
            CaseValue::Absent | CaseValue::Flag(_) | CaseValue::Number(_) => None,
        }
    }

    /// The number of a part that has one; none where it is not given or absent.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.get(name)? {
            CaseValue::Number(number) => Some(*number),
            CaseValue::Absent | CaseValue::Flag(_) | CaseValue::Numbers(_) => None,
        }
    }

    /// Whether a part is true; none where it is not given or absent.
    #[must_use]
    pub fn flag(&self, name: &str) -> Option<bool> {
        match self.get(name)? {
            CaseValue::Flag(flag) => Some(*flag),
            CaseValue::Absent | CaseValue::Number(_) | CaseValue::Numbers(_) => None,
        }
    }

    /// Names and values, in the order in which they were given.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &CaseValue)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }
}

impl CasePart {
    fn check(&self, value: &CaseValue) -> Result<(), EnvError> {
        let fits = match value {
            CaseValue::Absent => true,
            CaseValue::Flag(_) => self.lengths.is_empty(),
            CaseValue::Number(_) => self.lengths.contains(&0),
            CaseValue::Numbers(numbers) => {
                !numbers.is_empty() && self.lengths.contains(&numbers.len())
            }
        };
        if fits {
            return Ok(());
        }
        Err(EnvError::CaseValue {
            part: self.name,
            value: value.to_string(),
            expected: self.expected(),
        })
    }

    fn expected(&self) -> String {
        if self.lengths.is_empty() {
            return "True or False".to_owned();
        }
        let count = |&n: &usize| match n {
            0 => "a number".to_owned(),
            n => format!("{n} numbers"),
        };
        let counts: Vec<String> = self.lengths.iter().map(count).collect();
        format!("{} [{}]", counts.join(" or "), self.unit)
    }
}
