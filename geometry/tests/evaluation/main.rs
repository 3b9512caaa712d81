//! Values and derivatives of patches, and what is made of patches.
mod common;
mod jets;
mod kernels;
mod operations;
mod patch;
mod surfaces;
#[cfg(feature = "truck")]
mod truck;
