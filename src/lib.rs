//! Contact between finite-element shells and CAD surfaces.

pub mod assembly;
pub mod contact;
pub mod fem;
pub mod gauntlet;
pub mod machine;
pub mod mesh;
pub mod model;
pub mod output;
pub mod page;
pub mod plan;
pub mod run;
pub mod scene;
pub mod shell;
pub mod soak;
pub mod solve;
pub mod study;
pub mod system;

#[cfg(feature = "cli")]
pub mod cli;

pub use covact_geometry as geometry;
