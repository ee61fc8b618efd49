//! The engine that a body names, and its state in a world.

use serde::{Deserialize, Serialize};

use super::engine::Engine;
use super::links::Link;
use super::mechanics::MechanicalState;
use super::muscles::MuscleCommands;
#[cfg(feature = "rapier")]
use super::rapier::{Rapier, RapierState};
use super::tree::Tree;
use crate::config::{Body, EngineName};
use crate::error::BodyError;

/// One of the engines.
#[derive(Debug, Clone)]
pub(super) enum AnyEngine {
    Tree(Box<Tree>),
    #[cfg(feature = "rapier")]
    Rapier(Box<Rapier>),
}

/// What that engine keeps of a world. The order of the variants is that of their bytes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum EngineState {
    Tree,
    #[cfg(feature = "rapier")]
    Rapier(Box<RapierState>),
}

impl AnyEngine {
    /// The engine of `body`, with a step of `dt` \[s\].
    pub(super) fn new(body: &Body, links: &[Link], dt: f64) -> Self {
        match body.engine {
            EngineName::Tree => Self::Tree(Box::new(Tree::new(body, links, dt))),
            #[cfg(feature = "rapier")]
            EngineName::Rapier => Self::Rapier(Box::new(Rapier::new(body, links, dt))),
        }
    }

    /// See [`Engine::start`].
    pub(super) fn start(&self, mechanics: &MechanicalState) -> EngineState {
        match self {
            Self::Tree(tree) => {
                tree.start(mechanics);
                EngineState::Tree
            }
            #[cfg(feature = "rapier")]
            Self::Rapier(rapier) => EngineState::Rapier(Box::new(rapier.start(mechanics))),
        }
    }

    /// See [`Engine::step`]. A world of another engine goes on from where it is, at rest.
    pub(super) fn step(
        &self,
        mechanics: &mut MechanicalState,
        state: &mut EngineState,
        commands: &MuscleCommands,
    ) {
        match (self, state) {
            (Self::Tree(tree), EngineState::Tree) => tree.step(mechanics, &mut (), commands),
            #[cfg(feature = "rapier")]
            (Self::Rapier(rapier), EngineState::Rapier(state)) => {
                rapier.step(mechanics, state, commands);
            }
            #[cfg(feature = "rapier")]
            (_, state) => {
                *state = self.start(mechanics);
                self.step(mechanics, state, commands);
            }
        }
    }

    /// Physics steps in which the contact solver did not converge; none of an engine that does not
    /// tell.
    #[cfg_attr(
        not(feature = "rapier"),
        expect(clippy::unnecessary_wraps, reason = "rapier does not tell")
    )]
    pub(super) fn unconverged_steps(&self) -> Option<u64> {
        match self {
            Self::Tree(tree) => Some(tree.unconverged_steps()),
            #[cfg(feature = "rapier")]
            Self::Rapier(_) => None,
        }
    }

    /// See [`Engine::restore`].
    pub(super) fn restore(
        &self,
        mechanics: &MechanicalState,
        state: &mut EngineState,
        start: &MechanicalState,
        steps: u64,
    ) -> Result<(), BodyError> {
        match (self, state) {
            (Self::Tree(tree), EngineState::Tree) => tree.restore(mechanics, &mut (), start, steps),
            #[cfg(feature = "rapier")]
            (Self::Rapier(rapier), EngineState::Rapier(state)) => {
                rapier.restore(mechanics, state, start, steps)
            }
            #[cfg(feature = "rapier")]
            (Self::Tree(_), EngineState::Rapier(_)) => Err(BodyError::world(
                "a state of rapier, but the body's engine is the tree",
            )),
            #[cfg(feature = "rapier")]
            (Self::Rapier(_), EngineState::Tree) => Err(BodyError::world(
                "a state of the tree engine, but the body's engine is rapier",
            )),
        }
    }
}
