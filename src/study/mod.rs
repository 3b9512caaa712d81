//! Studies: a scene run over a grid of choices, with its error against its cost.
mod change;
mod check;
mod choice;
mod expand;
pub mod file;
mod label;
mod load;
pub mod record;
mod triangles;

pub use expand::{Expansion, Planned, expand};
pub use load::{FORMAT, LoadedStudy, load, parse, schema};
pub use triangles::{TriangleError, Triangles};
