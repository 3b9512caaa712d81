//! What mesh files have in common: elements and sets by name, before they become a checked [`Mesh`].
use super::error::SetKind;
use super::{ElementSize, Face, Mesh, MeshError};
use covact_geometry::Vec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Stands for a node that there is not.
pub(super) const NONE: u32 = u32::MAX;

/// What is told of pairs of nodes at the same place, after their number.
pub(super) const KEPT_APART: &str = "pair(s) of nodes of unconnected parts lie at the same place and are kept apart; join \
                                     them in the mesher where the parts are to hold together";

/// The same of pairs within a part, where they are meant.
pub(super) const SLITS: &str =
    "pair(s) of nodes at the same place are the two sides of slits (`slits`)";

/// How the thickness direction t of the elements was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThicknessRule {
    /// By a mesh generator.
    Generated,
    /// Along the normals of a surface mesh.
    Extruded,
    /// From the file's surface `top` (or `bottom`) through the layers below (above) it.
    Surface,
    /// Along the shortest way through the body.
    ShortestWay,
    /// Local direction 3 of the file's elements.
    FileOrder,
}

/// What a reader or generator has to tell about a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshReport {
    /// Choices made and things left out, in words; empty when there is nothing to tell.
    pub notes: Vec<String>,
    /// How the thickness direction was chosen (where elements differ: the weakest rule in use).
    pub thickness: ThicknessRule,
    /// Sizes and shapes of the elements.
    pub size: ElementSize,
    /// Number of unconnected parts.
    pub components: usize,
    /// Numbers of the nodes in the file, 0 for nodes that the file does not have; empty for generated meshes.
    pub node_tags: Vec<u64>,
    /// Numbers of the elements in the file; empty for generated meshes.
    pub element_tags: Vec<u64>,
}

/// A mesh as it stands in a file.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub nodes: Vec<Vec3>,
    pub node_tags: Vec<u64>,
    /// Corners of the hexahedra in tensor order, as indices into `nodes`.
    pub hexahedra: Vec<[u32; 8]>,
    /// All nodes of quadratic hexahedra, `i + 3 j + 9 k`, beside their corners; empty where the hexahedra are linear.
    pub quadratic: Vec<[u32; 27]>,
    /// The nodes in the middle of faces and elements were made from 20-node hexahedra.
    pub completed: bool,
    pub element_tags: Vec<u64>,
    /// Thickness is local direction 3 by the meaning of the element type; `false`: to be found.
    pub thickness_is_given: Vec<bool>,
    /// Element sets of hexahedra.
    pub solid_sets: BTreeMap<String, Vec<u32>>,
    /// Node sets as indices into `nodes`, without the nodes of element sets.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Surfaces as faces of the hexahedra (tensor order).
    pub face_sets: BTreeMap<String, Vec<Face>>,
    /// Quadrilaterals and triangles.
    pub facets: Facets,
    /// Sets of lines, by their ends.
    pub lines: BTreeMap<String, Vec<[u32; 2]>>,
    pub notes: Vec<String>,
    /// The element types of the file in words, for the message that none is of use.
    pub found: Vec<String>,
    /// What to do in the program that wrote the file where hexahedra are missing.
    pub help: &'static str,
    /// The first solid elements that cannot be read: the reason why the file has no mesh of solids.
    pub refused: Option<MeshError>,
    /// The first elements of a surface that cannot be read.
    pub refused_facets: Option<MeshError>,
}

/// Quadrilaterals and triangles of a file: faces of its hexahedra, or a surface of its own.
#[derive(Debug, Default)]
pub(super) struct Facets {
    /// Around the border; the last corner of a triangle is [`NONE`].
    pub corners: Vec<[u32; 4]>,
    /// Nodes in the middle of the edges (after each corner) and of the facet, [`NONE`] where there is none. Empty where no
    /// facet has any.
    pub middles: Vec<[u32; 5]>,
    /// Numbers in the file.
    pub tags: Vec<u64>,
    pub sets: BTreeMap<String, Vec<u32>>,
}

