//! A contact, and what it does to velocities.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::factor::{BALL, DIGIT, Matrix, SIZE, Sparsity, Velocities};
use crate::robot::links::{FOREARM, Link};

/// Most joints between the shoulder and a link, both counted: those of the thumb.
pub(super) const CHAIN: usize = FOREARM + 1 + DIGIT;

/// The joints that move a link, from it inwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    /// How many there are.
    count: usize,
    /// Their velocities.
    joints: [usize; CHAIN],
    /// Their columns in the rows of a matrix.
    columns: [usize; CHAIN],
}

impl Chain {
    /// That of something that does not move.
    pub(super) const NONE: Self = Self {
        count: 0,
        joints: [0; CHAIN],
        columns: [0; CHAIN],
    };

    /// That of a link.
    pub(super) fn of(link: usize, links: &[Link], sparsity: &Sparsity) -> Self {
        let mut chain = Self::NONE;
        let mut next = Some(link);
        while let Some(i) = next {
            chain.joints[chain.count] = BALL + i;
            chain.columns[chain.count] = sparsity.column(BALL + i);
            chain.count += 1;
            next = links[i].parent;
        }
        chain
    }

    /// Whether there are any.
    pub(super) const fn moves(&self) -> bool {
        self.count > 0
    }

    /// The links of the joints.
    pub(super) fn links(&self) -> impl Iterator<Item = usize> {
        self.joints[..self.count].iter().map(|joint| joint - BALL)
    }
}

/// One point where the ball, or the obstacle, meets a link or something that does not move.
///
/// The force is along `normal` on the ball's or the obstacle's side and against it on the link's.
#[derive(Debug, Clone)]
pub(super) struct Contact<'a> {
    /// What touches; none if it is the obstacle that a link meets.
    pub(super) slot: Option<usize>,
    pub(super) normal: Vector3<f64>,
    /// Depth \[m\]; negative if apart.
    pub(super) depth: f64,
    /// From the ball's centre \[m\]; none if the obstacle is in the ball's place.
    pub(super) arm: Option<Vector3<f64>>,
    /// The joints that move the link.
    pub(super) chain: &'a Chain,
    /// How they move the point, per rad/s \[m\].
    pub(super) levers: [Vector2<f64>; CHAIN],
    /// Coefficient of friction.
    pub(super) friction: f64,
}

impl Contact<'_> {
    /// Velocity of the ball's side against the link's \[m/s\].
    pub(super) fn relative(&self, velocities: &Velocities) -> Vector3<f64> {
        let [ux, uy, uz, wx, wy, wz, ..] = *velocities;
        let mut relative = self.arm.map_or_else(Vector3::zeros, |arm| {
            Vector3::new(ux, uy, uz) + Vector3::new(wx, wy, wz).cross(&arm)
        });
        for i in 0..self.chain.count {
            let moved = self.levers[i] * velocities[self.chain.joints[i]];
            relative.x -= moved.x;
            relative.y -= moved.y;
        }
        relative
    }

    /// Adds the impulses in the joints and of the ball that `impulse` \[N·s\] makes.
    pub(super) fn apply(&self, impulse: &Vector3<f64>, to: &mut [f64; SIZE]) {
        if let Some(arm) = self.arm {
            let turn = arm.cross(impulse);
            for k in 0..3 {
                to[k] += impulse[k];
                to[3 + k] += turn[k];
            }
        }
        for i in 0..self.chain.count {
            to[self.chain.joints[i]] -= self.levers[i].dot(&impulse.xy());
        }
    }

    /// Adds `JᵀWJ` for a curvature W \[kg\] of the impulse.
    pub(super) fn add(&self, w: &Matrix3<f64>, to: &mut Matrix) {
        if let Some(arm) = &self.arm {
            add_to_ball(w, arm, to);
        }
        for i in 0..self.chain.count {
            let row = &mut to[self.chain.joints[i]];
            let lever = self.levers[i];
            let pull = w.column(0) * lever.x + w.column(1) * lever.y;
            if let Some(arm) = &self.arm {
                let turn = arm.cross(&pull);
                for j in 0..3 {
                    row[j] -= pull[j];
                    row[3 + j] -= turn[j];
                }
            }
            // The chain is listed from the link inwards.
            for j in i..self.chain.count {
                row[self.chain.columns[j]] += pull.xy().dot(&self.levers[j]);
            }
        }
    }
}

/// Adds the part of the ball, whose surface moves with ω × r = −r × ω.
fn add_to_ball(w: &Matrix3<f64>, arm: &Vector3<f64>, to: &mut Matrix) {
    let turned = [0, 1, 2].map(|j| arm.cross(&w.column(j)));
    for i in 0..3 {
        let both = arm.cross(&Vector3::new(turned[0][i], turned[1][i], turned[2][i]));
        for j in 0..=i {
            to[i][j] += w[(i, j)];
            to[3 + i][3 + j] += both[j];
        }
        for j in 0..3 {
            to[3 + i][j] += turned[j][i];
        }
    }
}
