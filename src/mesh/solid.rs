//! Hexahedra of a file as a mesh: surfaces become faces, the thickness direction is found, what is of no use goes.
use super::orient::{orient, rotated};
use super::raw::{Facets, Kept, NONE, RawMesh, report, with_tags};
use super::topology::FaceTable;
use super::{ElementKind, Mesh, MeshError, MeshReport};
use std::path::Path;

const SURFACE: &str = "they are elements of a surface: give it a thickness (`\"file\": {\"path\": ..., \"thickness\": 1}`)";

/// The nodes midway through the thickness of a 20-node hexahedron may lie off the straight line by this part of the
/// thickness, because the 18-node element is straight there.
const STRAIGHT: f64 = 0.01;

/// Local faces whose tensor order is (0, 1, 3, 2) around the border.
const AROUND: [usize; 4] = [0, 1, 3, 2];

impl RawMesh {
    /// Drops unused nodes, matches surfaces to faces, chooses the thickness direction and checks the result.
    pub(super) fn into_mesh(
        mut self,
        path: &Path,
        scale: f64,
        slits: bool,
    ) -> Result<(Mesh, MeshReport), MeshError> {
        if let Some(refused) = self.refused.take() {
            return Err(refused);
        }
        if self.hexahedra.is_empty() {
            let help = match self.facets.is_empty() {
                true => self.help.to_string(),
                false => format!("{SURFACE}; or: {}", self.help),
            };
            return Err(self.nothing(path, "hexahedra", help));
        }
        let facets = 0..self.facets.len() as u32;
        let triangles = facets.filter(|&f| self.facets.is_triangle(f)).count();
        if triangles > 0 {
            self.notes
                .push(format!("{triangles} triangles were left out"));
        }
        self.complete_hexahedra();
        self.add_nodes_of_elements();
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
        match_surfaces(&mut mesh, &self.facets, &mut notes);
        // A reversed element would mislead the search for its thickness, so it is refused first.
        let tagged = |error, nodes: &[u64]| with_tags(error, &self.element_tags, nodes);
        let linear = self.quadratic.is_empty();
        let checked = if linear {
            mesh.check_with(slits)
        } else {
            mesh.check_elements()
        };
        checked.map_err(|e| tagged(e, &self.node_tags))?;
        let (thickness, top) = orient(&mut mesh, &self.thickness_is_given, &mut notes);
        if !linear {
            let crooked = straighten(&mesh, &self.quadratic, &top);
            if self.completed && crooked.1 > STRAIGHT {
                return Err(MeshError::Crooked {
                    path: path.to_path_buf(),
                    tag: self.element_tags.get(crooked.0).copied().unwrap_or(0),
                    position: mesh.element_center(crooked.0).into(),
                    off: 100.0 * crooked.1,
                });
            }
            make_quadratic(
                &mut mesh,
                &self.quadratic,
                &top,
                (crooked.1, self.completed),
                &mut self.node_tags,
                &mut notes,
            );
            mesh.check_with(slits)
                .map_err(|e| tagged(e, &self.node_tags))?;
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

    /// Node sets of the nodes of element sets.
    fn add_nodes_of_elements(&mut self) {
        for (name, set) in &self.solid_sets {
            let nodes = self.node_sets.entry(name.clone()).or_default();
            for &e in set {
                match self.quadratic.get(e as usize) {
                    Some(all) => nodes.extend(all),
                    None => nodes.extend(self.hexahedra[e as usize]),
                }
            }
        }
        for (name, set) in &self.facets.sets {
            let nodes = self.node_sets.entry(name.clone()).or_default();
            set.iter().for_each(|&f| nodes.extend(self.facets.nodes(f)));
        }
        for nodes in self.node_sets.values_mut() {
            // Neighbours share nodes; there may be many sets.
            nodes.sort_unstable();
            nodes.dedup();
            nodes.shrink_to_fit();
        }
    }

    /// Files hold nodes of geometry that no hexahedron uses (centres of arcs, edges of other parts): they go.
    fn drop_unused_nodes(&mut self) {
        let corners = self.hexahedra.iter().flatten();
        let used = corners.chain(self.quadratic.iter().flatten()).copied();
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
        // Quadrilaterals off the hexahedra get a number that no face has, which is not that of triangles.
        let corners = self.facets.corners.iter_mut().flatten();
        for node in corners.filter(|n| **n != NONE) {
            *node = kept.number(*node).min(NONE - 1);
        }
    }
}

/// How far the nodes midway through the thickness lie off the straight lines between bottom and top, at most, as a part of
/// the thickness; and the element where that is.
fn straighten(mesh: &Mesh, full: &[[u32; 27]], top: &[u8]) -> (usize, f64) {
    let mut worst = (0, 0.0);
    for (e, (full, &top)) in full.iter().zip(top).enumerate() {
        let mut nodes = [0; 27];
        for (slot, node) in nodes.iter_mut().zip(rotated(full, 3, top)) {
            *slot = node;
        }
        for a in 0..9 {
            let [low, middle, high] = [a, a + 9, a + 18].map(|a| mesh.nodes[nodes[a] as usize]);
            let off = (middle - (low + high) * 0.5).norm() / (high - low).norm();
            if off > worst.1 {
                worst = (e, off);
            }
        }
    }
    worst
}

/// Turns a mesh of corners, its elements rotated, into one of 18-node elements. The nodes midway through the thickness
/// go: the element is linear there.
fn make_quadratic(
    mesh: &mut Mesh,
    full: &[[u32; 27]],
    top: &[u8],
    (off, completed): (f64, bool),
    tags: &mut Vec<u64>,
    notes: &mut Vec<String>,
) {
    let mut connectivity = Vec::with_capacity(18 * full.len());
    for (full, &top) in full.iter().zip(top) {
        let mut nodes = [0; 27];
        for (slot, node) in nodes.iter_mut().zip(rotated(full, 3, top)) {
            *slot = node;
        }
        connectivity.extend_from_slice(&nodes[..9]);
        connectivity.extend_from_slice(&nodes[18..]);
    }
    mesh.kind = ElementKind::Q18;
    mesh.connectivity = connectivity;
    let kept = Kept::new(mesh.nodes.len(), mesh.connectivity.iter().copied());
    notes.push(match completed {
        true => "20-node elements became 18-node solid-shells: the nodes in the middle of bottom and top were made, those \
                 midway through the thickness left out"
            .to_string(),
        false => format!(
            "elements of 27 nodes became 18-node solid-shells: {} node(s) midway through the thickness were left out (they \
             lie up to {:.2} % of the thickness off the straight lines between bottom and top)",
            kept.dropped,
            100.0 * off
        ),
    });
    kept.retain(&mut mesh.nodes);
    kept.retain(tags);
    kept.renumber(mesh.connectivity.iter_mut());
    let of = "bottom or top of an element";
    kept.retain_sets(&mut mesh.node_sets, of, notes);
}

/// Turns quadrilaterals into faces of the elements.
fn match_surfaces(mesh: &mut Mesh, facets: &Facets, notes: &mut Vec<String>) {
    if facets.sets.is_empty() {
        return;
    }
    let table = FaceTable::new(mesh);
    for (name, set) in &facets.sets {
        let mut faces = Vec::with_capacity(set.len());
        let (mut triangles, mut lost, mut inner) = (0usize, 0usize, 0usize);
        for &facet in set {
            // A triangle has no node here, and so has no face.
            let quad = facets.corners[facet as usize];
            match table.find(quad) {
                [] if facets.is_triangle(facet) => triangles += 1,
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
        if triangles > 0 {
            notes.push(format!(
                "surface `{name}`: {triangles} triangles were left out"
            ));
        }
        if lost > 0 {
            notes.push(format!(
                "surface `{name}`: {lost} of {} quadrilaterals are not faces of hexahedra and were left out",
                set.len()
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
