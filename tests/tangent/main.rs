//! Tangents of contact against dual numbers.
mod averaged;
mod balance;
mod cases;
mod edges;
mod faults;
mod normal;
mod pairs;
mod spin;
mod support;
mod surface;
