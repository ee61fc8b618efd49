//! Beyond the paper: a chain of babbles that ends in a grasp, what is learnt from it, and how an agent
//! acts on that.
//!
//! A babble is a list of [chunks], movements that infants make from birth on or soon after. It
//! begins with the object in the hand and ends with the hand closed on it again. From the sight of the
//! object in between, the network learns the posture before the grasp, the posture at contact, and the
//! hand's ([`ChainNetwork`]). [`acting`] plays the last links of the chain on what is recalled, or on what
//! an agent of a user's own says ([`targets`]), and [`practice`] learns by reward when to go around the object first.

pub mod acting;
pub mod brain;
pub mod carrying;
pub mod chunks;
pub mod code;
pub mod infant;
mod network;
pub mod plan;
pub mod practice;
pub mod route;
pub mod targets;

pub use brain::{ChainBrain, ChainName, Sequence, Withdrawal};
pub use infant::babble;
pub use network::{ChainNetwork, Recalled};
pub use plan::Targets;
pub use targets::ChooseTargets;
