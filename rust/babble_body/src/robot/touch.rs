//! Contact forces of the last physics step.

use super::contact_slots::{OBSTACLE, SUPPORT};
use super::links::ContactRegion;
use super::model::Robot;
use super::world::World;

/// Normal forces on the object, and whether arm or hand met the obstacle, in one physics step. A force
/// above zero is a contact.
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
    /// Of the obstacle \[N\].
    pub obstacle: f64,
    /// Whether arm or hand touches the obstacle.
    pub collision: bool,
}

impl Touch {
    /// Whether any part of arm or hand touches the object.
    #[must_use]
    pub fn any(&self) -> bool {
        self.arm > 0.0 || self.palm > 0.0 || self.thumb > 0.0 || self.fingers > 0.0
    }

    /// Whether something helps the hand to press the object: upper arm, forearm or obstacle. An open
    /// hand can pin an object against each of them. The support only carries it.
    #[must_use]
    pub fn pinned(&self) -> bool {
        self.arm > 0.0 || self.obstacle > 0.0
    }

    /// Whether the hand has the object between fingers and thumb or fingers and palm, and nothing but
    /// the support helps.
    #[must_use]
    pub fn encloses(&self) -> bool {
        self.fingers > 0.0 && (self.thumb > 0.0 || self.palm > 0.0) && !self.pinned()
    }
}

impl Robot {
    /// Forces and contacts of the last physics step.
    #[must_use]
    pub fn touch(&self, world: &World) -> Touch {
        let mut touch = Touch {
            support: world.mechanics.impulses[SUPPORT] / self.dt,
            obstacle: world.mechanics.impulses[OBSTACLE] / self.dt,
            collision: world.mechanics.hit,
            ..Touch::default()
        };
        for (region, impulse) in self.regions.iter().zip(world.mechanics.impulses) {
            let force = impulse / self.dt;
            match region {
                ContactRegion::Arm => touch.arm += force,
                ContactRegion::Palm => touch.palm += force,
                ContactRegion::Thumb => touch.thumb += force,
                ContactRegion::Fingers => touch.fingers += force,
            }
        }
        touch
    }

    /// Normal forces of upper arm, forearm and the back of the hand on the object in the last physics
    /// step \[N\]. The palm is one solid: its force is the back's while the object is behind it.
    #[must_use]
    pub fn arm_touch(&self, world: &World) -> [f64; 3] {
        // The first solids, in the order of the links.
        let [upper_arm, forearm, palm, ..] = world.mechanics.impulses;
        let object = self.palm(world).local_from_world(&self.object(world));
        let back = if object.y < 0.0 { palm } else { 0.0 };
        [upper_arm, forearm, back].map(|impulse| impulse / self.dt)
    }

    /// How deep the object was inside of arm and hand as the last step began \[m\]; 0 if it was not.
    #[must_use]
    pub fn penetration(&self, world: &World) -> f64 {
        world.mechanics.depth
    }
}