impl Facets {
    /// Adds a facet of 3, 4, 6, 8 or 9 nodes, corners first, then the middles of the edges and of the facet.
    pub fn push(&mut self, nodes: &[u32], tag: u64) -> u32 {
        let edges = if matches!(nodes.len(), 3 | 6) { 3 } else { 4 };
        let node = |k: usize| nodes.get(k).copied().unwrap_or(NONE);
        let mut corners = [NONE; 4];
        for (k, corner) in corners.iter_mut().enumerate().take(edges) {
            *corner = node(k);
        }
        if nodes.len() > edges {
            let mut middles = [NONE; 5];
            for (k, middle) in middles.iter_mut().enumerate().take(edges) {
                *middle = node(edges + k);
            }
            middles[4] = node(2 * edges);
            self.middles.resize(self.corners.len(), [NONE; 5]);
            self.middles.push(middles);
        } else if !self.middles.is_empty() {
            self.middles.push([NONE; 5]);
        }
        self.corners.push(corners);
        self.tags.push(tag);
        self.corners.len() as u32 - 1
    }

    pub fn len(&self) -> usize {
        self.corners.len()
    }

    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Whether a facet was added with three corners.
    pub fn is_triangle(&self, facet: u32) -> bool {
        self.corners[facet as usize][3] == NONE
    }

    /// All nodes of a facet.
    pub fn nodes(&self, facet: u32) -> impl Iterator<Item = u32> + '_ {
        let corners = self.corners[facet as usize];
        let middles = self.middles.get(facet as usize).copied();
        let all = corners.into_iter().chain(middles.into_iter().flatten());
        all.filter(|n| *n != NONE)
    }
}

impl RawMesh {
    /// The file has no elements of the wanted kind.
    pub(super) fn nothing(&self, path: &Path, wanted: &'static str, help: String) -> MeshError {
        MeshError::NoElements {
            path: path.to_path_buf(),
            wanted,
            found: match self.found.is_empty() {
                true => "none".to_string(),
                false => super::error::listed(&self.found),
            },
            help,
        }
    }

    /// Leaves only the elements of one set.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`] where no element set has this name.
    pub(super) fn select(&mut self, name: &str) -> Result<(), MeshError> {
        let solids = self.solid_sets.get(name).cloned();
        let facets = self.facets.sets.get(name).cloned();
        if solids.is_none() && facets.is_none() {
            let known = self.solid_sets.keys().chain(self.facets.sets.keys());
            return Err(super::sets::unknown(SetKind::Element, name, known));
        }
        let number = numbers(self.hexahedra.len(), &solids.unwrap_or_default());
        retain(&number, &mut self.hexahedra);
        retain(&number, &mut self.quadratic);
        retain(&number, &mut self.element_tags);
        retain(&number, &mut self.thickness_is_given);
        renumber_sets(&number, &mut self.solid_sets);
        for set in self.face_sets.values_mut() {
            set.retain_mut(|face| {
                face.element = number[face.element as usize];
                face.element != NONE
            });
        }
        self.face_sets.retain(|_, set| !set.is_empty());
        let number = numbers(self.facets.len(), &facets.unwrap_or_default());
        retain(&number, &mut self.facets.corners);
        retain(&number, &mut self.facets.middles);
        retain(&number, &mut self.facets.tags);
        renumber_sets(&number, &mut self.facets.sets);
        self.refused = None;
        self.refused_facets = None;
        Ok(())
    }
}

/// New numbers of `count` things of which only `kept` stay, [`NONE`] for the others.
fn numbers(count: usize, kept: &[u32]) -> Vec<u32> {
    let mut number = vec![NONE; count];
    for &k in kept {
        number[k as usize] = 0;
    }
    for (k, slot) in number.iter_mut().filter(|slot| **slot == 0).enumerate() {
        *slot = k as u32;
    }
    number
}

