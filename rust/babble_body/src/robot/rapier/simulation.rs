//! rapier's own state.

use std::fmt;

use rapier3d::prelude::*;

/// Everything that rapier carries from one step to the next.
#[derive(Clone, Default)]
pub(super) struct Simulation {
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    pub(super) narrow_phase: NarrowPhase,
    pub(super) bodies: RigidBodySet,
    pub(super) colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    pub(super) multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    workspace: Workspace,
}

impl fmt::Debug for Simulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Simulation")
            .field("bodies", &self.bodies.len())
            .field("colliders", &self.colliders.len())
            .finish_non_exhaustive()
    }
}

/// The engine's scratch memory, which holds nothing between steps.
#[derive(Default)]
struct Workspace {
    pipeline: PhysicsPipeline,
    ccd: CCDSolver,
}

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Simulation {
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
