#![doc = include_str!("../README.md")]

pub mod fault;
pub mod limits;
pub mod session;
pub mod wire;
