//! A surface mesh on its way to a body: elements, what is known of them, sets.
use super::SurfaceError;
use super::edges::corners;
use crate::mesh::error::listed;
use crate::mesh::raw::{Facets, Kept, NONE, RawMesh};
use crate::mesh::sets::unknown;
use crate::mesh::{MeshError, SetKind};
use crate::scene::{Thickness, Value};
use covact_geometry::Vec3;
use std::collections::BTreeMap;
use std::path::Path;

pub(super) struct Surface {
    pub nodes: Vec<Vec3>,
    /// Numbers in the file; 0 for nodes that the file does not have.
    pub node_tags: Vec<u64>,
    /// Corners around the border; the last one of a triangle is [`NONE`].
    pub facets: Vec<[u32; 4]>,
    /// Nodes in the middle of edges and facets as in [`Facets::middles`], or empty.
    pub middles: Vec<[u32; 5]>,
    /// Numbers of the elements in the file.
    pub tags: Vec<u64>,
    /// Thickness of every element; not that of a field.
    pub thickness: Vec<f64>,
    /// Element sets.
    pub sets: BTreeMap<String, Vec<u32>>,
    /// Sets of lines.
    pub lines: BTreeMap<String, Vec<[u32; 2]>>,
    /// Node sets of the file.
    pub node_sets: BTreeMap<String, Vec<u32>>,
}

impl Surface {
    /// The surface elements of a file, its unused nodes dropped. `middles`: the nodes between corners are of use.
    pub fn new(raw: RawMesh, scale: f64, middles: bool, notes: &mut Vec<String>) -> Surface {
        let RawMesh {
            mut nodes,
            mut node_tags,
            mut facets,
            mut lines,
            mut node_sets,
            ..
        } = raw;
        collapse(&mut facets, notes);
        let triangles = facets.corners.iter().any(|f| f[3] == NONE);
        if !facets.middles.is_empty() && (triangles || !middles) {
            let quadratic = |m: &&[u32; 5]| m.iter().any(|n| *n != NONE);
            let count = facets.middles.iter().filter(quadratic).count();
            notes.push(format!(
                "{count} quadratic elements: only their corners are used{}",
                match triangles {
                    true => " (in a surface with triangles)",
                    false => " (`\"element\": \"q18\"` takes all their nodes)",
                }
            ));
            facets.middles = Vec::new();
        }
        let used = (0..facets.len() as u32).flat_map(|f| facets.nodes(f));
        let kept = Kept::new(nodes.len(), used);
        if kept.dropped > 0 {
            notes.push(format!(
                "{} node(s) of the file belong to no element of the surface and were left out",
                kept.dropped
            ));
            kept.retain(&mut nodes);
            kept.retain(&mut node_tags);
            kept.renumber(facets.corners.iter_mut().flatten());
            kept.renumber(facets.middles.iter_mut().flatten());
            kept.retain_sets(&mut node_sets, "surface element", notes);
            for set in lines.values_mut() {
                kept.renumber(set.iter_mut().flatten());
                set.retain(|line| !line.contains(&NONE));
            }
        }
        lines.retain(|_, set| !set.is_empty());
        Surface {
            nodes: nodes.into_iter().map(|x| x * scale).collect(),
            node_tags,
            thickness: Vec::new(),
            facets: facets.corners,
            middles: facets.middles,
            tags: facets.tags,
            sets: facets.sets,
            lines,
            node_sets,
        }
    }

    /// Mean of the corners of an element.
    pub fn center(&self, facet: u32) -> [f64; 3] {
        let corners = corners(&self.facets[facet as usize]);
        let sum: Vec3 = corners.iter().map(|&n| self.nodes[n as usize]).sum();
        (sum / corners.len() as f64).into()
    }

    /// Turns an element's normal around.
    pub fn turn(&mut self, facet: u32) {
        let last = corners(&self.facets[facet as usize]).len() - 1;
        self.facets[facet as usize][1..=last].reverse();
        if let Some(middles) = self.middles.get_mut(facet as usize) {
            middles[..=last].reverse();
        }
    }

