//! The params of rapier as an engine.

use rapier3d::prelude::*;

use super::input_log::CommandBounds;
use super::simulation::Simulation;
use crate::robot::contact_slots::SLOTS;
use crate::robot::muscles::MuscleModel;

/// Angular x: the free axis of a joint in its own frame.
pub(super) const FREE_AXIS: usize = 3;
/// The object's mark; what can touch it has its slot.
pub(super) const OBJECT: usize = SLOTS;

/// rapier as an engine: its params, and a template of its worlds.
#[derive(Debug, Clone)]
pub(in crate::robot) struct Rapier {
    pub(super) muscles: MuscleModel,
    pub(super) bounds: CommandBounds,
    pub(super) template: Simulation,
    pub(super) parameters: IntegrationParameters,
    pub(super) bodies: Vec<RigidBodyHandle>,
    pub(super) joints: Vec<MultibodyJointHandle>,
    pub(super) object: RigidBodyHandle,
    pub(super) object_collider: ColliderHandle,
    pub(super) support: ColliderHandle,
    pub(super) obstacle: ColliderHandle,
    pub(super) half_height: f32,
}
