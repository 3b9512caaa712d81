//! Contact between deformable bodies.
mod blocks;
mod convergence;
mod invariance;
mod patch;
mod shells;
mod sliding;
#[path = "../verification/support.rs"]
#[allow(dead_code)]
mod support;
