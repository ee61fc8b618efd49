//! What a user may choose when an environment is made: names, kinds, bounds and defaults, checked in
//! one place for all faces.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::error::EnvError;
use crate::near;

/// Most numbers in a list.
pub(crate) const MOST_NUMBERS: usize = 1_000;
/// Letters of a value that an error shows.
const MOST_LETTERS: usize = 80;

/// Values of options by name, as a user gives them.
pub type Options = Map<String, Value>;

/// One option of a task's environments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OptionSpec {
    /// Name of the option.
    pub name: &'static str,
    /// What values it takes.
    #[serde(flatten)]
    pub kind: OptionKind,
    /// Its value where none is given.
    pub default: OptionDefault,
    /// What it decides.
    pub doc: &'static str,
}

/// What values an option takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum OptionKind {
    /// One of some names.
    Choice {
        /// The names.
        values: &'static [&'static str],
    },
    /// True or false.
    Flag,
    /// A whole number.
    Whole {
        /// Least value.
        low: u32,
        /// Greatest value.
        high: u32,
        /// Unit of the number.
        unit: &'static str,
    },
    /// A number.
    Number {
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// A list of numbers, at least one.
    Numbers {
        /// Least value of each.
        low: f64,
        /// Greatest value of each.
        high: f64,
        /// Unit of the numbers.
        unit: &'static str,
    },
}

/// The value of an option where none is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OptionDefault {
    /// The task or the config decides; `null` may be given for it.
    Derived,
    /// A flag.
    Flag(bool),
    /// A whole number.
    Whole(u32),
    /// A number.
    Number(f64),
    /// One of the names.
    Name(&'static str),
}

impl OptionDefault {
    fn value(self) -> Value {
        match self {
            Self::Derived => Value::Null,
            Self::Flag(flag) => json!(flag),
            Self::Whole(whole) => json!(whole),
            Self::Number(number) => json!(number),
            Self::Name(name) => json!(name),
        }
    }
}

impl OptionSpec {
    /// An option that takes one of some names.
    #[must_use]
    pub const fn choice(
        name: &'static str,
        values: &'static [&'static str],
        default: &'static str,
        doc: &'static str,
    ) -> Self {
        Self {
            name,
            kind: OptionKind::Choice { values },
            default: OptionDefault::Name(default),
            doc,
        }
    }

    /// An option that is false by default.
    #[must_use]
    pub const fn flag(name: &'static str, doc: &'static str) -> Self {
        Self {
            name,
            kind: OptionKind::Flag,
            default: OptionDefault::Flag(false),
            doc,
        }
    }

    /// An option that takes a whole number.
    #[must_use]
    pub const fn whole(
        name: &'static str,
        [low, high]: [u32; 2],
        unit: &'static str,
        default: OptionDefault,
        doc: &'static str,
    ) -> Self {
        Self {
            name,
            kind: OptionKind::Whole { low, high, unit },
            default,
            doc,
        }
    }

    /// Checks a value that a user gave.
    fn check(&self, value: &Value) -> Result<(), EnvError> {
        if value.is_null() && self.default == OptionDefault::Derived {
            return Ok(());
        }
        match self.kind {
            OptionKind::Choice { values } => self.check_choice(value, values),
            OptionKind::Flag if value.is_boolean() => Ok(()),
            OptionKind::Flag => Err(self.refused(value, "True or False".to_owned())),
            OptionKind::Whole { low, high, unit } => {
                let whole = value.as_u64();
                let fits = whole.is_some_and(|n| (u64::from(low)..=u64::from(high)).contains(&n));
                if fits {
                    return Ok(());
                }
                Err(self.refused(value, format!("a whole number in [{low}, {high}] {unit}")))
            }
            OptionKind::Number { low, high } => {
                let fits = value.as_f64().is_some_and(|x| (low..=high).contains(&x));
                if fits {
                    return Ok(());
                }
                Err(self.refused(value, format!("a number in [{low}, {high}]")))
            }
            OptionKind::Numbers { low, high, unit } => {
                let fits = |x: &Value| x.as_f64().is_some_and(|x| (low..=high).contains(&x));
                let numbers = value
                    .as_array()
                    .filter(|all| (1..=MOST_NUMBERS).contains(&all.len()));
                if numbers.is_some_and(|all| all.iter().all(fits)) {
                    return Ok(());
                }
                let expected =
                    format!("a list of 1 to {MOST_NUMBERS} numbers in [{low}, {high}] {unit}");
                Err(self.refused(value, expected))
            }
        }
    }

    fn check_choice(&self, value: &Value, values: &'static [&'static str]) -> Result<(), EnvError> {
        let Some(name) = value.as_str() else {
            return Err(self.refused(value, format!("one of {}", values.join(", "))));
        };
        if values.contains(&name) {
            return Ok(());
        }
        Err(EnvError::Option {
            option: self.name,
            value: name.to_owned(),
            known: values.join(", "),
        })
    }

    fn refused(&self, value: &Value, expected: String) -> EnvError {
        EnvError::OptionKind {
            option: self.name,
            value: shortened(value.to_string()),
            expected,
        }
    }
}

fn shortened(text: String) -> String {
    match text.char_indices().nth(MOST_LETTERS) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text,
    }
}

/// The values of all options of a task, checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct OptionValues(BTreeMap<&'static str, Value>);

impl OptionValues {
    /// The values given, and the defaults of the other options.
    ///
    /// # Errors
    /// [`EnvError::UnknownName`] for an unknown option, [`EnvError::Option`] or
    /// [`EnvError::OptionKind`] for a value that an option cannot take.
    pub fn read(specs: &[OptionSpec], given: &Options) -> Result<Self, EnvError> {
        let mut values: BTreeMap<_, _> = specs
            .iter()
            .map(|spec| (spec.name, spec.default.value()))
            .collect();
        for (name, value) in given {
            let Some(spec) = specs.iter().find(|spec| spec.name == name) else {
                return Err(near::unknown(
                    "option",
                    name,
                    specs.iter().map(|spec| spec.name),
                ));
            };
            spec.check(value)?;
            values.insert(spec.name, value.clone());
        }
        Ok(Self(values))
    }

    /// The name chosen; empty where the task has no such option.
    #[must_use]
    pub fn name(&self, option: &str) -> &str {
        self.0.get(option).and_then(Value::as_str).unwrap_or("")
    }

    /// Whether a flag is set.
    #[must_use]
    pub fn flag(&self, option: &str) -> bool {
        self.0.get(option).and_then(Value::as_bool).unwrap_or(false)
    }

    /// A whole number; none where the task or the config decides.
    #[must_use]
    pub fn whole(&self, option: &str) -> Option<u32> {
        let number = self.0.get(option)?.as_u64()?;
        u32::try_from(number).ok()
    }

    /// A number; 0 where the task has no such option.
    #[must_use]
    pub fn number(&self, option: &str) -> f64 {
        self.0.get(option).and_then(Value::as_f64).unwrap_or(0.0)
    }

    /// A list of numbers; none where the task or the config decides.
    #[must_use]
    pub fn numbers(&self, option: &str) -> Option<Vec<f64>> {
        let all = self.0.get(option)?.as_array()?;
        all.iter().map(Value::as_f64).collect()
    }
}
