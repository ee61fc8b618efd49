//! A contact, and what it does to velocities.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::factor::{Matrix, SIZE, Velocities};
use crate::robot::links::FOREARM;

/// Most joints between the shoulder and a link, both counted: those of the thumb.
pub(super) const CHAIN: usize = FOREARM + 5;

/// One point where the ball, or the obstacle, meets a link or something that does not move.
///
/// The force is along `normal` on the ball's or the obstacle's side and against it on the link's.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    /// What touches; none if it is the obstacle that a link meets.
    pub(super) slot: Option<usize>,
    pub(super) normal: Vector3<f64>,
    /// Depth \[m\]; negative if apart.
    pub(super) depth: f64,
    /// From the ball's centre \[m\]; none if the obstacle is in the ball's place.
    pub(super) arm: Option<Vector3<f64>>,
    /// Velocities that move the link.
    pub(super) joints: [usize; CHAIN],
    /// How they move the point, per rad/s \[m\].
    pub(super) levers: [Vector2<f64>; CHAIN],
    /// How many there are.
    pub(super) chain: usize,
    /// Coefficient of friction.
    pub(super) friction: f64,
}

impl Contact {
    /// Velocity of the ball's side against the link's \[m/s\].
    pub(super) fn relative(&self, velocities: &Velocities) -> Vector3<f64> {
        let [ux, uy, uz, wx, wy, wz, ..] = *velocities;
        let mut relative = self.arm.map_or_else(Vector3::zeros, |arm| {
            Vector3::new(ux, uy, uz) + Vector3::new(wx, wy, wz).cross(&arm)
        });
        for i in 0..self.chain {
            let moved = self.levers[i] * velocities[self.joints[i]];
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
        for i in 0..self.chain {
            to[self.joints[i]] -= self.levers[i].dot(&impulse.xy());
        }
    }

    /// Adds `JᵀWJ` for a curvature W \[kg\] of the impulse.
    pub(super) fn add(&self, w: &Matrix3<f64>, to: &mut Matrix) {
        // ω × r = X ω
        let x = self.arm.map(|arm| -arm.cross_matrix());
        if let Some(x) = &x {
            let turned = x.tr_mul(w);
            let both = turned * x;
            for i in 0..3 {
                for j in 0..=i {
                    to[i][j] += w[(i, j)];
                    to[3 + i][3 + j] += both[(i, j)];
                }
                for j in 0..3 {
                    to[3 + i][j] += turned[(i, j)];
                }
            }
        }
        for i in 0..self.chain {
            let row = &mut to[self.joints[i]];
            let lever = self.levers[i].push(0.0);
            let pull = w * lever;
            if let Some(x) = &x {
                let turn = x.tr_mul(&pull);
                for j in 0..3 {
                    row[j] -= pull[j];
                    row[3 + j] -= turn[j];
                }
            }
            // The chain is listed from the link inwards.
            for j in i..self.chain {
                row[self.joints[j]] += pull.xy().dot(&self.levers[j]);
            }
        }
    }
}
