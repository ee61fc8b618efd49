//! Where an agent is in the chain that it plays.

use super::route::RouteChoice;

/// A link of the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The elbow folds, the hand a fist.
    Fold,
    /// The shoulder turns.
    Turn,
    /// The elbow extends.
    Extend,
    /// The arm goes before the object.
    Reach,
    /// The hand opens there.
    Open,
    /// The arm advances until the palm touches.
    Advance,
    /// The hand closes, the arm stays.
    Close,
}

/// Postures of a chain that is played \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Targets {
    pub pregrasp: [f64; 2],
    pub contact: [f64; 2],
    pub hand: [f64; 2],
    /// Recalled flexion of the fingers around the object, over 90°.
    pub grip: f64,
}

/// A chain under way.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainPlan {
    /// Which link is played.
    pub phase: Phase,
    /// Control steps made of it.
    pub step: u32,
    /// The way that was chosen at the beginning.
    pub choice: RouteChoice,
    pub(super) targets: Targets,
    /// Shoulder and elbow when this link began \[rad\].
    pub(super) from: [f64; 2],
    /// Whether the hand is a fist on its way.
    pub(super) fist: bool,
    /// Control steps without a grip.
    pub(super) loose: u32,
}

impl ChainPlan {
    /// Whether this link is done, or has had its steps.
    pub(super) fn is_over(&self, done: bool, steps: u32) -> bool {
        done || self.step >= steps
    }

    /// Begins a link with the arm in a posture \[rad\].
    pub(super) fn enter(&mut self, phase: Phase, arm: [f64; 2]) {
        self.phase = phase;
        self.step = 0;
        self.loose = 0;
        self.from = arm;
    }
}
