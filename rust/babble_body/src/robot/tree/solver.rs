//! Velocities at the end of a step in which things touch.
//!
//! They are the least of a convex function, with `H v = b` the equations without contacts,
//!
//! ```text
//! ½ vᵀH v − bᵀv + Σ (1/2γ) max(0, v̂ − v_n)² + Σ μ λ₀ √(|v_t|² + v_s²)
//! ```
//!
//! A contact's normal impulse λ = max(0, v̂ − `v_n`)/γ is that of a spring of stiffness k and a damper
//! k τ at the end of the step: v̂ = d/(τ + dt), γ = 1/(dt k (τ + dt)) for a depth d; surfaces that are
//! apart may close their gap, v̂ = d/dt. Friction is Coulomb's with the normal impulse λ₀ of the last
//! step, which keeps the function convex without lifting what slides (Castro et al., *Irrotational
//! contact fields*, 2023); `v_s` smooths it at rest.

use std::ops::Range;

use nalgebra::Vector3;

use super::contact_cost::ContactCost;
use super::equations::Equations;
use super::factor::{BALL, Matrix, SIZE, Velocities};
use super::line::Line;
use super::model::Tree;
use super::moving_contact::MovingContact;
use super::speeds::Speeds;
use crate::robot::contact_slots::SOLIDS;
use crate::robot::kinematics::{LinkPose, MAX_JOINTS, place};
use crate::robot::links::FOREARM;
use crate::robot::mechanics::MechanicalState;

/// Velocities of shoulder and elbow.
const ARM: Range<usize> = BALL..BALL + FOREARM + 1;
/// Newton steps at most; a handful is usual.
const MAX_STEPS: usize = 50;
/// The last step's gain, as a share of the energy of a ball at 1 m/s.
const TOLERANCE: f64 = 1e-12;

impl Tree {
    /// Velocities at the end of the step.
    pub(super) fn with_contacts(
        &self,
        mechanics: &MechanicalState,
        poses: &[LinkPose; MAX_JOINTS],
        equations: &Equations,
        free: Velocities,
        costs: &[ContactCost<'_>],
    ) -> Velocities {
        if costs.is_empty() {
            return free;
        }
        let coupled = costs.iter().any(|cost| cost.contact.chain.moves());
        let end = if coupled { self.sparsity.size() } else { BALL };
        let mut velocities = free;
        self.begin(mechanics, poses, end, &mut velocities);
        let mut problem = Problem {
            tree: self,
            equations,
            contacts: costs.iter().map(MovingContact::new).collect(),
            end,
            velocities,
            slopes: [0.0; SIZE],
        };
        if !problem.solve(TOLERANCE * self.mass(&mechanics.ball)) {
            self.note_unconverged();
        }
        problem.velocities
    }

    /// Where to begin. A ball that the hand touches moves with the forearm as before, and that as if
    /// nothing touched it: then surfaces that stick nearly do so at once.
    fn begin(
        &self,
        mechanics: &MechanicalState,
        poses: &[LinkPose; MAX_JOINTS],
        end: usize,
        velocities: &mut Velocities,
    ) {
        let ball = &mechanics.ball;
        let (mut velocity, mut spin) = (ball.velocity, ball.spin);
        if end > BALL {
            velocities[ARM.end..end].copy_from_slice(&mechanics.v[FOREARM + 1..end - BALL]);
        }
        if mechanics.impulses[..SOLIDS]
            .iter()
            .any(|&impulse| impulse > 0.0)
        {
            let arm = &self.links[..=FOREARM];
            let before = place(arm, |i| mechanics.q[i] - self.dt * mechanics.v[i]);
            let old = Speeds::of(arm, &before, &mechanics.v);
            let new = Speeds::of(arm, poses, &velocities[ARM]);
            let there = (ball.centre - ball.velocity * self.dt).xy();
            let (was, is) = (
                old.at(FOREARM, &before, there),
                new.at(FOREARM, poses, ball.centre.xy()),
            );
            let back = before[FOREARM].frame().rotation.transpose();
            let turn = poses[FOREARM].frame().rotation * back;
            velocity = turn * (velocity - was.push(0.0)) + is.push(0.0);
            let turns = [&old, &new].map(|speeds| Vector3::z() * speeds.turn(FOREARM));
            spin = turn * (spin - turns[0]) + turns[1];
        }
        velocities[..3].copy_from_slice(velocity.as_slice());
        velocities[3..BALL].copy_from_slice(spin.as_slice());
    }
}

/// The function, and where the search for its least is.
struct Problem<'a> {
    tree: &'a Tree,
    equations: &'a Equations,
    /// All contacts as they move there.
    contacts: Vec<MovingContact<'a>>,
    /// Velocities from here on are not changed: the joints' where no contact joins them to the ball.
    end: usize,
    velocities: Velocities,
    /// Slopes of the function there.
    slopes: Velocities,
}

