//! Random scenes: a tool, a shell or a block, supports, friction and a motion, drawn from a seed.
//!
//! Nobody has looked at such a scene before. It must reach its end or say why it did not, and what it reports is audited
//! from its history alone: balance of forces, energies, contact that is there where the tool presses.
mod audit;
mod clearance;
mod draw;
mod play;
mod write;

pub use audit::{Finding, audit};
pub use draw::{BodyKind, Motion, RandomScene, Tool, draw};
pub use play::{Ending, Played, Settings, play};
pub use write::{Frame, Written};
