//! Tangents of contact and loads against dual numbers, differences and closed forms.
mod averaged;
mod balance;
mod cases;
mod driven;
mod edges;
mod faults;
mod follower;
mod normal;
mod pairs;
mod spin;
mod support;
mod surface;
