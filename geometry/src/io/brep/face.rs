//! Faces and what bounds them, as a file describes them.

use crate::curve::CurveError;
use crate::{NurbsCurve, Vec3};

/// A curve with the number of the entity that it comes from.
#[derive(Debug, Clone)]
pub struct Part<const D: usize> {
    pub entity: u32,
    pub curve: NurbsCurve<D>,
}

/// Which of two kinds of curves a file prefers where it gives both.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Preference {
    /// It does not say, or takes both for equal.
    #[default]
    None,
    Parameter,
    Space,
}

/// A stretch of a boundary that is given in the parameter plane, in space, or in both, in the direction of the boundary.
#[derive(Debug, Clone, Default)]
pub struct Stretch {
    /// In the file's parameters of the surface.
    pub parameter: Vec<Part<2>>,
    pub space: Vec<Part<3>>,
    /// What counts where both are given and disagree.
    pub preference: Preference,
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

impl Face {
    /// Boundary curves and their control points, in both planes.
    pub fn extent(&self) -> [usize; 2] {
        let mut extent = [0, 0];
        for stretch in self.boundaries.iter().flat_map(|b| &b.stretches) {
            extent[0] += stretch.parameter.len().max(stretch.space.len());
            let plane = stretch.parameter.iter();
            extent[1] += plane.map(|p| p.curve.homogeneous().len()).sum::<usize>();
            let space = stretch.space.iter();
            extent[1] += space.map(|p| p.curve.homogeneous().len()).sum::<usize>();
        }
        extent
    }

    /// The same face bounded by its curves in space alone; `None` where they do not bound all of it, or do so already.
    pub fn in_space(&self) -> Option<Self> {
        let mut stretches = self.boundaries.iter().flat_map(|b| &b.stretches);
        let given = stretches.clone().any(|s| !s.parameter.is_empty());
        if !given || stretches.any(|s| s.space.is_empty()) {
            return None;
        }
        let boundary = |b: &Boundary| Boundary {
            name: b.name.clone(),
            stretches: (b.stretches.iter())
                .map(|s| Stretch {
                    parameter: Vec::new(),
                    ..s.clone()
                })
                .collect(),
        };
        Some(Self {
            boundaries: self.boundaries.iter().map(boundary).collect(),
            fault: self.fault.clone(),
            ..*self
        })
    }

    /// Control points of the space curves, between which these run.
    pub fn points(&self) -> Vec<Vec3> {
        let parts = self.boundaries.iter().flat_map(|b| &b.stretches);
        let curves = parts.flat_map(|s| &s.space).map(|p| &p.curve);
        curves
            .flat_map(|c| c.homogeneous())
            .map(|p| Vec3::new(p[0], p[1], p[2]) / p[3])
            .collect()
    }
}

/// What is to be said of a face that its curves in space bound, because those in the parameter plane bound none.
pub fn without_parameters(reason: &str) -> String {
    format!(
        "its curves in the parameter plane bound no part of the surface ({reason}); those in space were projected"
    )
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
