//! How elements hang together: shared faces, outer faces, connected parts, columns through the thickness.
use super::{ElementKind, Face, H8_FACES, Mesh};

/// All faces of a mesh sorted by their nodes, so that the faces that two elements share are neighbours in the table.
pub(super) struct FaceTable {
    /// Sorted corners of a face, and the face.
    rows: Vec<([u32; 4], Face)>,
}

impl FaceTable {
    pub(super) fn new(mesh: &Mesh) -> FaceTable {
        let mut rows = Vec::with_capacity(6 * mesh.elements());
        for e in 0..mesh.elements() {
            for face in 0..H8_FACES.len() {
                let face = Face {
                    element: e as u32,
                    face: face as u8,
                };
                rows.push((sorted(mesh.face_corners(face)), face));
            }
        }
        rows.sort_unstable();
        FaceTable { rows }
    }

    /// Groups of faces with the same corners.
    pub(super) fn groups(&self) -> impl Iterator<Item = &[([u32; 4], Face)]> {
        self.rows.chunk_by(|a, b| a.0 == b.0)
    }

    /// Faces with these corners, in any order.
    pub(super) fn find(&self, nodes: [u32; 4]) -> &[([u32; 4], Face)] {
        let key = sorted(nodes);
        let from = self.rows.partition_point(|row| row.0 < key);
        let to = from + self.rows[from..].partition_point(|row| row.0 == key);
        &self.rows[from..to]
    }
}

fn sorted(mut nodes: [u32; 4]) -> [u32; 4] {
    nodes.sort_unstable();
    nodes
}

impl Mesh {
    /// Faces that belong to one element only, sorted.
    pub fn outer_faces(&self) -> Vec<Face> {
        if self.kind == ElementKind::Nurbs {
            let elements = 0..self.elements() as u32;
            let both = |element| [4, 5].map(|face| Face { element, face });
            return elements.flat_map(both).collect();
        }
        let table = FaceTable::new(self);
        let mut faces: Vec<Face> = table
            .groups()
            .filter(|group| group.len() == 1)
            .map(|group| group[0].1)
            .collect();
        faces.sort_unstable();
        faces
    }

    /// Nodes of some faces, sorted and without duplicates.
    pub fn nodes_of(&self, faces: &[Face]) -> Vec<u32> {
        let mut nodes = Vec::new();
        for &face in faces {
            match self.kind {
                ElementKind::Nurbs => nodes.extend_from_slice(self.element(face.element as usize)),
                _ => nodes.extend_from_slice(self.face_nodes(face).nodes()),
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Number of parts that share no node with each other (nodes without elements are not counted).
    pub fn components(&self) -> usize {
        let mut used = vec![false; self.nodes.len()];
        self.connectivity
            .iter()
            .for_each(|&n| used[n as usize] = true);
        let part = self.parts();
        (0..self.nodes.len())
            .filter(|&n| used[n] && part[n] as usize == n)
            .count()
    }

    /// For every node one that stands for the part it belongs to.
    pub(super) fn parts(&self) -> Vec<u32> {
        let mut parent: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for e in 0..self.elements() {
            let nodes = self.element(e);
            let first = root(&mut parent, nodes[0]);
            for &node in nodes {
                let other = root(&mut parent, node);
                parent[other as usize] = first;
            }
        }
        (0..self.nodes.len() as u32)
            .map(|n| root(&mut parent, n))
            .collect()
    }

    /// For every node on a bottom or top outer face the node at the other end of its column through all layers, `None`
    /// for nodes inside the thickness and where columns branch (elements that disagree about the thickness direction).
    pub fn opposite_nodes(&self) -> Vec<Option<u32>> {
        ThicknessColumns::new(self).partners()
    }

    /// The node at the other end of the column of `node`. For many nodes take [`Mesh::opposite_nodes`] or
    /// [`ThicknessColumns`], which go through the mesh once.
    pub fn thickness_partner(&self, node: u32) -> Option<u32> {
        ThicknessColumns::new(self).partner(node)
    }
}

/// Root of a node in a union-find forest, halving the path on the way.
pub(super) fn root(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let next = parent[parent[node as usize] as usize];
        parent[node as usize] = next;
        node = next;
    }
    node
}

const NONE: u32 = u32::MAX;
const BRANCH: u32 = u32::MAX - 1;

/// Nodes above each other through the thickness.
#[derive(Debug, Clone)]
pub struct ThicknessColumns {
    up: Vec<u32>,
    down: Vec<u32>,
}

impl ThicknessColumns {
    /// Links the nodes of all elements that lie above each other (along t).
    pub fn new(mesh: &Mesh) -> ThicknessColumns {
        let mut up = vec![NONE; mesh.nodes.len()];
        let mut down = vec![NONE; mesh.nodes.len()];
        let link = |slot: &mut u32, node: u32| {
            *slot = if *slot == NONE || *slot == node {
                node
            } else {
                BRANCH
            };
        };
        for e in 0..mesh.elements() {
            let nodes = mesh.element(e);
            let (below, above) = nodes.split_at(nodes.len() / 2);
            for (&below, &above) in below.iter().zip(above) {
                link(&mut up[below as usize], above);
                link(&mut down[above as usize], below);
            }
        }
        ThicknessColumns { up, down }
    }

    /// Node at the other end of the column; `None` for nodes inside the thickness, numbers out of range, and columns
    /// that branch or run in a circle.
    pub fn partner(&self, node: u32) -> Option<u32> {
        let n = node as usize;
        match (*self.up.get(n)?, *self.down.get(n)?) {
            (NONE, NONE) => None,
            (_, NONE) => self.end(node, &self.up, &self.down),
            (NONE, _) => self.end(node, &self.down, &self.up),
            _ => None,
        }
    }

    /// Bottom and top node of the column through `node`.
    pub fn ends(&self, node: u32) -> Option<[u32; 2]> {
        if node as usize >= self.up.len() {
            return None;
        }
        let bottom = self.end(node, &self.down, &self.up)?;
        let top = self.end(node, &self.up, &self.down)?;
        (bottom != top).then_some([bottom, top])
    }

    /// The nodes of the column that begins at `bottom` (see [`ThicknessColumns::ends`]), upwards.
    pub fn upwards(&self, bottom: u32) -> impl Iterator<Item = u32> {
        let next = |node: &u32| self.up.get(*node as usize).copied().filter(|n| *n < BRANCH);
        std::iter::successors(Some(bottom), next)
    }

    /// The nodes above and below one in its column, as far as there is one.
    pub fn neighbours(&self, node: u32) -> [Option<u32>; 2] {
        [&self.up, &self.down].map(|side| side.get(node as usize).copied().filter(|n| *n < BRANCH))
    }

    /// [`ThicknessColumns::partner`] of every node.
    pub fn partners(&self) -> Vec<Option<u32>> {
        (0..self.up.len() as u32).map(|n| self.partner(n)).collect()
    }

    fn end(&self, node: u32, ahead: &[u32], back: &[u32]) -> Option<u32> {
        let mut at = node;
        // No column is longer than the mesh; one that is runs in a circle.
        for _ in 0..=ahead.len() {
            match ahead[at as usize] {
                NONE => return Some(at),
                BRANCH => return None,
                next if back[next as usize] != at => return None,
                next => at = next,
            }
        }
        None
    }
}
