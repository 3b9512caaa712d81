//! Faces and what bounds them, as a file describes them.

use crate::NurbsCurve;
use crate::curve::CurveError;

/// A curve with the number of the entity that it comes from.
#[derive(Debug, Clone)]
pub struct Part<const D: usize> {
    pub entity: u32,
    pub curve: NurbsCurve<D>,
}

/// A stretch of a boundary that is given in the parameter plane, in space, or in both, in the direction of the boundary.
#[derive(Debug, Clone, Default)]
pub struct Stretch {
    /// In the file's parameters of the surface.
    pub parameter: Vec<Part<2>>,
    pub space: Vec<Part<3>>,
    /// The file prefers the curves in space (PREF) where both are given and disagree.
    pub space_first: bool,
    /// Number of the edge in the edge list that neighbours share, as an entity number; 0 where there is none.
    pub edge: u32,
}

/// A closed chain of stretches.
#[derive(Debug, Clone)]
pub struct Boundary {
    /// For messages: "loop 15 (508)".
    pub name: String,
    pub stretches: Vec<Stretch>,
}

/// A face: part of a surface.
pub struct Face {
    /// Index of the surface that carries it.
    pub base: usize,
    /// No boundaries: the whole surface.
    pub boundaries: Vec<Boundary>,
    /// Whether the first boundary is the outer one (else the surface's own border is).
    pub outer: bool,
    /// Number of values that the face's own data took (pointers to properties follow).
    pub values: usize,
    /// Why the boundaries cannot be used.
    pub fault: Option<String>,
}

/// The same chain run through backwards.
pub fn reversed<const D: usize>(parts: Vec<Part<D>>) -> Result<Vec<Part<D>>, CurveError> {
    let backwards = parts.into_iter().rev().map(|p| {
        let curve = p.curve.reversed()?;
        Ok(Part {
            entity: p.entity,
            curve,
        })
    });
    backwards.collect()
}
