//! Quadrilaterals in tensor order, and the body between their two sides.
use super::normals::Normals;
use super::surface::Surface;
use crate::machine::memory;
use crate::mesh::{ElementKind, Face, MAX_NODES, Mesh, MeshError, size};
use crate::scene::Offset;
use std::collections::BTreeMap;

/// The elements of a surface, 4 nodes `i + 2 j` or 9 nodes `i + 3 j` each.
pub(super) struct Cells {
    pub kind: ElementKind,
    pub nodes: Vec<u32>,
    pub thickness: Vec<f64>,
    /// Thickness at the nodes, in place of that of the elements; may be empty.
    pub at_nodes: Vec<f64>,
    /// Numbers in the file.
    pub tags: Vec<u64>,
}

/// Local face of the body's element above the edge from corner `k` of a facet to the next.
pub(super) const SIDES: [u8; 4] = [2, 1, 3, 0];

impl Cells {
    /// The quadrilaterals of a surface; it has middle nodes where `kind` needs them.
    pub fn new(surface: &Surface, kind: ElementKind) -> Cells {
        let mut nodes = Vec::new();
        for (f, &[a, b, c, d]) in surface.facets.iter().enumerate() {
            match kind {
                ElementKind::H8 => nodes.extend([a, b, d, c]),
                ElementKind::Q18 | ElementKind::Nurbs => {
                    let [ab, bc, cd, da, center] = surface.middles[f];
                    nodes.extend([a, ab, b, da, center, bc, d, cd, c]);
                }
            }
        }
        Cells {
            kind,
            nodes,
            thickness: surface.thickness.clone(),
            at_nodes: Vec::new(),
            tags: surface.tags.clone(),
        }
    }

    /// Nodes along one side.
    pub fn side(&self) -> usize {
        match self.kind {
            ElementKind::H8 => 2,
            ElementKind::Q18 | ElementKind::Nurbs => 3,
        }
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.tags.len()
    }

    /// The body: node `n` of the surface has the number `n + k * nodes` on the k-th level from below.
    pub fn extrude(
        &self,
        surface: &Surface,
        normals: &Normals,
        offset: Offset,
        layers: u32,
    ) -> Result<Mesh, MeshError> {
        const WHAT: &str = "surface mesh with its layers";
        let count = surface.nodes.len();
        let all = count as u64 * (u64::from(layers) + 1);
        if all > MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: WHAT,
                nodes: all.into(),
            });
        }
        let elements = self.count() as u64 * u64::from(layers);
        memory::ask(size::bytes(all, elements, self.kind)).map_err(|shortage| {
            MeshError::Memory {
                what: WHAT,
                nodes: all,
                shortage,
            }
        })?;
        let start = match offset {
            Offset::Mid => -0.5,
            Offset::Top => -1.0,
            Offset::Bottom => 0.0,
        };
        let mut nodes = Vec::with_capacity(all as usize);
        let mut connectivity = Vec::with_capacity(2 * self.nodes.len() * layers as usize);
        for k in 0..=layers {
            let at = start + f64::from(k) / f64::from(layers);
            let level = surface.nodes.iter().zip(&normals.through);
            nodes.extend(level.map(|(x, through)| x + through * at));
        }
        for k in 0..layers {
            for cell in self.nodes.chunks_exact(self.side() * self.side()) {
                for level in [k, k + 1] {
                    let first = level * count as u32;
                    connectivity.extend(cell.iter().map(|n| n + first));
                }
            }
        }
        Ok(Mesh {
            kind: self.kind,
            nodes,
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        })
    }

    /// Faces of the body on the side of an element's edge, through all layers.
    pub fn edge_faces(&self, facet: u32, side: u8, layers: u32) -> impl Iterator<Item = Face> {
        let count = self.count() as u32;
        (0..layers).map(move |k| Face {
            element: facet + k * count,
            face: SIDES[side as usize],
        })
    }
}
