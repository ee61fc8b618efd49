//! The robot that grasps, and its world: arm, hand, object, support and obstacle, moved by the
//! muscles of Eq. 2.
//!
//! [`Robot`] never changes; [`World`] is all that does. Two engines step a world: `tree`, which is
//! made for this robot, and `rapier`, a general one, its reference.

mod check;
mod clearance;
mod description;
mod kinematics;
mod links;
mod muscles;
mod rapier;
mod scene;
mod touch;
mod tree;
mod world;

use nalgebra::Vector3;

use crate::config::{Body, EngineName};
use crate::obstacle::Obstacle;
pub use kinematics::Frame;
use kinematics::{MAX_JOINTS, place};
pub use links::{ContactRegion, Solid};
use links::{FOREARM, Link};
pub use muscles::{MuscleCommand, MuscleCommands, Posture, towards};
pub use touch::Touch;
use world::MovingBall;
pub use world::World;

/// Earth's, downwards \[m/s²\]. It acts on the object alone: muscles compensate for it (Sect. II-B).
const GRAVITY: f64 = 9.81;

/// The most that a joint turns in a physics step \[rad\].
const FASTEST_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// A sphere that can be grasped.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ball {
    /// Its centre, in the arm's plane \[m\].
    pub centre: [f64; 2],
    /// Its radius \[m\].
    pub radius: f64,
}

/// How a world begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Posture at rest, and the equilibrium points.
    pub posture: Posture,
    /// The object.
    pub ball: Ball,
    /// Whether the object rests on a plane.
    pub support: bool,
    /// The cylinder in the way, if there is one.
    pub obstacle: Option<Obstacle>,
}

/// Arm, hand and everything around them, as params.
#[derive(Debug, Clone)]
pub struct Robot {
    body: Body,
    links: Vec<Link>,
    /// What each solid of the links belongs to.
    parts: Vec<ContactRegion>,
    ranges: [[f64; 2]; 4],
    dt: f64,
    stepper: Stepper,
}

#[derive(Debug, Clone)]
enum Stepper {
    Tree(Box<tree::Tree>),
    Rapier(Box<rapier::Rapier>),
}

impl Robot {
    /// The robot of `body`, stepped by `dt` \[s\].
    #[must_use]
    pub fn new(body: &Body, dt: f64) -> Self {
        let links = links::links(body);
        Self {
            ranges: ranges(body),
            parts: links
                .iter()
                .flat_map(|link| link.solids.iter().map(|&(part, _)| part))
                .collect(),
            stepper: match body.engine {
                EngineName::Tree => Stepper::Tree(Box::new(tree::Tree::new(body, &links, dt))),
                EngineName::Rapier => {
                    Stepper::Rapier(Box::new(rapier::Rapier::new(body, &links, dt)))
                }
            },
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
        &self.ranges
    }

    /// The open hand with the arm in a posture \[rad\].
    #[must_use]
    pub fn open_hand(&self, arm: [f64; 2]) -> Posture {
        [arm[0], arm[1], self.ranges[2][0], self.ranges[3][0]]
    }

    /// A posture moved into the joint ranges.
    #[must_use]
    pub fn clamp(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| posture[i].clamp(self.ranges[i][0], self.ranges[i][1]))
    }

