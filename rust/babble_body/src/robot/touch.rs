//! What touches what, and how hard.

use super::Robot;
use super::links::ContactRegion;
use super::world::World;

/// Solids of arm and hand: two of the arm, the palm, four fingers and a thumb.
pub(super) const SOLIDS: usize = 19;
/// Where the support's impulse is kept.
pub(super) const SUPPORT: usize = SOLIDS;
/// Where the impulse between object and obstacle is kept.
pub(super) const OBSTACLE: usize = SOLIDS + 1;
/// All that can touch the object: the solids of arm and hand in the order of the links, the
/// support, the obstacle.
pub(super) const SLOTS: usize = SOLIDS + 2;

/// Normal forces on the object, and whether the obstacle was hit, in one physics step. A force above
/// zero is a contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touch {
    /// Of upper arm and forearm \[N\].
    pub arm: f64,
    /// Of the palm \[N\].
    pub palm: f64,
    /// Of the thumb \[N\].
    pub thumb: f64,
    /// Of the fingers \[N\].
    pub fingers: f64,
    /// Of the support \[N\].
    pub support: f64,
    /// Whether arm or hand touches the obstacle.
    pub obstacle: bool,
}

impl Touch {
    /// Whether any part of arm or hand touches the object.
    #[must_use]
    pub fn any(&self) -> bool {
        self.arm > 0.0 || self.palm > 0.0 || self.thumb > 0.0 || self.fingers > 0.0
    }

    /// Whether the object is held between fingers and thumb or fingers and palm.
    #[must_use]
    pub fn encloses(&self) -> bool {
        self.fingers > 0.0 && (self.thumb > 0.0 || self.palm > 0.0)
    }
}

impl Robot {
    /// Forces and contacts of the last physics step.
    #[must_use]
    pub fn touch(&self, world: &World) -> Touch {
        let mut touch = Touch {
            support: world.impulses[SUPPORT] / self.dt,
            obstacle: world.hit,
            ..Touch::default()
        };
        for (part, impulse) in self.parts.iter().zip(world.impulses) {
            let force = impulse / self.dt;
            match part {
                ContactRegion::Arm => touch.arm += force,
                ContactRegion::Palm => touch.palm += force,
                ContactRegion::Thumb => touch.thumb += force,
                ContactRegion::Fingers => touch.fingers += force,
            }
        }
        touch
    }

    /// How deep the object was inside of arm and hand as the last step began \[m\]; 0 if it was not.
    #[must_use]
    pub fn penetration(&self, world: &World) -> f64 {
        world.depth
    }
}
