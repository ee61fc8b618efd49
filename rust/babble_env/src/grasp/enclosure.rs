//! When a grasp counts: enclosed, then held without support.
//!
//! Contact alone or nearness alone is fooled by a ball that is wedged between hand and support, so
//! the support is taken away and the hand must keep the ball.

use serde::{Deserialize, Serialize};

use super::numbers::GraspNumbers;

/// How far a grasp has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Grip {
    /// Not enclosed yet.
    Open,
    /// Enclosed; held without support since so many control steps.
    Tried(u32),
    /// Held long enough.
    Held,
    /// Not held when it was tried.
    Failed,
}

/// Counts physics steps with an enclosing contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Enclosure {
    /// How far it has come.
    pub grip: Grip,
    /// Physics steps with contact in each of the last control steps, newest last.
    contacts: Vec<u8>,
}

impl Default for Enclosure {
    fn default() -> Self {
        Self {
            grip: Grip::Open,
            contacts: Vec::new(),
        }
    }
}

impl Enclosure {
    /// One control step with `contacts` physics steps of enclosing contact. `in_hand`: whether the
    /// object is before the palm now. True if the support has to go.
    pub(super) fn step(&mut self, numbers: &GraspNumbers, contacts: u8, in_hand: bool) -> bool {
        let window = numbers.hold_steps as usize;
        if self.contacts.len() == window {
            self.contacts.remove(0);
        }
        self.contacts.push(contacts);
        let whole = f64::from(numbers.hold_steps * numbers.physics_steps);
        match self.grip {
            Grip::Open => {
                let full = self.contacts.len() == window;
                if full && in_hand && self.sum() >= numbers.enclosed_share * whole {
                    self.grip = Grip::Tried(0);
                    self.contacts.clear();
                    return true;
                }
            }
            Grip::Tried(steps) => {
                let steps = steps + 1;
                let missed = f64::from(steps * numbers.physics_steps) - self.sum();
                self.grip = if missed >= (1.0 - numbers.held_share) * whole {
                    Grip::Failed
                } else if steps == numbers.hold_steps {
                    Grip::Held
                } else {
                    Grip::Tried(steps)
                };
            }
            Grip::Held | Grip::Failed => {}
        }
        false
    }

    /// Share of the window with an enclosing contact, in [0, 1].
    #[must_use]
    pub fn share(&self, numbers: &GraspNumbers) -> f64 {
        if self.grip == Grip::Open {
            self.sum() / f64::from(numbers.hold_steps * numbers.physics_steps)
        } else {
            1.0
        }
    }

    fn sum(&self) -> f64 {
        self.contacts.iter().map(|&n| f64::from(n)).sum()
    }
}
