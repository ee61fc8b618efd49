//! Mass matrix and centrifugal torques of a tree whose joints all turn about the vertical.

use nalgebra::Vector2;

use super::factor::{BALL, Matrix};
use super::{Tree, rotate};
use crate::robot::kinematics::{MAX_JOINTS, Placed};
use crate::robot::links::Link;

/// Mass of a link and how it is spread in the plane of motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Planar {
    /// \[kg\]
    mass: f64,
    /// Centre of mass in the link's frame \[m\].
    centre: Vector2<f64>,
    /// Moment about the vertical through the centre of mass \[kg·m²\].
    moment: f64,
}

impl Planar {
    pub(super) fn of(link: &Link, density: f64) -> Self {
        let whole = link.inertia(density);
        Self {
            mass: whole.mass,
            centre: whole.centre.xy(),
            moment: whole.inertia[(2, 2)],
        }
    }
}

/// How the links move.
pub(super) struct Speeds {
    /// Velocities of the joints \[m/s\].
    origin: [Vector2<f64>; MAX_JOINTS],
    /// Angular speeds about the vertical \[rad/s\].
    turn: [f64; MAX_JOINTS],
}

impl Speeds {
    pub(super) fn of(links: &[Link], placed: &[Placed; MAX_JOINTS], v: &[f64]) -> Self {
        let mut speeds = Self {
            origin: [Vector2::zeros(); MAX_JOINTS],
            turn: [0.0; MAX_JOINTS],
        };
        for (i, link) in links.iter().enumerate() {
            let mut turn = link.sense() * v[i];
            if let Some(parent) = link.parent {
                turn += speeds.turn[parent];
                speeds.origin[i] = speeds.at(parent, placed, placed[i].origin.xy());
            }
            speeds.turn[i] = turn;
        }
        speeds
    }

    /// Angular speed of a link \[rad/s\].
    pub(super) const fn turn(&self, link: usize) -> f64 {
        self.turn[link]
    }

    /// Velocity of the point of a link that is at `point` \[m/s\].
    pub(super) fn at(
        &self,
        link: usize,
        placed: &[Placed; MAX_JOINTS],
        point: Vector2<f64>,
    ) -> Vector2<f64> {
        self.origin[link] + quarter_turn(point - placed[link].origin.xy()) * self.turn[link]
    }
}

/// `v` turned counter-clockwise by 90°.
pub(super) fn quarter_turn(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Sums over a link and all that hangs on it, about the shoulder.
#[derive(Clone, Copy, Default)]
struct Composite {
    mass: f64,
    /// Σ m c
    first: Vector2<f64>,
    /// Σ (I + m |c|²)
    second: f64,
    /// Σ m a, where a are the accelerations of centres of mass at constant joint speeds.
    force: Vector2<f64>,
    /// Σ c × m a
    torque: f64,
}

impl Composite {
    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
        self.force += other.force;
        self.torque += other.torque;
    }
}

impl Tree {
    /// Writes the joints' mass matrix and returns their centrifugal and Coriolis torques \[N·m\].
    pub(super) fn add_mass(
        &self,
        placed: &[Placed; MAX_JOINTS],
        v: &[f64; MAX_JOINTS],
        matrix: &mut Matrix,
    ) -> [f64; MAX_JOINTS] {
        let mut sums = self.own_inertias(placed, v);
        let mut bias = [0.0; MAX_JOINTS];
        for j in (0..self.links.len()).rev() {
            let own = sums[j];
            let (sense, here) = (self.links[j].sense(), placed[j].origin.xy());
            bias[j] = sense * (own.torque - cross(here, own.force));
            let mut ancestor = Some(j);
            while let Some(i) = ancestor {
                let there = placed[i].origin.xy();
                let moment =
                    own.second - own.first.dot(&(here + there)) + own.mass * here.dot(&there);
                matrix[BALL + j][BALL + i] = sense * self.links[i].sense() * moment;
                ancestor = self.links[i].parent;
            }
            if let Some(parent) = self.links[j].parent {
                sums[parent].add(&own);
            }
        }
        bias
    }

    fn own_inertias(
        &self,
        placed: &[Placed; MAX_JOINTS],
        v: &[f64; MAX_JOINTS],
    ) -> [Composite; MAX_JOINTS] {
        let mut sums = [Composite::default(); MAX_JOINTS];
        let mut turns = [0.0; MAX_JOINTS];
        // Accelerations of the joints.
        let mut origins = [Vector2::zeros(); MAX_JOINTS];
        for (i, (link, inertia)) in self.links.iter().zip(&self.inertias).enumerate() {
            let here = placed[i].origin.xy();
            turns[i] = link.sense() * v[i];
            if let Some(parent) = link.parent {
                turns[i] += turns[parent];
                let lever = here - placed[parent].origin.xy();
                origins[i] = origins[parent] - lever * (turns[parent] * turns[parent]);
            }
            let lever = rotate(inertia.centre, placed[i].direction);
            let centre = here + lever;
            let acceleration = origins[i] - lever * (turns[i] * turns[i]);
            sums[i] = Composite {
                mass: inertia.mass,
                first: centre * inertia.mass,
                second: inertia.moment + inertia.mass * centre.norm_squared(),
                force: acceleration * inertia.mass,
                torque: inertia.mass * cross(centre, acceleration),
            };
        }
        sums
    }
}
