//! An expression for a block of movements, one tile of weights after the other.

use std::mem::swap;
use std::ops::Range;
use std::ptr;

use babble_agent::AgentError;
use babble_brain::{Association, BrainError};

use super::compile::Compiled;
use super::program::{LANES, Program, Tile};

/// Movements of a block: few enough for the signals of one tile to stay in the caches.
const BLOCK: usize = 64;

/// As [`super::RuleExpression::learn`].
pub(super) fn learn(
    rule: &Compiled,
    xi: f32,
    association: &mut Association,
    g: &[f32],
    a: &[f32],
) -> Result<(), AgentError> {
    let (n_in, n_out) = (association.n_in(), association.n_out());
    let movements = g.len() / n_in;
    check_length("g", movements * n_in, g.len())?;
    check_length("a", movements * n_out, a.len())?;
    let mut learning = association.clone();
    let mut w = association.weights().to_vec();
    for (g, a) in g.chunks(BLOCK * n_in).zip(a.chunks(BLOCK * n_out)) {
        Block::new(rule, g, a, xi, &mut learning)?.learn(&mut w)?;
    }
    learning.set_weights(&w)?;
    *association = learning;
    Ok(())
}

fn check_length(field: &'static str, expected: usize, actual: usize) -> Result<(), BrainError> {
    if actual == expected {
        return Ok(());
    }
    Err(BrainError::Length {
        field,
        expected,
        actual,
    })
}

/// Activities of a map for a block of movements, and their averages before each.
struct Activities<'a> {
    neurons: usize,
    now: &'a [f32],
    mean: Vec<f32>,
}

impl Activities<'_> {
    /// The programs' values for the neurons of a tile, as `[movement][program]`.
    fn signals(&self, programs: &[Program], tile: usize) -> Vec<Tile> {
        let mut memory: Vec<_> = programs.iter().map(Program::memory).collect();
        let mut signals = Vec::new();
        let rows = self.now.chunks_exact(self.neurons);
        for (now, mean) in rows.zip(self.mean.chunks_exact(self.neurons)) {
            let [now, mean] = [now, mean].map(|row| padded(part(row, tile)));
            let values = programs.iter().zip(&mut memory);
            signals.extend(values.map(|(program, memory)| program.value(&now, &[mean], memory)));
        }
        signals
    }

    /// Activity and average of a neuron in movement `m`.
    fn of(&self, m: usize, neuron: usize) -> [f32; 2] {
        let at = m * self.neurons + neuron;
        [self.now[at], self.mean[at]]
    }
}

/// What the rule is given for a block of movements.
struct Block<'a> {
    rule: &'a Compiled,
    input: Activities<'a>,
    output: Activities<'a>,
    /// Signals of the output as `[output neuron][movement][signal]`.
    post: Vec<f32>,
    /// How each output neuron learns in the movements.
    runs: Vec<Vec<Run<'a>>>,
}

/// Movements in a row in which an output neuron learns by the same program.
struct Run<'a> {
    movements: Range<usize>,
    program: &'a Program,
    /// Rates of the movements, if it is a decay.
    rates: Option<Vec<f32>>,
}

impl<'a> Block<'a> {
    /// The activities `g` and `a`; the averages move to their values after the block.
    fn new(
        rule: &'a Compiled,
        g: &'a [f32],
        a: &'a [f32],
        xi: f32,
        association: &mut Association,
    ) -> Result<Self, BrainError> {
        let (n_in, n_out) = (association.n_in(), association.n_out());
        let (mut g_mean, mut a_mean) = (Vec::with_capacity(g.len()), Vec::with_capacity(a.len()));
        for (g, a) in g.chunks_exact(n_in).zip(a.chunks_exact(n_out)) {
            g_mean.extend_from_slice(association.g_mean());
            a_mean.extend_from_slice(association.a_mean());
            association.move_means(g, a, xi)?;
        }
        let activities = |neurons, now, mean| Activities { neurons, now, mean };
        let mut block = Self {
            rule,
            input: activities(n_in, g, g_mean),
            output: activities(n_out, a, a_mean),
            post: Vec::new(),
            runs: Vec::new(),
        };
        block.compute_post();
        Ok(block)
    }

    fn movements(&self) -> usize {
        self.output.now.len() / self.output.neurons
    }

    fn compute_post(&mut self) {
        for tile in 0..self.output.neurons.div_ceil(LANES) {
            let signals = self.output.signals(&self.rule.post, tile);
            for lane in 0..LANES.min(self.output.neurons - tile * LANES) {
                self.post.extend(signals.iter().map(|signal| signal[lane]));
            }
        }
        self.runs = (0..self.output.neurons).map(|j| self.runs_of(j)).collect();
    }

