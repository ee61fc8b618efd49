//! Mass properties of rigid bodies and of the solids that they are made of.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::solid::Solid;

/// Mass, centre of mass and rotational inertia of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MassProperties {
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\].
    pub centre: Vector3<f64>,
    /// Inertia about the centre of mass, columns along the axes \[kg·m²\].
    pub inertia: Matrix3<f64>,
}

impl MassProperties {
    /// A solid of a density \[kg/m³\].
    #[must_use]
    pub fn of(solid: &Solid, density: f64) -> Self {
        match *solid {
            Solid::Capsule { a, b, radius } => capsule(a, b, radius, density),
            Solid::Cuboid { centre, half } => {
                let mass = density * 8.0 * half.x * half.y * half.z;
                let spread = half.component_mul(&half) * (mass / 3.0);
                Self::from_spread(mass, centre, Matrix3::from_diagonal(&spread))
            }
        }
    }

    /// From ∫ r rᵀ dm about the centre \[kg·m²\].
    pub(crate) fn from_spread(mass: f64, centre: Vector3<f64>, spread: Matrix3<f64>) -> Self {
        Self {
            mass,
            centre,
            inertia: Matrix3::from_diagonal_element(spread.trace()) - spread,
        }
    }

    /// All of them as one rigid body.
    pub fn sum(parts: impl Iterator<Item = Self> + Clone) -> Self {
        let mass: f64 = parts.clone().map(|part| part.mass).sum();
        let moment: Vector3<f64> = parts.clone().map(|part| part.centre * part.mass).sum();
        let centre = moment / mass;
        let about = |part: Self| {
            let d = part.centre - centre;
            let shifted = Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose();
            part.inertia + shifted * part.mass
        };
        Self {
            mass,
            centre,
            inertia: parts.map(about).sum(),
        }
    }
}

/// A cylinder and the two halves of a ball.
fn capsule(a: Vector3<f64>, b: Vector3<f64>, radius: f64, density: f64) -> MassProperties {
    use std::f64::consts::PI;
    let (length, square) = ((b - a).norm(), radius * radius);
    let direction = (b - a) / length;
    let along = direction * direction.transpose();
    let cylinder = density * PI * square * length;
    let ball = density * 4.0 / 3.0 * PI * square * radius;
    // Across the axis, where a ball's halves are as spread as the ball.
    let round = (cylinder / 4.0 + ball / 5.0) * square;
    // Along it: a half ball's centre is 3/8 of its radius beyond the cylinder's end.
    let long = cylinder * length * length / 12.0
        + ball * (square / 5.0 + length * length / 4.0 + 3.0 / 8.0 * length * radius);
    let across = Matrix3::identity() - along;
    let spread = across * round + along * long;
    MassProperties::from_spread(cylinder + ball, (a + b) / 2.0, spread)
}
