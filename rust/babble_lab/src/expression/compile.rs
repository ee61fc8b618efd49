//! From an expression to programs: what depends on one neuron alone is computed once for it.

use babble_agent::rule::OwnRule;

use super::program::{Instruction, Program, Source};
use super::syntax::{Expr, One, Quantity, Two};

/// Greatest exponent that is multiplied out.
const MOST_FACTORS: u8 = 8;

/// An expression in three parts, as [`babble_brain::LearningRule`] has them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Compiled {
    /// Signals of an output neuron, from rows of a and ā.
    pub(super) post: Vec<Program>,
    /// Signals of an input neuron, from rows of g and ḡ.
    pub(super) pre: Vec<Program>,
    /// The change of a weight, from rows of w and the input's signals; the output's signals are its scalars.
    pub(super) change: Program,
    /// Signals of the output neuron that are factors of the change: where one is zero, the change is.
    pub(super) factors: Vec<usize>,
}

/// What a part of an expression depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    Nothing,
    Output,
    Input,
    /// The weight, or both neurons.
    Weight,
}

pub(super) fn compiled(expr: &Expr, numbers: OwnRule) -> Compiled {
    let (mut post, mut pre) = (Vec::new(), Vec::new());
    let change = program(expr, numbers, &mut |part| match scope(part) {
        Scope::Nothing | Scope::Output => Some(Source::Scalar(index(&mut post, part))),
        Scope::Input => Some(Source::Row(1 + index(&mut pre, part))),
        Scope::Weight => None,
    });
    let mut factors = Vec::new();
    collect_factors(expr, &post, &mut factors);
    let signals = |parts: &[&Expr]| {
        let signal = |part: &&Expr| program(part, numbers, &mut |_| None);
        parts.iter().map(signal).collect()
    };
    Compiled {
        post: signals(&post),
        pre: signals(&pre),
        change,
        factors,
    }
}

fn scope(expr: &Expr) -> Scope {
    match expr {
        Expr::Number(_) | Expr::Quantity(Quantity::Eta | Quantity::WMax) => Scope::Nothing,
        Expr::Quantity(Quantity::A | Quantity::AMean) => Scope::Output,
        Expr::Quantity(Quantity::G | Quantity::GMean) => Scope::Input,
        Expr::Quantity(Quantity::W) => Scope::Weight,
        Expr::One(_, x) => scope(x),
        Expr::Two(_, x, y) => match (scope(x), scope(y)) {
            (Scope::Nothing, of) | (of, Scope::Nothing) => of,
            (one, other) if one == other => one,
            _ => Scope::Weight,
        },
    }
}

/// The place of a part in a list, which it enters if it is new.
fn index<'a>(parts: &mut Vec<&'a Expr>, part: &'a Expr) -> usize {
    let known = parts.iter().position(|known| *known == part);
    known.unwrap_or_else(|| {
        parts.push(part);
        parts.len() - 1
    })
}

/// The signals among the factors of an expression.
fn collect_factors(expr: &Expr, signals: &[&Expr], found: &mut Vec<usize>) {
    if let Some(signal) = signals.iter().position(|signal| *signal == expr) {
        found.push(signal);
        return;
    }
    match expr {
        Expr::One(One::Negate, x) | Expr::Two(Two::Divide, x, _) => {
            collect_factors(x, signals, found);
        }
        Expr::Two(Two::Multiply, x, y) => {
            collect_factors(x, signals, found);
            collect_factors(y, signals, found);
        }
        _ => {}
    }
}

/// Where a part is, if it need not be computed.
type Given<'f, 'a> = dyn FnMut(&'a Expr) -> Option<Source> + 'f;

fn program<'a>(expr: &'a Expr, numbers: OwnRule, given: &mut Given<'_, 'a>) -> Program {
    let mut instructions = Vec::new();
    let result = emit(expr, numbers, given, &mut instructions);
    Program {
        instructions,
        result,
    }
}

/// Appends the instructions of an expression, and returns where its value is.
fn emit<'a>(
    expr: &'a Expr,
    numbers: OwnRule,
    given: &mut Given<'_, 'a>,
    instructions: &mut Vec<Instruction>,
) -> Source {
    use Quantity::{A, AMean, Eta, G, GMean, W, WMax};
    if let Some(source) = given(expr) {
        return source;
    }
    let mut source = |part| emit(part, numbers, given, instructions);
    let instruction = match expr {
        Expr::Number(x) => return Source::Number(*x),
        Expr::Quantity(Eta) => return Source::Number(numbers.eta),
        Expr::Quantity(WMax) => return Source::Number(numbers.w_max),
        Expr::Quantity(A | G | W) => return Source::Row(0),
        Expr::Quantity(AMean | GMean) => return Source::Row(1),
        Expr::One(one, x) => Instruction::One(*one, source(x)),
        Expr::Two(two, x, y) => match (two, &**x, &**y) {
            (Two::Subtract, Expr::Quantity(A), Expr::Quantity(AMean))
            | (Two::Subtract, Expr::Quantity(G), Expr::Quantity(GMean)) => {
                Instruction::Deviation(source(x), source(y))
            }
            (Two::Subtract, Expr::Quantity(WMax), Expr::One(One::Abs, w))
                if **w == Expr::Quantity(W) =>
            {
                Instruction::Room(source(x), source(w))
            }
            (Two::Power, x, Expr::Number(exponent)) if whole(*exponent) => {
                Instruction::Whole(source(x), *exponent as u8)
            }
            (two, x, y) => Instruction::Two(*two, source(x), source(y)),
        },
    };
    instructions.push(instruction);
    Source::Result(instructions.len() - 1)
}

/// Whether a power with this exponent is multiplied out.
fn whole(exponent: f32) -> bool {
    (1..=MOST_FACTORS).any(|factors| f32::from(factors) == exponent)
}
