//! The world's state: all that the physics engine carries from one step to the next.

use std::fmt;

use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

/// Everything that moves, and what the engine remembers of it. A copy, or what was written and read
/// again, continues bit for bit.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct World {
    pub(super) islands: IslandManager,
    pub(super) broad_phase: DefaultBroadPhase,
    pub(super) narrow_phase: NarrowPhase,
    pub(super) bodies: RigidBodySet,
    pub(super) colliders: ColliderSet,
    pub(super) impulse_joints: ImpulseJointSet,
    pub(super) multibody_joints: MultibodyJointSet,
    pub(super) soft_bodies: SoftBodySet,
    #[serde(skip)]
    pub(super) workspace: Workspace,
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("bodies", &self.bodies.len())
            .field("colliders", &self.colliders.len())
            .finish_non_exhaustive()
    }
}

/// The engine's scratch memory, which holds nothing between steps.
#[derive(Default)]
pub(super) struct Workspace {
    pipeline: PhysicsPipeline,
    ccd: CCDSolver,
}

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl World {
    /// One physics step.
    pub(super) fn step(&mut self, gravity: Vector, parameters: &IntegrationParameters) {
        self.workspace.pipeline.step(
            gravity,
            parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.workspace.ccd,
            &(),
            &(),
        );
    }
}
