//! Contact between finite-element shells and CAD surfaces.

pub mod assembly;
pub mod clock;
pub mod contact;
pub mod gauntlet;
pub mod limits;
pub mod mesh;
pub mod model;
pub mod output;
pub mod run;
pub mod scene;
pub mod shell;
pub mod soak;
pub mod solve;
pub mod study;

#[cfg(feature = "cli")]
pub mod cli;
