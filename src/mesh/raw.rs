//! What mesh files have in common: hexahedra, faces and sets by name, turned into a checked [`Mesh`].
use super::orient::{orient, rotated};
use super::topology::FaceTable;
use super::{ElementKind, ElementSize, Face, Mesh, MeshError};
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// How the thickness direction t of the elements was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThicknessRule {
    /// By a mesh generator.
    Generated,
    /// From the file's surface `top` (or `bottom`) through the layers below (above) it.
    Surface,
    /// Along the shortest edges.
    ShortestEdge,
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
    /// Numbers of the nodes in the file; empty for generated meshes.
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
    pub element_tags: Vec<u64>,
    /// Thickness is local direction 3 by the meaning of the element type; `false`: to be found.
    pub thickness_is_given: Vec<bool>,
    /// Node sets as indices into `nodes`.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Surfaces as quadrilaterals around their border.
    pub surfaces: BTreeMap<String, Vec<[u32; 4]>>,
    /// Surfaces as faces of the hexahedra (tensor order).
    pub face_sets: BTreeMap<String, Vec<Face>>,
    pub notes: Vec<String>,
}

/// Local faces whose tensor order is (0, 1, 3, 2) around the border.
const AROUND: [usize; 4] = [0, 1, 3, 2];

impl RawMesh {
    /// Drops unused nodes, matches surfaces to faces, chooses the thickness direction and checks the result.
    pub(super) fn into_mesh(mut self, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
        self.drop_unused_nodes();
        let mut mesh = Mesh {
            kind: ElementKind::H8,
            nodes: self.nodes.iter().map(|x| x * scale).collect(),
            connectivity: self.hexahedra.iter().flatten().copied().collect(),
            node_sets: self.node_sets,
            face_sets: self.face_sets,
        };
        for set in mesh.node_sets.values_mut() {
            set.sort_unstable();
            set.dedup();
        }
        let mut notes = self.notes;
        match_surfaces(&mut mesh, &self.surfaces, &mut notes);
        // A reversed element would mislead the search for its thickness, so it is refused first.
        let tagged = |error| with_tag(error, &self.element_tags);
        let linear = self.quadratic.is_empty();
        let checked = if linear {
            mesh.check()
        } else {
            mesh.check_elements()
        };
        checked.map_err(tagged)?;
        let (thickness, top) = orient(&mut mesh, &self.thickness_is_given, &mut notes);
        if !linear {
            make_quadratic(
                &mut mesh,
                &self.quadratic,
                &top,
                &mut self.node_tags,
                &mut notes,
            );
            mesh.check().map_err(tagged)?;
        }
        for faces in mesh.face_sets.values_mut() {
            faces.sort_unstable();
            faces.dedup();
        }
        let from_faces: Vec<(String, Vec<u32>)> = mesh
            .face_sets
            .iter()
            .map(|(name, faces)| (name.clone(), mesh.nodes_of(faces)))
            .collect();
        for (name, nodes) in from_faces {
            mesh.node_sets.entry(name).or_insert(nodes);
        }
        let mut report = report(&mesh, notes, thickness)?;
        report.node_tags = self.node_tags;
        report.element_tags = self.element_tags;
        Ok((mesh, report))
    }

    /// Files hold nodes of geometry that no hexahedron uses (centres of arcs, edges of other parts): they go.
    fn drop_unused_nodes(&mut self) {
        let used = (self.hexahedra.iter().flatten()).chain(self.quadratic.iter().flatten());
        let kept = Kept::new(self.nodes.len(), used);
        if kept.dropped == 0 {
            return;
        }
        self.notes.push(format!(
            "{} node(s) of the file belong to no hexahedron and were left out",
            kept.dropped
        ));
        kept.retain(&mut self.nodes);
        kept.retain(&mut self.node_tags);
        kept.renumber(self.hexahedra.iter_mut().flatten());
        kept.renumber(self.quadratic.iter_mut().flatten());
        kept.retain_sets(&mut self.node_sets, "hexahedron", &mut self.notes);
        // Quadrilaterals off the hexahedra keep a number that no face has.
        kept.renumber(self.surfaces.values_mut().flatten().flatten());
    }
}

/// Which nodes stay, and their new numbers.
struct Kept {
    /// `u32::MAX` for nodes that go.
    number: Vec<u32>,
    dropped: usize,
}

