//! The robot that grasps, as params, and what can be asked of its world.

use nalgebra::Vector3;

use super::any_engine::AnyEngine;
use super::kinematics::{MAX_JOINTS, place};
use super::links::{ContactRegion, FOREARM, Link, links, palm_length};
use super::mechanics::{MechanicalState, MovingBall};
use super::muscles::{MuscleCommands, MuscleModel, Posture};
use super::setup::Setup;
use super::world::World;
use crate::config::Body;
use crate::geometry::frame::Frame;

/// Arm, hand and everything around them, as params.
#[derive(Debug, Clone)]
pub struct Robot {
    pub(super) body: Body,
    pub(super) links: Vec<Link>,
    /// The region of each solid of the links.
    pub(super) regions: Vec<ContactRegion>,
    muscles: MuscleModel,
    pub(super) dt: f64,
    pub(super) engine: AnyEngine,
}

impl Robot {
    /// The robot of `body`, stepped by `dt` \[s\].
    #[must_use]
    pub fn new(body: &Body, dt: f64) -> Self {
        let links = links(body);
        let solids = links.iter().flat_map(|link| &link.solids);
        Self {
            regions: solids.map(|&(region, _)| region).collect(),
            muscles: MuscleModel::new(body, &links),
            engine: AnyEngine::new(body, &links, dt),
            body: body.clone(),
            links,
            dt,
        }
    }

    /// The body it was made from.
    #[must_use]
    pub const fn body(&self) -> &Body {
        &self.body
    }

    /// Lowest and highest equilibrium point of each joint group \[rad\].
    #[must_use]
    pub const fn ranges(&self) -> &[[f64; 2]; 4] {
        &self.muscles.ranges
    }

    /// The open hand with the arm in a posture \[rad\].
    #[must_use]
    pub fn open_hand(&self, arm: [f64; 2]) -> Posture {
        [arm[0], arm[1], self.ranges()[2][0], self.ranges()[3][0]]
    }

    /// A posture moved into the joint ranges.
    #[must_use]
    pub fn clamp(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| posture[i].clamp(self.ranges()[i][0], self.ranges()[i][1]))
    }

    /// A posture as shares of the joint ranges.
    #[must_use]
    pub fn normalised(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges()[i];
            (posture[i] - low) / (high - low)
        })
    }

    /// The posture at the given shares of the joint ranges.
    #[must_use]
    pub fn denormalised(&self, share: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges()[i];
            low + share[i] * (high - low)
        })
    }

    /// A world as `setup` has it, at rest.
    #[must_use]
    pub fn world(&self, setup: &Setup) -> World {
        let mut q = [0.0; MAX_JOINTS];
        for (q, link) in q.iter_mut().zip(&self.links) {
            *q = setup.posture[link.muscle.index()];
        }
        let [x, y] = setup.ball.centre;
        let ball = MovingBall::at_rest(Vector3::new(x, y, 0.0), setup.ball.radius);
        let mut mechanics = MechanicalState::at_rest(q, ball, setup.obstacle);
        mechanics.support = setup.support;
        self.begin(mechanics)
    }

    fn begin(&self, mechanics: MechanicalState) -> World {
        let engine = self.engine.start(&mechanics);
        World { mechanics, engine }
    }

    /// A world with every joint at its angle, in the order of [`Self::joint_angles`] \[rad\], and the
    /// object at a point \[m\]: to be looked at.
    #[must_use]
    pub fn posed(&self, joints: &[f64], object: &Vector3<f64>) -> World {
        let mut q = [0.0; MAX_JOINTS];
        for (q, angle) in q.iter_mut().zip(joints) {
            *q = *angle;
        }
        let ball = MovingBall::at_rest(*object, 0.0);
        self.begin(MechanicalState::at_rest(q, ball, None))
    }

    /// Physics steps of this robot in which the contact solver did not converge, in all its worlds
    /// together; none if the engine does not tell.
    #[must_use]
    pub fn unconverged_steps(&self) -> Option<u64> {
        self.engine.unconverged_steps()
    }

    /// One physics step.
    pub fn step(&self, world: &mut World, commands: &MuscleCommands) {
        let World { mechanics, engine } = world;
        self.engine.step(mechanics, engine, commands);
    }

    /// Takes the support away for good.
    pub const fn remove_support(&self, world: &mut World) {
        world.mechanics.support = false;
    }

    /// Whether the object's support is there.
    #[must_use]
    pub const fn has_support(&self, world: &World) -> bool {
        world.mechanics.support
    }

    /// Angle of every joint, from the shoulder outwards, the fingers before the thumb \[rad\]: 9 with
    /// a virtual finger, 18 with independent ones.
    #[must_use]
    pub fn joint_angles<'a>(&self, world: &'a World) -> &'a [f64] {
        &world.mechanics.q[..self.links.len()]
    }

    /// Angles of arm and hand; thumb and finger are the means over their joints \[rad\].
    #[must_use]
    pub fn posture(&self, world: &World) -> Posture {
        self.means(&world.mechanics.q)
    }

    /// Speeds of arm and hand, as [`Self::posture`] has the angles \[rad/s\].
    #[must_use]
    pub fn speeds(&self, world: &World) -> Posture {
        self.means(&world.mechanics.v)
    }

    fn means(&self, values: &[f64]) -> Posture {
        let (mut sums, mut counts) = ([0.0; 4], [0.0; 4]);
        for (link, value) in self.links.iter().zip(values) {
            sums[link.muscle.index()] += value;
            counts[link.muscle.index()] += 1.0;
        }
        std::array::from_fn(|i| sums[i] / counts[i])
    }

    /// Centre of the object \[m\].
    #[must_use]
    pub const fn object(&self, world: &World) -> Vector3<f64> {
        world.mechanics.ball.centre
    }

    /// Velocity of the object \[m/s\].
    #[must_use]
    pub const fn object_velocity(&self, world: &World) -> Vector3<f64> {
        world.mechanics.ball.velocity
    }

    /// The palm: its centre, x towards the fingers, y out of the side that grasps.
    #[must_use]
    pub fn palm(&self, world: &World) -> Frame {
        let forearm = place(&self.links[..=FOREARM], |i| world.mechanics.q[i])[FOREARM].frame();
        Frame {
            origin: forearm.world_from_local(&Vector3::new(self.palm_centre(), 0.0, 0.0)),
            ..forearm
        }
    }

    /// Distance of the palm's centre from the elbow \[m\].
    #[must_use]
    pub fn palm_centre(&self) -> f64 {
        self.body.arm.forearm_m + palm_length(&self.body) / 2.0
    }

    /// Where the centre of a ball is that lies against the palm, in the palm's frame \[m\].
    #[must_use]
    pub fn pocket(&self, radius: f64) -> Vector3<f64> {
        // A little towards the fingers, which reach around it there.
        let along = 0.12 * palm_length(&self.body);
        Vector3::new(along, self.body.arm.half_width_m + radius, 0.0)
    }
}
