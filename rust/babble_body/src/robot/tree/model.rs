//! The params of the tree engine.

use super::contact::Chain;
use super::factor::Sparsity;
use super::planar_mass::PlanarMass;
use super::tally::Tally;
use crate::config::{self, Body};
use crate::geometry::solid::{Bounds, Solid};
use crate::robot::links::Link;
use crate::robot::mechanics::MovingBall;
use crate::robot::muscles::MuscleModel;

/// The engine's params.
#[derive(Debug, Clone)]
pub(in crate::robot) struct Tree {
    pub(super) muscles: MuscleModel,
    pub(super) links: Vec<Link>,
    pub(super) masses: Vec<PlanarMass>,
    pub(super) damping: Vec<f64>,
    pub(super) solids: Vec<AttachedSolid>,
    /// How far from its joint a link's solids reach in the plane at most, as |x| + |y| \[m\].
    pub(super) levers: Vec<f64>,
    pub(super) sparsity: Sparsity,
    /// The joints that move each link.
    pub(super) chains: Vec<Chain>,
    pub(super) object: config::Object,
    pub(super) contact: config::ContactModel,
    /// Half the obstacle's height \[m\].
    pub(super) half_height: f64,
    pub(super) dt: f64,
    /// Physics steps in which the solver did not converge.
    unconverged: Tally,
}

/// A solid and the link that carries it.
#[derive(Debug, Clone, Copy)]
pub(super) struct AttachedSolid {
    pub(super) link: usize,
    pub(super) solid: Solid,
    pub(super) bounds: Bounds,
}

impl Tree {
    /// The robot of `body`, stepped by `dt` \[s\].
    pub(in crate::robot) fn new(body: &Body, links: &[Link], dt: f64) -> Self {
        let solids = |(link, of): (usize, &Link)| {
            let attached = move |&(_, solid): &(_, Solid)| AttachedSolid {
                link,
                solid,
                bounds: solid.bounds(),
            };
            of.solids.iter().map(attached).collect::<Vec<_>>()
        };
        let sparsity = Sparsity::of(links);
        let chain = |i| Chain::of(i, links, &sparsity);
        Self {
            chains: (0..links.len()).map(chain).collect(),
            muscles: MuscleModel::new(body, links),
            masses: links
                .iter()
                .map(|link| PlanarMass::of(link, body.arm.density_kg_m3))
                .collect(),
            damping: links
                .iter()
                .map(|link| link.muscle.settings(body).kd)
                .collect(),
            solids: links.iter().enumerate().flat_map(solids).collect(),
            levers: links.iter().map(lever).collect(),
            sparsity,
            links: links.to_vec(),
            object: body.object,
            contact: body.contact,
            half_height: body.obstacle.height_m / 2.0,
            dt,
            unconverged: Tally::default(),
        }
    }

    /// Counts a physics step in which the solver did not converge.
    pub(super) fn note_unconverged(&self) {
        self.unconverged.add();
    }

    /// How many there were.
    pub(in crate::robot) fn unconverged_steps(&self) -> u64 {
        self.unconverged.count()
    }

    /// Mass of the object \[kg\].
    pub(super) fn mass(&self, ball: &MovingBall) -> f64 {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * ball.radius * ball.radius * ball.radius;
        self.object.density_kg_m3 * volume
    }
}

/// How far from its joint a link's solids reach in the plane at most, as |x| + |y| \[m\].
fn lever(link: &Link) -> f64 {
    let farthest = |(_, solid): &(_, Solid)| {
        let Bounds { low, high } = solid.bounds();
        low.x.abs().max(high.x.abs()) + low.y.abs().max(high.y.abs())
    };
    link.solids.iter().map(farthest).fold(0.0, f64::max)
}