impl Kept {
    fn new<'n>(nodes: usize, used: impl Iterator<Item = &'n u32>) -> Kept {
        let mut number = vec![u32::MAX; nodes];
        for &n in used {
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
    fn retain<T>(&self, list: &mut Vec<T>) {
        let mut number = self.number.iter();
        list.retain(|_| number.next().is_some_and(|n| *n != u32::MAX));
    }

    fn renumber<'n>(&self, nodes: impl Iterator<Item = &'n mut u32>) {
        nodes.for_each(|n| *n = self.number[*n as usize]);
    }

    /// Sets without the nodes that go; those left empty go too, and a note tells of what they hold no node.
    fn retain_sets(
        &self,
        sets: &mut BTreeMap<String, Vec<u32>>,
        of: &str,
        notes: &mut Vec<String>,
    ) {
        sets.retain(|name, set| {
            set.retain(|&n| self.number[n as usize] != u32::MAX);
            self.renumber(set.iter_mut());
            if set.is_empty() {
                notes.push(format!("`{name}` holds no node of a {of} and was left out"));
            }
            !set.is_empty()
        });
    }
}

/// Turns a mesh of corners, its elements rotated, into one of 18-node elements. The nodes midway through the thickness
/// go: the element is linear there.
fn make_quadratic(
    mesh: &mut Mesh,
    full: &[[u32; 27]],
    top: &[u8],
    tags: &mut Vec<u64>,
    notes: &mut Vec<String>,
) {
    let mut connectivity = Vec::with_capacity(18 * full.len());
    let mut off = 0.0f64;
    for (full, &top) in full.iter().zip(top) {
        let mut nodes = [0; 27];
        for (slot, node) in nodes.iter_mut().zip(rotated(full, 3, top)) {
            *slot = node;
        }
        for a in 0..9 {
            let [low, middle, high] = [a, a + 9, a + 18].map(|a| mesh.nodes[nodes[a] as usize]);
            let thickness = (high - low).norm();
            off = off.max((middle - (low + high) * 0.5).norm() / thickness);
        }
        connectivity.extend_from_slice(&nodes[..9]);
        connectivity.extend_from_slice(&nodes[18..]);
    }
    mesh.kind = ElementKind::Q18;
    mesh.connectivity = connectivity;
    let kept = Kept::new(mesh.nodes.len(), mesh.connectivity.iter());
    notes.push(format!(
        "elements of 27 nodes became 18-node solid-shells: {} node(s) midway through the thickness were left out (they \
         lie up to {:.2} % of the thickness off the straight lines between bottom and top)",
        kept.dropped,
        100.0 * off
    ));
    kept.retain(&mut mesh.nodes);
    kept.retain(tags);
    kept.renumber(mesh.connectivity.iter_mut());
    let of = "bottom or top of an element";
    kept.retain_sets(&mut mesh.node_sets, of, notes);
}

/// Turns quadrilaterals into faces of the elements.
fn match_surfaces(
    mesh: &mut Mesh,
    surfaces: &BTreeMap<String, Vec<[u32; 4]>>,
    notes: &mut Vec<String>,
) {
    if surfaces.is_empty() {
        return;
    }
    let table = FaceTable::new(mesh);
    for (name, quads) in surfaces {
        let mut faces = Vec::with_capacity(quads.len());
        let (mut lost, mut inner) = (0usize, 0usize);
        for &quad in quads {
            match table.find(quad) {
                [] => lost += 1,
                [row] => faces.push(row.1),
                rows => {
                    inner += 1;
                    // More than two are an error, which the checks of the mesh tell.
                    let same = (rows.iter().take(2))
                        .find(|row| goes_around(mesh.face_corners(row.1), quad));
                    faces.push(same.unwrap_or(&rows[0]).1);
                }
            }
        }
        if lost > 0 {
            notes.push(format!(
                "surface `{name}`: {lost} of {} quadrilaterals are not faces of hexahedra and were left out",
                quads.len()
            ));
        }
        if inner > 0 {
            notes.push(format!(
                "surface `{name}`: {inner} quadrilaterals lie between two hexahedra; each stands for the face whose \
                 outward normal is its own"
            ));
        }
        if !faces.is_empty() {
            mesh.face_sets
                .entry(name.clone())
                .or_default()
                .extend(faces);
        }
    }
}

/// Whether the face (u fastest) has the nodes of `quad` in the same sense of rotation.
fn goes_around(face: [u32; 4], quad: [u32; 4]) -> bool {
    let around = AROUND.map(|a| face[a]);
    let next = |q: &[u32; 4], n| {
        let at = q.iter().position(|&m| m == n)?;
        Some(q[(at + 1) % 4])
    };
    next(&around, quad[0]) == Some(quad[1])
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

/// Adds the element's number in the file to an error.
fn with_tag(mut error: MeshError, tags: &[u64]) -> MeshError {
    if let MeshError::Inverted { element, tag, .. } = &mut error {
        *tag = tags.get(*element as usize).copied();
    }
    error
}
