//! Meshes: what is generated, what files hold, what is refused.
mod checks;
mod generators;
mod gmsh;
mod inp;
mod limits;
mod quadratic;
