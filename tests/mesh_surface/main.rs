//! Surface meshes that become bodies: formats, thickness, sense, sets, and what is refused.
mod cells;
mod formats;
mod inp;
mod large;
mod sets;
mod support;
mod thickness;
mod topology;
mod wrong;
