//! Closest points of surfaces that move.
mod common;
mod facets;
mod smooth;
