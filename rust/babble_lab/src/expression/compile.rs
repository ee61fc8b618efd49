//! From an expression to programs: what depends on one neuron alone is computed once for it.

use babble_agent::rule::OwnRule;

use super::program::{Instruction, Program, Source, Tile};
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
    /// Terms of the change that are zero where one of their factors is, as these factors: signals of the
    /// output neuron.
    pub(super) factored: Vec<Vec<usize>>,
    /// The change where all those terms are zero; none if that is zero, too.
    pub(super) rest: Option<Program>,
}

impl Compiled {
    /// Memory for the change, which is enough for the rest.
    pub(super) fn memory(&self) -> Vec<Tile> {
        self.change.memory()
    }
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
    let mut factored = Vec::new();
    let rest = rest(expr, &mut factored);
    let (mut post, mut pre) = (Vec::new(), Vec::new());
    let mut signal = |part| match scope(part) {
        Scope::Nothing | Scope::Output => Some(Source::Scalar(index(&mut post, part))),
        Scope::Input => Some(Source::Row(1 + index(&mut pre, part))),
        Scope::Weight => None,
    };
    let whole = change(expr, numbers, &mut signal);
    let rest = rest.as_ref().map(|rest| change(rest, numbers, &mut signal));
    let mut places = |factors: Vec<_>| {
        let places = factors.into_iter().map(|factor| index(&mut post, factor));
        places.collect()
    };
    let factored = factored.into_iter().map(&mut places).collect();
    let signals = |parts: &[&Expr]| {
        let signal = |part: &&Expr| program(part, numbers, &mut |_| None);
        parts.iter().map(signal).collect()
    };
    Compiled {
        post: signals(&post),
        pre: signals(&pre),
        change: whole,
        factored,
        rest,
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

/// The sum of the terms without a factor of the output neuron alone; the others' factors are listed in
/// `factored`. None if there are only such.
fn rest<'a>(expr: &'a Expr, factored: &mut Vec<Vec<&'a Expr>>) -> Option<Expr> {
    let sum = |two, x, y| Some(Expr::Two(two, Box::new(x), Box::new(y)));
    let minus = |x| Some(Expr::One(One::Negate, Box::new(x)));
    match expr {
        _ if scope(expr) != Scope::Weight => {}
        Expr::One(One::Negate, x) => return rest(x, factored).and_then(minus),
        Expr::Two(two @ (Two::Add | Two::Subtract), x, y) => {
            return match (rest(x, factored), two, rest(y, factored)) {
                (Some(x), _, Some(y)) => sum(*two, x, y),
                (None, Two::Subtract, Some(y)) => minus(y),
                (Some(x), _, None) | (None, _, Some(x)) => Some(x),
                (None, _, None) => None,
            };
        }
        _ => {}
    }
    let mut factors = Vec::new();
    collect_factors(expr, &mut factors);
    if factors.is_empty() {
        return Some(expr.clone());
    }
    factored.push(factors);
    None
}

/// The factors of a term that depend on the output neuron alone.
fn collect_factors<'a>(term: &'a Expr, found: &mut Vec<&'a Expr>) {
    match (scope(term), term) {
        (Scope::Output, _) => found.push(term),
        (_, Expr::One(One::Negate, x) | Expr::Two(Two::Divide, x, _)) => collect_factors(x, found),
        (_, Expr::Two(Two::Multiply, x, y)) => {
            collect_factors(x, found);
            collect_factors(y, found);
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
        is_negative: false,
    }
}

/// The program of a sum's term; a minus before it costs nothing.
fn change<'a>(expr: &'a Expr, numbers: OwnRule, given: &mut Given<'_, 'a>) -> Program {
    match expr {
        Expr::One(One::Negate, x) => Program {
            is_negative: true,
            ..program(x, numbers, given)
        },
        _ => program(expr, numbers, given),
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
