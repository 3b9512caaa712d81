//! Studies: a scene run over a grid of choices, with its error against its cost.
pub mod file;
pub mod record;
pub mod report;
