//! Motion with inertia against closed forms, conservation laws and an independent program.
mod bar;
mod bounce;
mod collision;
mod drop;
mod flight;
mod friction;
mod hertz;
mod refused;
mod resume;
mod strip;
mod support;
mod vibration;
