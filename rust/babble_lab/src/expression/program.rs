//! An expression as a list of instructions, each of which runs over a row of numbers.

use babble_brain::rules::{deviation, room};

use super::syntax::{One, Two};

/// Numbers that an instruction computes at a time: enough that finding out which one it is costs little.
pub(super) const LANES: usize = 64;

/// Weights that are held in vector registers while they decay.
const IN_REGISTERS: usize = 32;

/// A part of a row.
pub(super) type Tile = [f32; LANES];

/// Where an operand comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    /// A number of the rule.
    Number(f32),
    /// A number that is given for the whole row.
    Scalar(usize),
    /// A row that is given.
    Row(usize),
    /// The result of an instruction before.
    Result(usize),
}

/// What an instruction computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Instruction {
    One(One, Source),
    Two(Two, Source, Source),
    /// A power with a small whole exponent, multiplied out.
    Whole(Source, u8),
    /// An activity and its average.
    Deviation(Source, Source),
    /// The bound of the weights, and a weight.
    Room(Source, Source),
}

/// Instructions, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    pub(super) instructions: Vec<Instruction>,
    /// Where the value of the whole expression is.
    pub(super) result: Source,
    /// Whether minus that is added to a row.
    pub(super) is_negative: bool,
}

#[derive(Clone, Copy)]
enum Operand<'a> {
    Scalar(f32),
    Row(&'a Tile),
}

impl Program {
    /// Memory for the results of the instructions.
    pub(super) fn memory(&self) -> Vec<Tile> {
        vec![[0.0; LANES]; self.instructions.len()]
    }

    /// The value of the expression for each place of `first`, row 0, and of the `others`.
    pub(super) fn value(&self, first: &Tile, others: &[Tile], memory: &mut [Tile]) -> Tile {
        run(&self.instructions, &[], first, others, memory);
        match operand(self.result, &[], first, others, memory) {
            Operand::Scalar(x) => [x; LANES],
            Operand::Row(row) => *row,
        }
    }

    /// The scalar of a decay: a program that is no more than a scalar times row 0.
    pub(super) fn decay(&self) -> Option<usize> {
        match *self.instructions {
            [
                Instruction::Two(Two::Multiply, Source::Scalar(rate), Source::Row(0))
                | Instruction::Two(Two::Multiply, Source::Row(0), Source::Scalar(rate)),
            ] => Some(rate),
            _ => None,
        }
    }

    /// Adds the value to row 0 of a [decay](Self::decay), once for each of its `rates`: part by part, so that
    /// the weights stay in vector registers.
    pub(super) fn decay_by(&self, rates: &[f32], row: &mut Tile) {
        for part in row.as_chunks_mut::<IN_REGISTERS>().0 {
            let mut w = *part;
            for &rate in rates {
                let rate = if self.is_negative { -rate } else { rate };
                for w in &mut w {
                    *w += rate * *w;
                }
            }
            *part = w;
        }
    }

    /// Writes row 0 plus the value into `to`, for each of its places.
    pub(super) fn add_to(
        &self,
        first: &Tile,
        scalars: &[f32],
        others: &[Tile],
        memory: &mut [Tile],
        to: &mut Tile,
    ) {
        use Two::{Add, Multiply, Subtract};
        let sign = if self.is_negative { -1.0 } else { 1.0 };
        // The last instruction and the sum are one loop.
        let (last, before) = match self.instructions.split_last() {
            Some((&Instruction::Two(two @ (Add | Subtract | Multiply), x, y), before)) => {
                (Some((two, x, y)), before)
            }
            _ => (None, &*self.instructions),
        };
        run(before, scalars, first, others, memory);
        let operand = |source| operand(source, scalars, first, others, memory);
        match last.map(|(two, x, y)| (two, operand(x), operand(y))) {
            Some((Add, x, y)) => plus(first, x, y, to, |w, x, y| w + sign * (x + y)),
            Some((Subtract, x, y)) => plus(first, x, y, to, |w, x, y| w + sign * (x - y)),
            Some((_, x, y)) => plus(first, x, y, to, |w, x, y| w + sign * (x * y)),
            None => {
                let w = Operand::Row(first);
                zip(w, operand(self.result), to, |w, x| w + sign * x);
            }
        }
    }
}

/// Runs instructions, whose results are the `memory`.
fn run(
    instructions: &[Instruction],
    scalars: &[f32],
    first: &Tile,
    others: &[Tile],
    memory: &mut [Tile],
) {
    for (i, &instruction) in instructions.iter().enumerate() {
        let (before, rest) = memory.split_at_mut(i);
        let operand = |source| operand(source, scalars, first, others, before);
        compute(instruction, operand, &mut rest[0]);
    }
}

