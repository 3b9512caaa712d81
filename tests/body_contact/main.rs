//! Contact between deformable bodies.
mod blocks;
mod patch;
#[path = "../verification/support.rs"]
#[allow(dead_code)]
mod support;
