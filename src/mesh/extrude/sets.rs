//! Names of the sides, borders and sets of an extruded surface.
use super::cells::Cells;
use super::edges::{Edges, Row};
use super::surface::Surface;
use crate::mesh::error::listed;
use crate::mesh::{Face, Mesh};
use covact_geometry::Vec3;

/// The border counts as on a side of the bounding box within this part of the box's diagonal.
const ON_SIDE: f64 = 1e-6;

/// More borders than this have no sets of their own.
const MOST_BORDERS: usize = 1000;

/// Adds all sets to the body.
pub(super) fn name(
    mesh: &mut Mesh,
    surface: &Surface,
    cells: &Cells,
    edges: &Edges,
    layers: u32,
    notes: &mut Vec<String>,
) {
    let mut names = Names {
        mesh,
        surface,
        cells,
        layers,
    };
    let facets: Vec<u32> = (0..cells.count() as u32).collect();
    names.sides("bottom", "top", &facets);
    names.of_file(edges, notes);
    names.borders(edges, notes);
    let nodes: Vec<(String, Vec<u32>)> = (mesh.face_sets.iter())
        .map(|(name, faces)| (name.clone(), mesh.nodes_of(faces)))
        .collect();
    for (name, nodes) in nodes {
        let set = mesh.node_sets.entry(name).or_default();
        set.extend(nodes);
    }
    for set in mesh.node_sets.values_mut() {
        set.sort_unstable();
        set.dedup();
    }
}

struct Names<'m> {
    mesh: &'m mut Mesh,
    surface: &'m Surface,
    cells: &'m Cells,
    layers: u32,
}

impl Names<'_> {
    /// Lower and upper faces of some elements.
    fn sides(&mut self, bottom: &str, top: &str, facets: &[u32]) {
        let above = self.cells.count() as u32 * (self.layers - 1);
        let mut set = |name: &str, first: u32, face: u8| {
            let faces = facets.iter().map(|f| Face {
                element: f + first,
                face,
            });
            self.faces(name, faces.collect());
        };
        set(bottom, 0, 4);
        set(top, above, 5);
    }

    fn faces(&mut self, name: &str, faces: Vec<Face>) {
        let set = self.mesh.face_sets.entry(name.to_string()).or_default();
        set.extend(faces);
        set.sort_unstable();
        set.dedup();
    }

    fn edge_faces<'r>(&self, rows: impl Iterator<Item = &'r Row>) -> Vec<Face> {
        rows.flat_map(|row| self.cells.edge_faces(row.facet, row.side, self.layers))
            .collect()
    }

    /// The file's own sets: of elements on both sides, of lines on the border, of nodes through the thickness.
    fn of_file(&mut self, edges: &Edges, notes: &mut Vec<String>) {
        let mut renamed = Vec::new();
        let own = |name: &str, renamed: &mut Vec<String>| match name {
            "top" | "bottom" => {
                renamed.push(format!("`{name}`"));
                format!("file_{name}")
            }
            _ => name.to_string(),
        };
        for (name, facets) in &self.surface.sets {
            self.sides(&format!("{name}_bottom"), &format!("{name}_top"), facets);
        }
        for (name, lines) in &self.surface.lines {
            let on_border = lines.iter().filter_map(|&[a, b]| {
                let rows = edges.rows(edges.find(a, b)?);
                (rows.len() == 1).then_some(&rows[0])
            });
            let faces = self.edge_faces(on_border);
            if !faces.is_empty() {
                self.faces(&own(name, &mut Vec::new()), faces);
            }
        }
        let count = self.surface.nodes.len() as u32;
        for (name, nodes) in &self.surface.node_sets {
            let levels = 0..=self.layers;
            let column = |n: &u32| {
                levels
                    .clone()
                    .map(move |k| n + k * count)
                    .collect::<Vec<_>>()
            };
            let all = nodes.iter().flat_map(column).collect();
            self.mesh.node_sets.insert(own(name, &mut renamed), all);
        }
        if !renamed.is_empty() {
            notes.push(format!(
                "`top` and `bottom` are the sides of the extruded surface; the file's sets {} have `file_` before their names",
                listed(renamed)
            ));
        }
    }

    /// All borders, each border, and those on the sides of the bounding box.
    fn borders(&mut self, edges: &Edges, notes: &mut Vec<String>) {
        let mut loops = edges.loops(self.surface);
        if loops.is_empty() {
            return;
        }
        let length = |rows: &[Row]| -> f64 {
            let edge = |row: &Row| {
                let [a, b] = row.ends.map(|n| self.surface.nodes[n as usize]);
                (b - a).norm()
            };
            rows.iter().map(edge).sum()
        };
        let mut lengths: Vec<(f64, usize)> = loops
            .iter()
            .map(|l| length(l))
            .zip(0..loops.len())
            .collect();
        lengths.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let free = |names: &Self, name: String| match names.mesh.face_sets.contains_key(&name) {
            // The file's own sets keep their names.
            true => None,
            false => Some(name),
        };
        if let Some(name) = free(self, "border".to_string()) {
            let faces = self.edge_faces(edges.border());
            self.faces(&name, faces);
        }
        if loops.len() > MOST_BORDERS {
            notes.push(format!(
                "the surface has {} borders, which are no sets of their own: they are all in `border`",
                loops.len()
            ));
            lengths.clear();
        }
        let mut told = Vec::new();
        for (k, &(length, which)) in lengths.iter().enumerate() {
            if let Some(name) = free(self, format!("border_{}", k + 1)) {
                let rows = std::mem::take(&mut loops[which]);
                let faces = self.edge_faces(rows.iter());
                told.push(format!("`{name}` ({length:.4} long)"));
                self.faces(&name, faces);
            }
        }
        if told.len() > 1 {
            notes.push(format!("borders: {}", listed(told)));
        }
        let low = (self.surface.nodes.iter()).fold(self.surface.nodes[0], |a, x| a.inf(x));
        let high = (self.surface.nodes.iter()).fold(self.surface.nodes[0], |a, x| a.sup(x));
        let slack = ON_SIDE * (high - low).norm();
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            if high[axis] - low[axis] <= 2.0 * slack {
                continue;
            }
            for (end, at) in [("min", low[axis]), ("max", high[axis])] {
                let on = |n: u32| {
                    let x: &Vec3 = &self.surface.nodes[n as usize];
                    (x[axis] - at).abs() <= slack
                };
                let rows = edges.border().filter(|row| row.ends.iter().all(|&n| on(n)));
                let faces = self.edge_faces(rows);
                if let Some(name) = free(self, format!("{letter}_{end}"))
                    && !faces.is_empty()
                {
                    self.faces(&name, faces);
                }
            }
        }
    }
}