    /// The runs of output neuron `j`.
    fn runs_of(&self, j: usize) -> Vec<Run<'a>> {
        let mut runs: Vec<Run<'a>> = Vec::new();
        for m in 0..self.movements() {
            let Some(program) = self.program(j, m) else {
                continue;
            };
            match runs.last_mut() {
                Some(run) if run.movements.end == m && ptr::eq(run.program, program) => {
                    run.movements.end += 1;
                }
                _ => runs.push(Run {
                    movements: m..m + 1,
                    program,
                    rates: None,
                }),
            }
        }
        for run in &mut runs {
            let movements = run.movements.clone();
            let rates = |signal| movements.map(|m| self.post_of(j, m)[signal]).collect();
            run.rates = run.program.decay().map(rates);
        }
        runs
    }

    /// The program for the change of weights to output neuron `j` in movement `m`; none if they do not change.
    fn program(&self, j: usize, m: usize) -> Option<&'a Program> {
        let post = self.post_of(j, m);
        let is_zero = |term: &Vec<usize>| term.iter().any(|&factor| post[factor] == 0.0);
        if self.rule.factored.iter().all(is_zero) {
            return self.rule.rest.as_ref();
        }
        Some(&self.rule.change)
    }

    /// Signals of output neuron `j` in movement `m`.
    fn post_of(&self, j: usize, m: usize) -> &[f32] {
        let signals = self.rule.post.len();
        &self.post[(j * self.movements() + m) * signals..][..signals]
    }

    /// Changes all weights `w` (outputs × inputs).
    fn learn(&self, w: &mut [f32]) -> Result<(), AgentError> {
        let n_in = self.input.neurons;
        let mut memory = self.rule.memory();
        for tile in 0..n_in.div_ceil(LANES) {
            let pre = self.input.signals(&self.rule.pre, tile);
            for (j, w_j) in w.chunks_exact_mut(n_in).enumerate() {
                let weights = &mut w_j[tile * LANES..n_in.min((tile + 1) * LANES)];
                let (mut before, mut after) = (&mut padded(weights), &mut [0.0; LANES]);
                for run in &self.runs[j] {
                    if let Some(rates) = &run.rates {
                        run.program.decay_by(rates, before);
                        continue;
                    }
                    for m in run.movements.clone() {
                        self.change(j, (m, run.program), &pre, before, &mut memory, after);
                        swap(&mut before, &mut after);
                    }
                }
                let changed = &before[..weights.len()];
                if !changed.iter().all(|w| w.is_finite()) {
                    return Err(self.not_finite(j, tile, &pre, weights));
                }
                weights.copy_from_slice(changed);
            }
        }
        Ok(())
    }

    /// The program for a tile of weights to output neuron `j` in movement `m`.
    fn change(
        &self,
        j: usize,
        (m, program): (usize, &Program),
        pre: &[Tile],
        w: &Tile,
        memory: &mut [Tile],
        changed: &mut Tile,
    ) {
        let signals = self.rule.pre.len();
        let pre = &pre[m * signals..][..signals];
        program.add_to(w, self.post_of(j, m), pre, memory, changed);
    }

    /// The error for the first weight of a tile that becomes no finite number.
    fn not_finite(&self, j: usize, tile: usize, pre: &[Tile], weights: &[f32]) -> AgentError {
        let mut memory = self.rule.memory();
        let mut w = padded(weights);
        let mut movements = self.runs[j].iter().flat_map(|run| {
            let movements = run.movements.clone();
            movements.map(move |m| (m, run.program))
        });
        let found = movements.find_map(|(m, program)| {
            let before = w;
            self.change(j, (m, program), pre, &before, &mut memory, &mut w);
            let lane = w[..weights.len()].iter().position(|w| !w.is_finite())?;
            let i = tile * LANES + lane;
            let [a, a_mean] = self.output.of(m, j);
            let [g, g_mean] = self.input.of(m, i);
            Some(format!(
                "the weight from input neuron {i} to output neuron {j} would become {}, which is not finite, with \
                 a = {a}, a_mean = {a_mean}, g = {g}, g_mean = {g_mean}, w = {}",
                w[lane], before[lane]
            ))
        });
        AgentError::Rule {
            problem: found
                .unwrap_or_else(|| format!("a weight to output neuron {j} is not finite")),
        }
    }
}

/// The part of a row that belongs to a tile.
fn part(row: &[f32], tile: usize) -> &[f32] {
    &row[tile * LANES..row.len().min((tile + 1) * LANES)]
}

/// A tile that begins with these numbers and goes on with zeros.
fn padded(part: &[f32]) -> Tile {
    let mut tile = [0.0; LANES];
    tile[..part.len()].copy_from_slice(part);
    tile
}
