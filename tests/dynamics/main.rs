//! Motion with inertia against closed forms, conservation laws and an independent program.
mod bar;
mod collision;
mod drop;
mod flight;
mod friction;
mod refused;
mod resume;
mod strip;
mod support;
mod vibration;
