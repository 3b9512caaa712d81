//! Exact NURBS forms of simple surfaces.
