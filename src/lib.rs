//! Contact between finite-element shells and CAD surfaces.

pub mod assembly;
pub mod contact;
pub mod gauntlet;
pub mod mesh;
pub mod model;
pub mod output;
pub mod run;
pub mod scene;
pub mod shell;
pub mod solve;

#[cfg(feature = "cli")]
pub mod cli;
