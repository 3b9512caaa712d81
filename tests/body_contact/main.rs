//! Contact between deformable bodies.
mod averaged;
mod averaged_friction;
mod averaged_multipliers;
mod averaged_rubbing;
mod bad_input;
mod blocks;
mod borders;
mod convergence;
mod cut_faces;
mod edges;
mod friction;
mod invariance;
mod neighbours;
mod orthotropic;
mod overclosure;
mod patch;
mod segment_histories;
mod segments;
mod self_contact;
mod sheet_on_block;
mod shells;
mod sliding;
#[path = "../verification/support.rs"]
#[allow(dead_code)]
mod support;
mod two_half;
