//! The engine made for this robot: a tree of joints that all turn about the vertical, and one ball.
//!
//! A step is implicit. With the mass matrix M(q), the muscles of Eq. 2 and the contacts' forces λ,
//!
//! ```text
//! (M + dt·K_D + dt²·K_P) Δv = dt (K_P (q_des − q) − K_D v − dt·K_P v − C) + Jᵀλ
//! ```
//!
//! is solved for the joints and the ball together: without contacts at once, with them by the few
//! Newton steps of `solver`, to a tolerance. Only sums, products, quotients, square roots and
//! `libm` occur, so the bits are the same everywhere.

mod contact;
mod distance;
mod factor;
mod mechanics;
mod solver;
mod term;

use nalgebra::Vector3;

use self::factor::{BALL, Matrix, SIZE, Sparsity};
use self::mechanics::{Planar, Speeds};
use super::kinematics::{MAX_JOINTS, Placed, place};
use super::links::{Link, Solid};
use super::muscles::Spring;
use super::world::{MovingBall, World};
use super::{FASTEST_TURN, GRAVITY};
use crate::arm::rotate;
use crate::config::{self, Body};

/// Velocities: of the ball (3), its spin (3), the joints.
type Velocities = [f64; SIZE];

/// The engine's params.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    links: Vec<Link>,
    inertias: Vec<Planar>,
    damping: Vec<f64>,
    solids: Vec<AttachedSolid>,
    sparsity: Sparsity,
    object: config::Object,
    contact: config::ContactModel,
    /// Half the obstacle's height \[m\].
    half_height: f64,
    dt: f64,
}

/// A solid and the link that carries it.
#[derive(Debug, Clone, Copy)]
struct AttachedSolid {
    link: usize,
    solid: Solid,
}

/// The equations of one step: `matrix · velocities = rhs` without contacts.
struct Equations {
    matrix: Matrix,
    rhs: Velocities,
}

impl Tree {
    /// The robot of `body`, stepped by `dt` \[s\].
    pub(super) fn new(body: &Body, links: &[Link], dt: f64) -> Self {
        let solids = |(link, of): (usize, &Link)| {
            let place = move |&(_, solid): &(_, Solid)| AttachedSolid { link, solid };
            of.solids.iter().map(place).collect::<Vec<_>>()
        };
        Self {
            inertias: links
                .iter()
                .map(|link| Planar::of(link, body.arm.density_kg_m3))
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
        }
    }

    /// One physics step.
    pub(super) fn step(&self, world: &mut World, springs: &[Spring; MAX_JOINTS]) {
        let placed = place(&self.links, |i| world.q[i]);
        let equations = self.equations(world, &placed, springs);
        let free = self.without_contacts(&equations);
        let speeds = Speeds::of(&self.links, &placed, &free[BALL..]);
        let contacts = self.contacts(world, &placed, &speeds, &free);
        let terms = self.terms(world, contacts);
        let mut velocities = self.with_contacts(world, &placed, &equations, free, &terms);
        self.limit(&mut velocities);
        term::note_contacts(world, &velocities, &terms);
        self.move_on(world, &velocities);
    }

    fn equations(
        &self,
        world: &World,
        placed: &[Placed; MAX_JOINTS],
        springs: &[Spring; MAX_JOINTS],
    ) -> Equations {
        let dt = self.dt;
        let mut matrix = [[0.0; SIZE]; SIZE];
        let mut rhs = [0.0; SIZE];
        self.add_ball(&world.ball, &mut matrix, &mut rhs);
        let bias = self.add_mass(placed, &world.v, &mut matrix);
        let joints = self.sparsity.joints();
        let mut velocities = [0.0; SIZE];
        velocities[joints.clone()].copy_from_slice(&world.v[..self.links.len()]);
        let momenta = self.sparsity.product(&matrix, &velocities, &joints);
        rhs[joints.clone()].copy_from_slice(&momenta[joints]);
        for i in 0..self.links.len() {
            let Spring {
                stiffness,
                rest,
                torque,
            } = springs[i];
            let k = BALL + i;
            rhs[k] += dt * (stiffness * (rest - world.q[i]) + torque - bias[i]);
            matrix[k][k] += dt * (self.damping[i] + dt * stiffness);
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

    fn mass(&self, ball: &MovingBall) -> f64 {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * ball.radius * ball.radius * ball.radius;
        self.object.density_kg_m3 * volume
    }

    /// Velocities at the end of the step if nothing touches.
    fn without_contacts(&self, equations: &Equations) -> Velocities {
        let Equations { matrix, rhs } = equations;
        let mut velocities = *rhs;
        for k in 0..BALL {
            velocities[k] /= matrix[k][k];
        }
        let mut factors = *matrix;
        let joints = self.sparsity.joints();
        self.sparsity.factor(&mut factors, &joints);
        self.sparsity.solve(&factors, &mut velocities, &joints);
        velocities
    }

    /// Keeps joints from turning further than a quarter turn in a step: beyond that, centrifugal forces
    /// of its beginning say nothing of its end, and weak damping would let them grow without bound.
    fn limit(&self, velocities: &mut Velocities) {
        let most = FASTEST_TURN / self.dt;
        for velocity in &mut velocities[self.sparsity.joints()] {
            *velocity = velocity.clamp(-most, most);
        }
    }

    fn move_on(&self, world: &mut World, velocities: &Velocities) {
        let dt = self.dt;
        let joints = &velocities[self.sparsity.joints()];
        for ((v, q), &velocity) in world.v.iter_mut().zip(&mut world.q).zip(joints) {
            *v = velocity;
            *q += dt * velocity;
        }
        let ball = &mut world.ball;
        ball.velocity = Vector3::new(velocities[0], velocities[1], velocities[2]);
        ball.spin = Vector3::new(velocities[3], velocities[4], velocities[5]);
        ball.centre += ball.velocity * dt;
    }
}
