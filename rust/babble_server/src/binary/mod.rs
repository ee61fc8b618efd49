//! The binary protocol of [`crate::wire`].

mod execute;
mod play;
mod reply;
pub mod request;

pub use execute::execute;
pub use play::play;
