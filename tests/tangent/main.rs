//! Tangents of contact against dual numbers and differences.
mod averaged;
mod balance;
mod cases;
mod driven;
mod edges;
mod faults;
mod follower;
mod friction;
mod friction_edges;
mod friction_published;
mod friction_rigid;
mod friction_support;
mod normal;
mod pairs;
mod spin;
mod support;
mod surface;
