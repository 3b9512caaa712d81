//! Tangents of contact against dual numbers.
mod normal;
mod support;
