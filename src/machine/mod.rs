//! The machine that a run has: its memory, its processors, and the time it takes.
pub(crate) mod clock;
pub mod memory;
mod packing;
mod threads;

pub use packing::packing;
pub use threads::{processors, threads};
