//! Mass matrix and centrifugal torques of a tree whose joints all turn about the vertical.

use nalgebra::Vector2;

use super::factor::{BALL, Matrix};
use super::model::Tree;
use crate::geometry::frame::rotate;
use crate::robot::kinematics::{LinkPose, MAX_JOINTS};

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
        poses: &[LinkPose; MAX_JOINTS],
        v: &[f64; MAX_JOINTS],
        matrix: &mut Matrix,
    ) -> [f64; MAX_JOINTS] {
        let mut sums = self.own_inertias(poses, v);
        let mut bias = [0.0; MAX_JOINTS];
        for j in (0..self.links.len()).rev() {
            let own = sums[j];
            let (sense, here) = (self.links[j].sense(), poses[j].origin.xy());
            bias[j] = sense * (own.torque - cross(here, own.force));
            let mut ancestor = Some(j);
            while let Some(i) = ancestor {
                let there = poses[i].origin.xy();
                let moment =
                    own.second - own.first.dot(&(here + there)) + own.mass * here.dot(&there);
                matrix[BALL + j][self.sparsity.column(BALL + i)] =
                    sense * self.links[i].sense() * moment;
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
        poses: &[LinkPose; MAX_JOINTS],
        v: &[f64; MAX_JOINTS],
    ) -> [Composite; MAX_JOINTS] {
        let mut sums = [Composite::default(); MAX_JOINTS];
        let mut turns = [0.0; MAX_JOINTS];
        // Accelerations of the joints.
        let mut origins = [Vector2::zeros(); MAX_JOINTS];
        for (i, (link, own)) in self.links.iter().zip(&self.masses).enumerate() {
            let here = poses[i].origin.xy();
            turns[i] = link.sense() * v[i];
            if let Some(parent) = link.parent {
                turns[i] += turns[parent];
                let lever = here - poses[parent].origin.xy();
                origins[i] = origins[parent] - lever * (turns[parent] * turns[parent]);
            }
            let lever = rotate(own.centre, poses[i].direction);
            let centre = here + lever;
            let acceleration = origins[i] - lever * (turns[i] * turns[i]);
            sums[i] = Composite {
                mass: own.mass,
                first: centre * own.mass,
                second: own.moment + own.mass * centre.norm_squared(),
                force: acceleration * own.mass,
                torque: own.mass * cross(centre, acceleration),
            };
        }
        sums
    }
}
