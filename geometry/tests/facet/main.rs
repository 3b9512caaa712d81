//! Facets: of meshes and of STL files, and the surfaces that stand for them.
mod counts;
mod refine;
mod stl;
mod surfaces;
