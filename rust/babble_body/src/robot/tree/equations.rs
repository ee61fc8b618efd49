//! The equations of motion of one step, without contacts.

use super::factor::{BALL, Matrix, SIZE, Velocities};
use super::model::Tree;
use crate::robot::engine::GRAVITY;
use crate::robot::kinematics::{LinkPose, MAX_JOINTS};
use crate::robot::mechanics::{MechanicalState, MovingBall};
use crate::robot::muscles::Spring;

/// The equations of one step: `matrix · velocities = rhs` without contacts.
pub(super) struct Equations {
    pub(super) matrix: Matrix,
    pub(super) rhs: Velocities,
}

impl Tree {
    /// The equations of a step.
    pub(super) fn equations(
        &self,
        mechanics: &MechanicalState,
        poses: &[LinkPose; MAX_JOINTS],
        springs: &[Spring; MAX_JOINTS],
    ) -> Equations {
        let dt = self.dt;
        let mut matrix = [[0.0; _]; SIZE];
        let mut rhs = [0.0; SIZE];
        self.add_ball(&mechanics.ball, &mut matrix, &mut rhs);
        let bias = self.add_mass(poses, &mechanics.v, &mut matrix);
        let joints = self.sparsity.joints();
        let mut velocities = [0.0; SIZE];
        velocities[joints.clone()].copy_from_slice(&mechanics.v[..self.links.len()]);
        let momenta = self.sparsity.product(&matrix, &velocities, joints.end);
        rhs[joints.clone()].copy_from_slice(&momenta[joints]);
        for i in 0..self.links.len() {
            let Spring {
                stiffness,
                rest,
                torque,
            } = springs[i];
            let k = BALL + i;
            rhs[k] += dt * (stiffness * (rest - mechanics.q[i]) + torque - bias[i]);
            matrix[k][self.sparsity.column(k)] += dt * (self.damping[i] + dt * stiffness);
        }
        Equations { matrix, rhs }
    }

    /// Mass and damping of the ball, which gravity pulls.
    fn add_ball(&self, ball: &MovingBall, matrix: &mut Matrix, rhs: &mut Velocities) {
        let dt = self.dt;
        let mass = self.mass(ball);
        let moment = 0.4 * mass * ball.radius * ball.radius;
        for k in 0..3 {
            matrix[k][k] = mass * (1.0 + dt * self.object.linear_damping);
            rhs[k] = mass * ball.velocity[k];
            matrix[3 + k][3 + k] = moment * (1.0 + dt * self.object.angular_damping);
            rhs[3 + k] = moment * ball.spin[k];
        }
        rhs[2] -= dt * mass * GRAVITY;
    }

    /// Velocities at the end of the step if nothing touches.
    pub(super) fn without_contacts(&self, equations: &Equations) -> Velocities {
        let Equations { matrix, rhs } = equations;
        let mut velocities = *rhs;
        for k in 0..BALL {
            velocities[k] /= matrix[k][k];
        }
        let mut factors = *matrix;
        let end = self.sparsity.size();
        self.sparsity.factor::<BALL>(&mut factors, end);
        self.sparsity.solve::<BALL>(&factors, &mut velocities, end);
        velocities
    }
}