impl Problem<'_> {
    /// Newton's method until a step would gain no more than `enough` \[J\]. Whether it got there.
    fn solve(&mut self, enough: f64) -> bool {
        self.slope();
        for _ in 0..MAX_STEPS {
            let factors = self.factors();
            let (direction, gain) = self.direction(&factors);
            if !is_downhill(gain) {
                // At the least, rounding alone decides about the sign of what is left.
                return gain.abs() <= enough;
            }
            let share = self.search(&direction, gain);
            self.go(&direction, share);
            if gain <= enough {
                return true;
            }
            // Near the least, curvature hardly changes: a step with the factors at hand is enough.
            self.slope();
            let (direction, gain) = self.direction(&factors);
            if gain <= enough && is_downhill(gain) {
                self.go(&direction, 1.0);
                return true;
            }
        }
        false
    }

    fn slope(&mut self) {
        let Equations { matrix, rhs } = self.equations;
        let sparsity = &self.tree.sparsity;
        self.slopes = sparsity.product(matrix, &self.velocities, self.end);
        for k in 0..self.end {
            self.slopes[k] -= rhs[k];
        }
        for moving in &mut self.contacts {
            moving.move_with(&self.velocities);
            let contact = &moving.cost.contact;
            contact.apply(&-moving.impulse, &mut self.slopes);
        }
    }

    /// Factors of the function's curvature.
    fn factors(&self) -> Matrix {
        let mut matrix = self.equations.matrix;
        for moving in &self.contacts {
            let contact = &moving.cost.contact;
            contact.add(&moving.curvature(), &mut matrix);
        }
        self.tree.sparsity.factor::<0>(&mut matrix, self.end);
        matrix
    }

    /// Newton's step with the curvature of here, or of one step before, and how fast the function falls
    /// along it at first \[J\].
    fn direction(&self, factors: &Matrix) -> (Velocities, f64) {
        let mut direction = self.slopes.map(|slope| -slope);
        let sparsity = &self.tree.sparsity;
        sparsity.solve::<0>(factors, &mut direction, self.end);
        let gain = -self.dot(&self.slopes, &direction);
        (direction, gain)
    }

    fn dot(&self, a: &Velocities, b: &Velocities) -> f64 {
        (0..self.end).map(|k| a[k] * b[k]).sum()
    }

    fn go(&mut self, direction: &Velocities, share: f64) {
        for k in 0..self.end {
            self.velocities[k] += share * direction[k];
        }
    }

    /// The share of a step after which the function rises no more, roughly.
    fn search(&mut self, direction: &Velocities, gain: f64) -> f64 {
        const ROUGHLY: f64 = 0.1;
        const TRIES: usize = 30;
        let line = self.line(direction, gain);
        let [mut low, mut high] = [(0.0, -gain), (1.0, line.slope(1.0))];
        if high.1 <= ROUGHLY * gain {
            return 1.0;
        }
        let mut share = 1.0;
        for _ in 0..TRIES {
            // Regula falsi, Illinois' way: an end that stays counts half.
            share = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let slope = line.slope(share);
            if slope.abs() <= ROUGHLY * gain {
                break;
            }
            if slope > 0.0 {
                high = (share, slope);
                low.1 *= 0.5;
            } else {
                low = (share, slope);
                high.1 *= 0.5;
            }
        }
        share
    }

    fn line(&mut self, direction: &Velocities, gain: f64) -> Line<'_> {
        let sparsity = &self.tree.sparsity;
        let changed = sparsity.product(&self.equations.matrix, direction, self.end);
        let quadratic = self.dot(&changed, direction);
        let mut pushed = 0.0;
        for moving in &mut self.contacts {
            moving.change = moving.cost.contact.relative(direction);
            pushed += moving.impulse.dot(&moving.change);
        }
        Line {
            linear: pushed - gain,
            quadratic,
            contacts: &self.contacts,
        }
    }
}

/// False where rounding left nothing of the curvature: links of a milligram, contacts of 10⁷ N/m.
fn is_downhill(gain: f64) -> bool {
    gain >= 0.0 && gain.is_finite()
}
