//! The params of the tree engine.

use super::factor::Sparsity;
use super::planar_mass::PlanarMass;
use super::tally::Tally;
use crate::config::{self, Body};
use crate::geometry::solid::Solid;
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
    pub(super) sparsity: Sparsity,
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
}

impl Tree {
    /// The robot of `body`, stepped by `dt` \[s\].
    pub(in crate::robot) fn new(body: &Body, links: &[Link], dt: f64) -> Self {
        let solids = |(link, of): (usize, &Link)| {
            let attached = move |&(_, solid): &(_, Solid)| AttachedSolid { link, solid };
            of.solids.iter().map(attached).collect::<Vec<_>>()
        };
        Self {
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
            sparsity: Sparsity::of(links),
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
