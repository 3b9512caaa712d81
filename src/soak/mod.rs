//! Random scenes: a tool, a shell or a block, supports, friction, a motion and effects, drawn from a seed.
//!
//! Nobody has looked at such a scene before. It must reach its end or say why it did not, and what it reports is audited
//! from its history alone: balance of forces, energies, contact that is there where the tool presses; and, where that is asked for, by
//! a repetition in half of the steps and under ten times the penalty. Warnings that are of the mesh are held against a finer one.
mod audit;
mod clearance;
mod draw;
mod effects;
mod play;
mod repeat;
mod write;

pub use audit::{Finding, audit};
pub use draw::{BodyKind, Motion, RandomScene, Tool, draw, draw_with_effects};
pub use effects::{Effects, Matter, Metal, Release};
pub use play::{Ending, Played, Repeated, Settings, play};
pub use repeat::{finer, is_of_mesh, off, repetition};
pub use write::{Frame, Written};
