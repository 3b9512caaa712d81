//! Verification of the solid-shell elements: patch tests, the linear obstacle course, nearly incompressible material,
//! and a large-rotation cantilever.
mod distortion;
mod hencky;
mod hinged_roof;
mod incompressible;
mod large_rotation;
mod mixed;
mod nonlinear;
mod obstacle;
mod patch;
mod plastic;
mod quadratic;
mod support;