fn operand<'a>(
    source: Source,
    scalars: &[f32],
    first: &'a Tile,
    others: &'a [Tile],
    results: &'a [Tile],
) -> Operand<'a> {
    match source {
        Source::Number(x) => Operand::Scalar(x),
        Source::Scalar(i) => Operand::Scalar(scalars[i]),
        Source::Row(0) => Operand::Row(first),
        Source::Row(i) => Operand::Row(&others[i - 1]),
        Source::Result(i) => Operand::Row(&results[i]),
    }
}

/// Runs one instruction. Each has a loop of its own, which the compiler puts in vector registers.
fn compute<'a>(instruction: Instruction, operand: impl Fn(Source) -> Operand<'a>, out: &mut Tile) {
    match instruction {
        Instruction::One(one, x) => {
            let x = operand(x);
            match one {
                One::Negate => map(x, out, |x| One::Negate.of(x)),
                One::Abs => map(x, out, |x| One::Abs.of(x)),
                One::Sign => map(x, out, |x| One::Sign.of(x)),
                One::Sqrt => map(x, out, |x| One::Sqrt.of(x)),
                One::Exp => map(x, out, |x| One::Exp.of(x)),
                One::Tanh => map(x, out, |x| One::Tanh.of(x)),
            }
        }
        Instruction::Two(two, x, y) => {
            let (x, y) = (operand(x), operand(y));
            match two {
                Two::Add => zip(x, y, out, |x, y| Two::Add.of(x, y)),
                Two::Subtract => zip(x, y, out, |x, y| Two::Subtract.of(x, y)),
                Two::Multiply => zip(x, y, out, |x, y| Two::Multiply.of(x, y)),
                Two::Divide => zip(x, y, out, |x, y| Two::Divide.of(x, y)),
                Two::Power => zip(x, y, out, |x, y| Two::Power.of(x, y)),
                Two::Min => zip(x, y, out, |x, y| Two::Min.of(x, y)),
                Two::Max => zip(x, y, out, |x, y| Two::Max.of(x, y)),
            }
        }
        Instruction::Whole(x, exponent) => map(operand(x), out, |x| whole(x, exponent)),
        Instruction::Deviation(x, mean) => zip(operand(x), operand(mean), out, deviation),
        Instruction::Room(w_max, w) => {
            zip(operand(w_max), operand(w), out, |w_max, w| room(w, w_max));
        }
    }
}

/// x to the power of a small whole number.
fn whole(x: f32, exponent: u8) -> f32 {
    (1..exponent).fold(x, |power, _| power * x)
}

#[inline]
fn map(x: Operand<'_>, out: &mut Tile, f: impl Fn(f32) -> f32) {
    match x {
        Operand::Scalar(x) => *out = [f(x); LANES],
        Operand::Row(x) => {
            for i in 0..LANES {
                out[i] = f(x[i]);
            }
        }
    }
}

#[inline]
fn zip(x: Operand<'_>, y: Operand<'_>, out: &mut Tile, f: impl Fn(f32, f32) -> f32) {
    match (x, y) {
        (Operand::Scalar(x), Operand::Scalar(y)) => *out = [f(x, y); LANES],
        (Operand::Scalar(x), Operand::Row(y)) => {
            for i in 0..LANES {
                out[i] = f(x, y[i]);
            }
        }
        (Operand::Row(x), Operand::Scalar(y)) => {
            for i in 0..LANES {
                out[i] = f(x[i], y);
            }
        }
        (Operand::Row(x), Operand::Row(y)) => {
            for i in 0..LANES {
                out[i] = f(x[i], y[i]);
            }
        }
    }
}

/// A row of weights after a change that two operands make.
#[inline]
fn plus(
    w: &Tile,
    x: Operand<'_>,
    y: Operand<'_>,
    out: &mut Tile,
    f: impl Fn(f32, f32, f32) -> f32,
) {
    match (x, y) {
        (Operand::Scalar(x), y) => zip(Operand::Row(w), y, out, |w, y| f(w, x, y)),
        (x, Operand::Scalar(y)) => zip(Operand::Row(w), x, out, |w, x| f(w, x, y)),
        (Operand::Row(x), Operand::Row(y)) => {
            for i in 0..LANES {
                out[i] = f(w[i], x[i], y[i]);
            }
        }
    }
}
