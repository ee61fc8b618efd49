//! The arm as it reaches: two joints in a plane.

mod clearance;
mod dynamics;
mod outline;
mod period;
mod planar_arm;

pub use clearance::{ContactWatch, sweep};
pub(crate) use dynamics::cross_section;
pub use dynamics::{ArmInertia, ArmState, Dynamics, Pull};
pub use outline::Segment;
pub use planar_arm::{ArmPose, PlanarArm};
