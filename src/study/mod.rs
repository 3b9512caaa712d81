//! Studies: a scene run over a grid of choices, with its error against its cost.
//!
//! [`load`] reads a study file, [`expand`] makes the scenes of its runs and finds all that is wrong with it, [`Folder::write`]
//! writes them where they are run, [`play()`] runs those that have not been run ([`System`] and [`Jobs`] have that done elsewhere), and [`conclude`] makes a [`record::Record`] of
//! what is there, of which [`report::write`] makes a page, pictures and a table.
mod change;
mod check;
mod choice;
mod conclude;
mod error;
mod expand;
pub mod file;
mod folder;
mod gather;
mod jobs;
mod label;
mod load;
pub(crate) mod measure;
mod play;
pub mod record;
pub mod report;
mod scripts;
mod triangles;

pub use conclude::{conclude, machine};
pub use error::StudyError;
pub use expand::{Expansion, Planned, expand};
pub use folder::{Folder, Ready};
pub use jobs::{JOBS, Job, Jobs, Standing};
pub use load::{FORMAT, LoadedStudy, load, parse, schema};
pub use play::{Account, Event, Place, Settings, play, running};
pub use scripts::{System, Work};
pub use triangles::{TriangleError, Triangles};
