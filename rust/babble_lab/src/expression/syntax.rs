//! What an expression consists of, and how it is printed.

use std::fmt::{self, Display as _};

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expr {
    /// A number, finite and not below zero.
    Number(f32),
    /// A quantity by name.
    Quantity(Quantity),
    /// An operation on one operand.
    One(One, Box<Expr>),
    /// An operation on two operands.
    Two(Two, Box<Expr>, Box<Expr>),
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    A,
    AMean,
    G,
    GMean,
    W,
    Eta,
    WMax,
}

/// Operations on one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum One {
    Negate,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Tanh,
}

/// Operations on two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Two {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

impl Quantity {
    /// Names, and what they stand for; the first name of each is printed.
    pub(super) const NAMES: [(&'static str, Self); 10] = [
        ("a", Self::A),
        ("a_mean", Self::AMean),
        ("ā", Self::AMean),
        ("g", Self::G),
        ("g_mean", Self::GMean),
        ("ḡ", Self::GMean),
        ("w", Self::W),
        ("eta", Self::Eta),
        ("η", Self::Eta),
        ("w_max", Self::WMax),
    ];
}

impl One {
    /// Functions by name.
    pub(super) const NAMES: [(&'static str, Self); 5] = [
        ("abs", Self::Abs),
        ("sign", Self::Sign),
        ("sqrt", Self::Sqrt),
        ("exp", Self::Exp),
        ("tanh", Self::Tanh),
    ];

    /// The operation on a number.
    #[inline]
    pub(super) fn of(self, x: f32) -> f32 {
        match self {
            Self::Negate => -x,
            Self::Abs => x.abs(),
            Self::Sign if x > 0.0 => 1.0,
            Self::Sign if x < 0.0 => -1.0,
            Self::Sign => 0.0,
            Self::Sqrt => x.sqrt(),
            Self::Exp => libm::expf(x),
            Self::Tanh => libm::tanhf(x),
        }
    }
}

impl Two {
    /// Functions by name.
    pub(super) const NAMES: [(&'static str, Self); 2] = [("min", Self::Min), ("max", Self::Max)];

    /// The operation on two numbers.
    #[inline]
    pub(super) fn of(self, x: f32, y: f32) -> f32 {
        match self {
            Self::Add => x + y,
            Self::Subtract => x - y,
            Self::Multiply => x * y,
            Self::Divide => x / y,
            Self::Power => libm::powf(x, y),
            // f32::min may return either of two zeros, so its bits are not the same everywhere.
            Self::Min => {
                if x < y {
                    x
                } else {
                    y
                }
            }
            Self::Max => {
                if x > y {
                    x
                } else {
                    y
                }
            }
        }
    }
}

/// How tightly an expression holds together when it is printed.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const SIGNED: u8 = 3;
const POWER: u8 = 4;
const ATOM: u8 = 5;

impl Expr {
    fn tightness(&self) -> u8 {
        match self {
            Self::Two(Two::Add | Two::Subtract, ..) => SUM,
            Self::Two(Two::Multiply | Two::Divide, ..) => PRODUCT,
            Self::One(One::Negate, _) => SIGNED,
            Self::Two(Two::Power, ..) => POWER,
            Self::Number(_) | Self::Quantity(_) | Self::One(..) | Self::Two(..) => ATOM,
        }
    }

    /// Prints it where something at least as tight is expected.
    fn print(&self, expected: u8, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tightness() >= expected {
            return self.fmt(f);
        }
        write!(f, "({self})")
    }
}

impl fmt::Display for Expr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let infix =
            |f: &mut fmt::Formatter<'_>, left: &Self, sign, right: &Self, [l, r]: [u8; 2]| {
                left.print(l, f)?;
                f.write_str(sign)?;
                right.print(r, f)
            };
        match self {
            // `{:?}` has an exponent where the number would be long.
            Self::Number(x) => f.write_str(format!("{x:?}").trim_end_matches(".0")),
            Self::Quantity(quantity) => f.write_str(name(*quantity, &Quantity::NAMES)),
            Self::One(One::Negate, x) => {
                f.write_str("-")?;
                x.print(SIGNED, f)
            }
            Self::One(function, x) => write!(f, "{}({x})", name(*function, &One::NAMES)),
            Self::Two(Two::Add, l, r) => infix(f, l, " + ", r, [SUM, PRODUCT]),
            Self::Two(Two::Subtract, l, r) => infix(f, l, " - ", r, [SUM, PRODUCT]),
            Self::Two(Two::Multiply, l, r) => infix(f, l, " * ", r, [PRODUCT, SIGNED]),
            Self::Two(Two::Divide, l, r) => infix(f, l, " / ", r, [PRODUCT, SIGNED]),
            Self::Two(Two::Power, l, r) => infix(f, l, "^", r, [ATOM, SIGNED]),
            Self::Two(function, l, r) => write!(f, "{}({l}, {r})", name(*function, &Two::NAMES)),
        }
    }
}

/// The first name of something in a table of names.
fn name<T: Copy + PartialEq>(of: T, names: &[(&'static str, T)]) -> &'static str {
    let found = names.iter().find(|(_, known)| *known == of);
    found.map_or("", |(name, _)| name)
}
