//! Mass properties of links in the plane of motion.

use nalgebra::Vector2;

use crate::robot::links::Link;

/// Mass properties of a link in the plane of motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanarMass {
    /// Mass \[kg\].
    pub(super) mass: f64,
    /// Centre of mass in the link's frame \[m\].
    pub(super) centre: Vector2<f64>,
    /// Moment about the vertical through the centre of mass \[kg·m²\].
    pub(super) moment: f64,
}

impl PlanarMass {
    pub(super) fn of(link: &Link, density: f64) -> Self {
        let whole = link.inertia(density);
        Self {
            mass: whole.mass,
            centre: whole.centre.xy(),
            moment: whole.inertia[(2, 2)],
        }
    }
}