    /// Gives every element its thickness.
    pub fn set_thickness(&mut self, thickness: &Thickness, path: &Path) -> Result<(), MeshError> {
        let by_set = match thickness {
            Thickness::Uniform(t) => {
                self.thickness = vec![*t; self.facets.len()];
                return Ok(());
            }
            Thickness::Field(_) => {
                self.thickness = vec![f64::NAN; self.facets.len()];
                return Ok(());
            }
            Thickness::BySet(by_set) => by_set,
        };
        let fail = |source| MeshError::Surface {
            path: path.to_path_buf(),
            source,
        };
        let mut found: Vec<Option<(&str, f64)>> = vec![None; self.facets.len()];
        for (name, &t) in by_set {
            let Some(set) = self.sets.get(name) else {
                return Err(unknown(SetKind::Element, name, self.sets.keys()));
            };
            for &f in set {
                match found[f as usize] {
                    Some((other, thickness)) if thickness != t => {
                        return Err(fail(SurfaceError::TwoThicknesses {
                            element: self.tags[f as usize],
                            position: self.center(f),
                            sets: [other.to_string(), name.clone()],
                        }));
                    }
                    _ => found[f as usize] = Some((name, t)),
                }
            }
        }
        if let Some(f) = found.iter().position(Option::is_none) {
            return Err(fail(SurfaceError::NoThickness {
                count: found.iter().filter(|t| t.is_none()).count(),
                element: self.tags[f],
                position: self.center(f as u32),
                sets: listed(self.sets.keys()),
            }));
        }
        self.thickness = found.into_iter().flatten().map(|(_, t)| t).collect();
        Ok(())
    }
}

/// The thickness at every node of a finished surface where it is a field, or nothing.
pub(super) fn at_nodes(surface: &Surface, thickness: &Thickness) -> Result<Vec<f64>, SurfaceError> {
    let Thickness::Field(text) = thickness else {
        return Ok(Vec::new());
    };
    let field = Value::Expression(text.clone()).compile(&Thickness::VARIABLES);
    let field = field.map_err(SurfaceError::Field)?;
    let places = surface.nodes.iter().zip(&surface.node_tags);
    let at = |(x, &node): (&Vec3, &u64)| {
        let value = field.eval_at(x, 0.0).map_err(SurfaceError::Field)?;
        match value > 0.0 {
            true => Ok(value),
            false => Err(SurfaceError::NotPositive {
                value,
                node,
                position: (*x).into(),
            }),
        }
    };
    places.map(at).collect()
}

/// Quadrilaterals with the same node at two neighbouring corners are triangles.
fn collapse(facets: &mut Facets, notes: &mut Vec<String>) {
    let mut count = 0;
    for (k, facet) in facets.corners.iter_mut().enumerate() {
        let double = (0..4).find(|&i| facet[i] == facet[(i + 1) % 4] && facet[3] != NONE);
        let Some(i) = double else { continue };
        let mut left: Vec<u32> = facet.to_vec();
        left.remove(i);
        *facet = [left[0], left[1], left[2], NONE];
        if let Some(middles) = facets.middles.get_mut(k) {
            *middles = [NONE; 5];
        }
        count += 1;
    }
    if count > 0 {
        notes.push(format!(
            "{count} quadrilaterals have the same node at two corners and are taken for triangles"
        ));
    }
}

impl Surface {
    /// No element has a node twice.
    pub fn check(&self) -> Result<(), SurfaceError> {
        for (f, facet) in self.facets.iter().enumerate() {
            let corners = corners(facet);
            let twice = (corners.iter().enumerate()).any(|(k, n)| corners[..k].contains(n));
            if twice {
                return Err(SurfaceError::Flat {
                    element: self.tags[f],
                    position: self.center(f as u32),
                });
            }
        }
        Ok(())
    }
}
