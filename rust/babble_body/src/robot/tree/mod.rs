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
mod contact_cost;
mod detection;
mod equations;
mod factor;
mod line;
mod mass_matrix;
mod model;
mod moving_contact;
mod planar_mass;
mod solver;
mod speeds;
mod step;
mod tally;

pub(super) use model::Tree;