fn retain<T>(number: &[u32], list: &mut Vec<T>) {
    let mut number = number.iter();
    list.retain(|_| number.next().is_some_and(|n| *n != NONE));
}

fn renumber_sets(number: &[u32], sets: &mut BTreeMap<String, Vec<u32>>) {
    sets.retain(|_, set| {
        set.retain_mut(|k| {
            *k = number[*k as usize];
            *k != NONE
        });
        !set.is_empty()
    });
}

/// Which nodes stay, and their new numbers.
pub(super) struct Kept {
    /// [`NONE`] for nodes that go.
    number: Vec<u32>,
    pub dropped: usize,
}

impl Kept {
    pub fn new(nodes: usize, used: impl Iterator<Item = u32>) -> Kept {
        let mut number = vec![NONE; nodes];
        for n in used {
            number[n as usize] = 0;
        }
        let mut kept = 0;
        for slot in number.iter_mut().filter(|slot| **slot == 0) {
            *slot = kept;
            kept += 1;
        }
        Kept {
            number,
            dropped: nodes - kept as usize,
        }
    }

    /// Drops what belongs to nodes that go.
    pub fn retain<T>(&self, list: &mut Vec<T>) {
        retain(&self.number, list);
    }

    /// New number of a node; [`NONE`] where it goes.
    pub fn number(&self, node: u32) -> u32 {
        self.number.get(node as usize).copied().unwrap_or(NONE)
    }

    pub fn renumber<'n>(&self, nodes: impl Iterator<Item = &'n mut u32>) {
        nodes.for_each(|n| *n = self.number(*n));
    }

    /// Sets without the nodes that go; those left empty go too, and a note tells of what they hold no node.
    pub fn retain_sets(
        &self,
        sets: &mut BTreeMap<String, Vec<u32>>,
        of: &str,
        notes: &mut Vec<String>,
    ) {
        sets.retain(|name, set| {
            self.renumber(set.iter_mut());
            set.retain(|&n| n != NONE);
            if set.is_empty() {
                notes.push(format!("`{name}` holds no node of a {of} and was left out"));
            }
            !set.is_empty()
        });
    }
}

/// Report of a finished mesh.
pub(super) fn report(
    mesh: &Mesh,
    mut notes: Vec<String>,
    thickness: ThicknessRule,
) -> Result<MeshReport, MeshError> {
    let components = mesh.components();
    if components > 1 {
        notes.push(format!(
            "the mesh consists of {components} unconnected parts"
        ));
        // The sides of extruded surfaces go apart; their surfaces were asked.
        let pairs = match thickness {
            ThicknessRule::Extruded => 0,
            _ => mesh.touching_pairs(),
        };
        if pairs > 0 {
            notes.push(format!("{pairs} {KEPT_APART}"));
        }
    }
    let size = mesh.element_size().ok_or(MeshError::OutOfRange {
        what: "the mesh".to_string(),
        kind: "element",
        number: 0,
        count: 0,
    })?;
    Ok(MeshReport {
        notes,
        thickness,
        size,
        components,
        node_tags: Vec::new(),
        element_tags: Vec::new(),
    })
}

/// Adds the numbers in the file to an error: of elements, or of nodes that the file has.
pub(super) fn with_tags(mut error: MeshError, elements: &[u64], nodes: &[u64]) -> MeshError {
    match &mut error {
        MeshError::Inverted { element, tag, .. } => *tag = elements.get(*element as usize).copied(),
        MeshError::DuplicateNodes {
            first,
            second,
            tags,
            ..
        } => {
            let of = |n: u32| nodes.get(n as usize).copied().filter(|tag| *tag > 0);
            *tags = of(*first).zip(of(*second)).map(|(a, b)| [a, b]);
        }
        _ => {}
    }
    error
}
