//! Tangents of contact against dual numbers and differences.
mod driven;
mod normal;
mod support;
