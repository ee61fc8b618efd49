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
    /// The arm carries the object to its goal.
    Carry,
}

impl Phase {
    /// Its name in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::Turn => "turn",
            Self::Extend => "extend",
            Self::Reach => "reach",
            Self::Open => "open",
            Self::Advance => "advance",
            Self::Close => "close",
            Self::Carry => "carry",
        }
    }
}

/// Postures of a grasp \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Targets {
    /// Shoulder and elbow before the grasp.
    pub pregrasp: [f64; 2],
    /// Shoulder and elbow when the palm touches.
    pub contact: [f64; 2],
    /// Flexions of thumb and finger once the hand closes.
    pub hand: [f64; 2],
    /// Expected flexion of the fingers around the object, over 90°.
    pub grip: f64,
}

/// An object that is to be carried.
#[derive(Debug, Clone, PartialEq)]
pub struct Carrying {
    /// Shoulder and elbow that hold it at its goal \[rad\].
    pub(super) posture: [f64; 2],
    /// Control steps with a grip.
    pub(super) gripped: u32,
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
    /// How the object is to be carried, if it is.
    pub(super) carrying: Option<Carrying>,
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
