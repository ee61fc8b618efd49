//! What touches what, and how hard.

use rapier3d::prelude::*;

use super::Robot;
use super::links::Part;
use super::world::World;

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

/// What a collider is: kept in the engine's user data of it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Thing {
    Robot(Part),
    Object,
    Support,
    Obstacle,
}

impl Thing {
    const ALL: [Self; 7] = [
        Self::Robot(Part::Arm),
        Self::Robot(Part::Palm),
        Self::Robot(Part::Thumb),
        Self::Robot(Part::Fingers),
        Self::Object,
        Self::Support,
        Self::Obstacle,
    ];

    pub(super) fn code(self) -> u128 {
        Self::ALL
            .iter()
            .position(|&thing| thing == self)
            .map_or(0, |code| code as u128)
    }

    fn of(collider: &Collider) -> Self {
        Self::ALL[collider.user_data as usize % Self::ALL.len()]
    }

    /// What each thing may touch: arm and hand pass through themselves and the support.
    pub(super) fn groups(self) -> InteractionGroups {
        const ROBOT: Group = Group::GROUP_1;
        const OBJECT: Group = Group::GROUP_2;
        const SUPPORT: Group = Group::GROUP_3;
        const OBSTACLE: Group = Group::GROUP_4;
        let (member, filter) = match self {
            Self::Robot(_) => (ROBOT, OBJECT | OBSTACLE),
            Self::Object => (OBJECT, ROBOT | SUPPORT | OBSTACLE),
            Self::Support => (SUPPORT, OBJECT),
            Self::Obstacle => (OBSTACLE, ROBOT | OBJECT),
        };
        InteractionGroups::new(member, filter, InteractionTestMode::And)
    }
}

impl Robot {
    /// Forces and contacts of the last physics step.
    #[must_use]
    pub fn touch(&self, world: &World) -> Touch {
        let mut touch = Touch::default();
        for pair in world.narrow_phase.contact_pairs_with(self.object_collider) {
            let force = self.normal_force(pair);
            match Thing::of(&world.colliders[other(pair, self.object_collider)]) {
                Thing::Robot(Part::Arm) => touch.arm += force,
                Thing::Robot(Part::Palm) => touch.palm += force,
                Thing::Robot(Part::Thumb) => touch.thumb += force,
                Thing::Robot(Part::Fingers) => touch.fingers += force,
                Thing::Support => touch.support += force,
                Thing::Object | Thing::Obstacle => {}
            }
        }
        touch.obstacle = world
            .narrow_phase
            .contact_pairs_with(self.obstacle)
            .any(|pair| {
                let other = other(pair, self.obstacle);
                other != self.object_collider && self.normal_force(pair) > 0.0
            });
        touch
    }

    /// How deep the object is inside of arm and hand \[m\]; 0 if it is not.
    #[must_use]
    pub fn penetration(&self, world: &World) -> f64 {
        world
            .narrow_phase
            .contact_pairs_with(self.object_collider)
            .filter(|pair| other(pair, self.object_collider) != self.support)
            .flat_map(ContactPair::manifolds)
            .flat_map(|manifold| &manifold.points)
            .map(|point| f64::from(-point.dist))
            .fold(0.0, f64::max)
    }

    fn normal_force(&self, pair: &ContactPair) -> f64 {
        let points = pair.solver_manifolds().iter().flat_map(|m| &m.points);
        let impulse: f32 = points.map(|point| point.data.impulse).sum();
        f64::from(impulse) / f64::from(self.parameters.dt)
    }
}

fn other(pair: &ContactPair, one: ColliderHandle) -> ColliderHandle {
    if pair.collider1 == one {
        pair.collider2
    } else {
        pair.collider1
    }
}
