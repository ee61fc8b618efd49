//! When a grasp counts: enclosed, then held without support.
//!
//! A held object follows the hand. Contact alone or nearness alone is fooled by an object that
//! something else helps to press. So for a second the hand must enclose it, then the support is taken
//! away, and for another second the hand must keep it. In both seconds a contact counts only while
//! nothing else presses the object: an open hand pins it against an obstacle, a bent elbow against the
//! upper arm, and a curled finger against the forearm. The support may carry the object in the first
//! second, as objects lie on it, and is gone in the second one. What is left then is the object's
//! weight, and only forces from several sides of the hand balance that with friction.
//!
//! With the option `support_stays` the support carries the object in both seconds: a hold is then an
//! enclosure of two seconds. It lasts while the hand encloses the object, and can be tried again.

use babble_body::robot::Touch;
use serde::{Deserialize, Serialize};

use super::config::GraspConfig;
use crate::check::ensure;
use crate::error::EnvError;

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

/// In how many physics steps of a control step what part of the hand touched the object, while neither
/// arm nor obstacle did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Contacts {
    /// Fingers and thumb, or fingers and palm: the hand encloses it.
    pub enclosing: u8,
    /// Fingers.
    pub fingers: u8,
    /// Thumb or palm.
    pub opposite: u8,
}

impl Contacts {
    /// Counts one physics step.
    pub(super) fn add(&mut self, touch: &Touch) {
        if touch.pinned() {
            return;
        }
        let (fingers, opposite) = (touch.fingers > 0.0, touch.thumb > 0.0 || touch.palm > 0.0);
        self.fingers += u8::from(fingers);
        self.opposite += u8::from(opposite);
        self.enclosing += u8::from(touch.encloses());
    }
}

/// Watches contacts until a grasp is enclosed, tried and held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Enclosure {
    /// How far it has come.
    pub grip: Grip,
    /// Of the last control steps, newest last.
    recent: Vec<Contacts>,
    /// Physics steps without an enclosing contact since the support went.
    missed: u32,
}

impl Default for Enclosure {
    fn default() -> Self {
        Self {
            grip: Grip::Open,
            recent: Vec::new(),
            missed: 0,
        }
    }
}

impl Enclosure {
    /// One control step with its contacts. `in_hand`: whether the object is before the palm now.
    /// True if the support has to go.
    pub fn step(&mut self, numbers: &GraspConfig, contacts: Contacts, in_hand: bool) -> bool {
        let window = numbers.hold_steps as usize;
        if self.recent.len() == window {
            self.recent.remove(0);
        }
        self.recent.push(contacts);
        let whole = numbers.hold_steps * numbers.physics_steps;
        match self.grip {
            Grip::Open => {
                let enclosing = self.sum(|contacts| contacts.enclosing);
                let full = self.recent.len() == window;
                if full && in_hand && enclosing >= numbers.enclosed_share * f64::from(whole) {
                    self.grip = Grip::Tried(0);
                    return true;
                }
            }
            Grip::Tried(steps) => {
                self.missed += numbers.physics_steps - u32::from(contacts.enclosing);
                let steps = steps + 1;
                // With no further miss it would still not exceed the share.
                let most = f64::from(whole.saturating_sub(self.missed));
                self.grip = if most <= numbers.held_share * f64::from(whole) {
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

    /// On a support that stays: a grasp that failed, or that was held and is let go, can be tried
    /// again.
    pub fn try_again(&mut self, numbers: &GraspConfig) {
        let whole = f64::from(numbers.hold_steps * numbers.physics_steps);
        let encloses = self.sum(|contacts| contacts.enclosing) > numbers.held_share * whole;
        if self.grip == Grip::Failed || (self.grip == Grip::Held && !encloses) {
            self.grip = Grip::Open;
            self.missed = 0;
        }
    }

    /// How much of the last second the hand had the object between its sides, in \[0, 1\]: half of it
    /// is the share with a finger's contact, half that with the thumb's or the palm's.
    #[must_use]
    pub fn share(&self, numbers: &GraspConfig) -> f64 {
        let both = self.sum(|contacts| contacts.fingers) + self.sum(|contacts| contacts.opposite);
        both / f64::from(2 * numbers.hold_steps * numbers.physics_steps)
    }

    /// Checks what somebody else wrote of an episode of so many control steps.
    pub(super) fn check(&self, numbers: &GraspConfig, steps: u32) -> Result<(), EnvError> {
        let most = numbers.hold_steps.min(steps) as usize;
        let seen = self.recent.len();
        ensure(seen <= most, || {
            format!("{seen} control steps of contacts, not at most {most}")
        })?;
        let counted = |contacts: &Contacts| {
            let all = [contacts.enclosing, contacts.fingers, contacts.opposite];
            all.iter().all(|&n| u32::from(n) <= numbers.physics_steps)
        };
        ensure(self.recent.iter().all(counted), || {
            format!("more contacts than {} physics steps", numbers.physics_steps)
        })?;
        let both =
            |contacts: &Contacts| contacts.enclosing <= contacts.fingers.min(contacts.opposite);
        ensure(self.recent.iter().all(both), || {
            "an object is enclosed, and one side of the hand does not touch it".to_owned()
        })?;
        let whole = numbers.hold_steps * numbers.physics_steps;
        ensure(self.missed <= whole, || {
            format!("{} contacts missed of {whole}", self.missed)
        })?;
        let held = matches!(self.grip, Grip::Tried(steps) if steps >= numbers.hold_steps);
        ensure(!held, || "a grasp is held, and tried still".to_owned())
    }

    fn sum(&self, of: impl Fn(&Contacts) -> u8) -> f64 {
        self.recent
            .iter()
            .map(|contacts| f64::from(of(contacts)))
            .sum()
    }
}
