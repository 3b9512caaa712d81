//! Finite-element meshes: nodes, elements, named node and face sets.
//!
//! Local node order of every element is tensor-product: `i` (r) fastest, then `j` (s), then `k` (t, the thickness).
//! H8 node `i + 2 j + 4 k`; Q18 node `i + 3 j + 9 k`.
mod build;
mod check;
mod cursor;
mod error;
mod extrude;
mod face;
mod facets;
mod field;
mod generate;
mod gmsh;
mod inp;
mod measure;
mod nastran;
pub mod nurbs;
mod orient;
mod quadratic;
mod raw;
mod sets;
pub(crate) mod size;
mod solid;
mod spacing;
mod stl;
mod topology;
mod vtk;

pub use build::{Format, build, read};
pub use error::{MAX_NODES, MeshError, Position, SetKind};
pub use extrude::SurfaceError;
pub use face::tributary_areas;
pub use facets::MeshFacets;
pub use generate::{block, cylinder_panel, plate, sphere_panel};
pub use gmsh::read_gmsh;
pub use inp::read_inp;
pub use measure::{ElementSize, H8_EDGES, Range};
pub use nurbs::{Border, Edge, NurbsError, NurbsSheet};
pub use raw::{MeshReport, ThicknessRule};
pub use sets::Selected;
pub use spacing::positions;
pub use topology::ThicknessColumns;

use crate::scene::Element;
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// The element shapes a body can be made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementKind {
    /// 8-node solid-shell, linear.
    H8,
    /// 18-node solid-shell, biquadratic in the plane and linear through the thickness. Nodes are numbered
    /// `i + 3 j + 9 k`, i along r, j along s, k along t.
    Q18,
    /// A knot span of a bicubic NURBS patch that stands for a shell of some thickness: its sixteen control points, xi1 fastest.
    Nurbs,
}

impl From<Element> for ElementKind {
    fn from(element: Element) -> ElementKind {
        match element {
            Element::Q18 => ElementKind::Q18,
            Element::Nurbs => ElementKind::Nurbs,
            _ => ElementKind::H8,
        }
    }
}

impl ElementKind {
    /// Nodes of one element.
    pub const fn nodes(self) -> usize {
        match self {
            ElementKind::H8 => 8,
            ElementKind::Q18 => 18,
            ElementKind::Nurbs => 16,
        }
    }

    /// Places of the eight corners among the nodes of an element, in the order `i + 2 j + 4 k`.
    pub const fn corners(self) -> [usize; 8] {
        match self {
            ElementKind::H8 => [0, 1, 2, 3, 4, 5, 6, 7],
            ElementKind::Q18 => [0, 2, 6, 8, 9, 11, 15, 17],
            // Of the control net, once for the bottom and once for the top.
            ElementKind::Nurbs => [0, 3, 12, 15, 0, 3, 12, 15],
        }
    }
}

/// One face of one element. Local faces: 0 is r = -1, 1 is r = +1, 2 is s = -1, 3 is s = +1, 4 is t = -1 (bottom),
/// 5 is t = +1 (top).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Face {
    /// Number of the element in its mesh, from 0.
    pub element: u32,
    /// Number of the face in the element, 0 to 5.
    pub face: u8,
}

/// Nodes of the local faces of H8, ordered so that face parameters (u fastest) give an outward normal u x v.
pub const H8_FACES: [[u8; 4]; 6] = [
    [0, 4, 2, 6],
    [1, 3, 5, 7],
    [0, 1, 4, 5],
    [2, 6, 3, 7],
    [0, 2, 1, 3],
    [4, 5, 6, 7],
];

/// A mesh of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// The kind of its elements.
    pub kind: ElementKind,
    /// Node positions, in the scene's length unit.
    pub nodes: Vec<Vec3>,
    /// Node numbers of the elements, `kind.nodes()` each.
    pub connectivity: Vec<u32>,
    /// Named node sets, each sorted and without duplicates.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named face sets, each sorted and without duplicates.
    pub face_sets: BTreeMap<String, Vec<Face>>,
}

impl Mesh {
    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.connectivity.len() / self.kind.nodes()
    }

    /// Node numbers of element `e`.
    pub fn element(&self, e: usize) -> &[u32] {
        let n = self.kind.nodes();
        &self.connectivity[e * n..(e + 1) * n]
    }
}