    /// A posture as shares of the joint ranges.
    #[must_use]
    pub fn normalised(&self, posture: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges[i];
            (posture[i] - low) / (high - low)
        })
    }

    /// The posture at the given shares of the joint ranges.
    #[must_use]
    pub fn denormalised(&self, share: Posture) -> Posture {
        std::array::from_fn(|i| {
            let [low, high] = self.ranges[i];
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
        let mut world = World::at_rest(q, ball, setup.obstacle);
        world.support = setup.support;
        world
    }

    /// A world with every joint at its angle, in the order of [`Self::joint_angles`] \[rad\], and the
    /// object at a point \[m\]: to be looked at.
    #[must_use]
    pub fn posed(&self, joints: &[f64], object: &Vector3<f64>) -> World {
        let mut world = self.world(&Setup {
            posture: [0.0; 4],
            ball: Ball {
                centre: [0.0; 2],
                radius: 0.0,
            },
            support: false,
            obstacle: None,
        });
        for (q, angle) in world.q.iter_mut().zip(joints) {
            *q = *angle;
        }
        world.ball.centre = *object;
        world
    }

    /// One physics step.
    pub fn step(&self, world: &mut World, drive: &MuscleCommands) {
        let springs =
            std::array::from_fn(|i| self.spring(drive, i.min(self.links.len() - 1), world.q[i]));
        match &self.stepper {
            Stepper::Tree(tree) => tree.step(world, &springs),
            Stepper::Rapier(rapier) => {
                if let Some(memory) = world.rapier.take_if(|memory| memory.is_bare()) {
                    let again = self.replay(&memory.past, world.ball.radius, world.obstacle);
                    world.rapier = again.rapier;
                }
                rapier.step(world, drive, &springs[..self.links.len()]);
            }
        }
    }

    /// The world that a past of rapier's leads to.
    fn replay(&self, past: &rapier::Past, radius: f64, obstacle: Option<Obstacle>) -> World {
        let ball = MovingBall::at_rest(past.centre, radius);
        let mut world = World::at_rest(past.q, ball, obstacle);
        for spell in &past.spells {
            world.support = spell.support;
            for _ in 0..spell.steps {
                self.step(&mut world, &spell.drive);
            }
        }
        world
    }

    /// Takes the support away for good.
    pub const fn remove_support(&self, world: &mut World) {
        world.support = false;
    }

    /// Whether the object's support is there.
    #[must_use]
    pub const fn has_support(&self, world: &World) -> bool {
        world.support
    }

    /// Angle of every joint, from the shoulder outwards, the fingers before the thumb \[rad\]: 9 with
    /// a virtual finger, 18 with independent ones.
    #[must_use]
    pub fn joint_angles<'a>(&self, world: &'a World) -> &'a [f64] {
        &world.q[..self.links.len()]
    }

    /// Angles of arm and hand; thumb and finger are the means over their joints \[rad\].
    #[must_use]
    pub fn posture(&self, world: &World) -> Posture {
        self.means(&world.q)
    }

    /// Speeds of arm and hand, as [`Self::posture`] has the angles \[rad/s\].
    #[must_use]
    pub fn speeds(&self, world: &World) -> Posture {
        self.means(&world.v)
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
        world.ball.centre
    }

    /// Velocity of the object \[m/s\].
    #[must_use]
    pub const fn object_velocity(&self, world: &World) -> Vector3<f64> {
        world.ball.velocity
    }

    /// The palm: its centre, x towards the fingers, y out of the side that grasps.
    #[must_use]
    pub fn palm(&self, world: &World) -> Frame {
        let forearm = place(&self.links[..=FOREARM], |i| world.q[i])[FOREARM].frame();
        Frame {
            origin: forearm.world_from_local(&Vector3::new(self.palm_centre(), 0.0, 0.0)),
            ..forearm
        }
    }

    /// Distance of the palm's centre from the elbow \[m\].
    #[must_use]
    pub fn palm_centre(&self) -> f64 {
        self.body.arm.forearm_m + links::palm_length(&self.body) / 2.0
    }

    /// Where the centre of a ball is that lies against the palm, in the palm's frame \[m\].
    #[must_use]
    pub fn pocket(&self, radius: f64) -> Vector3<f64> {
        // A little towards the fingers, which reach around it there.
        let along = 0.12 * links::palm_length(&self.body);
        Vector3::new(along, self.body.arm.half_width_m + radius, 0.0)
    }
}

/// Lowest and highest equilibrium point of shoulder, elbow, thumb and finger \[rad\].
fn ranges(body: &Body) -> [[f64; 2]; 4] {
    let arm = |name: &str| {
        let joint = &body.joints[name];
        [joint.lower_deg, joint.upper_deg].map(f64::to_radians)
    };
    let hand = body.grip.flexion_deg.map(f64::to_radians);
    [arm("shoulder"), arm("elbow"), hand, hand]
}
