//! Is a mesh fit for computing?
use super::measure::H8_EDGES;
use super::topology::FaceTable;
use super::{ElementKind, H8_FACES, Mesh, MeshError};
use covact_geometry::Vec3;

/// Scaled Jacobians up to this count as inverted or degenerate: well above round-off, well below any usable shape.
const MIN_SHAPE: f64 = 1e-10;

/// Nodes closer than this part of the shortest edge count as one.
const SAME_PLACE: f64 = 1e-6;

/// Nodes in the same cell that a node is compared with.
const MOST_AT_ONE_PLACE: usize = 64;

impl Mesh {
    /// Finds what would make a computation fail or mean something else than intended: node numbers and positions out
    /// of range, inverted elements, duplicate and unused nodes, non-manifold faces, sets with unknown members.
    ///
    /// Returns the first kind of trouble found, in that order, with the number of cases of it.
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_with(false)
    }

    /// [`check`](Self::check) of a mesh whose nodes at the same place are the two sides of `slits`, where that is so.
    pub(crate) fn check_with(&self, slits: bool) -> Result<(), MeshError> {
        self.check_numbers()?;
        self.check_elements()?;
        self.check_nodes(slits)?;
        self.check_faces()
    }

    fn check_numbers(&self) -> Result<(), MeshError> {
        let nodes = self.nodes.len();
        let out = |what: String, kind, number: u32, count| MeshError::OutOfRange {
            what,
            kind,
            number: number.into(),
            count,
        };
        if let Some(n) = self
            .nodes
            .iter()
            .position(|x| !x.iter().all(|v| v.is_finite()))
        {
            return Err(MeshError::NotFinite {
                node: n as u32,
                position: self.nodes[n].into(),
            });
        }
        if let Some(i) = self.connectivity.iter().position(|&n| n as usize >= nodes) {
            let what = format!("element {}", i / self.kind.nodes());
            return Err(out(what, "node", self.connectivity[i], nodes));
        }
        for (name, set) in &self.node_sets {
            if let Some(&n) = set.iter().find(|&&n| n as usize >= nodes) {
                return Err(out(format!("node set `{name}`"), "node", n, nodes));
            }
        }
        for (name, set) in &self.face_sets {
            let elements = self.elements();
            if let Some(f) = set.iter().find(|f| f.element as usize >= elements) {
                return Err(out(
                    format!("face set `{name}`"),
                    "element",
                    f.element,
                    elements,
                ));
            }
            if let Some(f) = set.iter().find(|f| f.face as usize >= H8_FACES.len()) {
                let what = format!("face set `{name}`, element {}", f.element);
                return Err(out(what, "local face", f.face.into(), H8_FACES.len()));
            }
        }
        Ok(())
    }

    /// Inverted and degenerate elements.
    pub(super) fn check_elements(&self) -> Result<(), MeshError> {
        let mut first = None;
        let mut count = 0;
        for e in 0..self.elements() {
            let mut sound = true;
            let mut smallest = f64::INFINITY;
            self.node_shapes(e, |jacobian, shape| {
                // NaN (from overflow) counts as inverted.
                sound &= shape > MIN_SHAPE;
                smallest = smallest.min(jacobian);
            });
            if !sound {
                count += 1;
                first.get_or_insert((e, smallest));
            }
        }
        match first {
            None => Ok(()),
            Some((e, jacobian)) => Err(MeshError::Inverted {
                element: e as u32,
                tag: None,
                position: self.element_center(e).into(),
                jacobian,
                count,
            }),
        }
    }

    fn check_nodes(&self, slits: bool) -> Result<(), MeshError> {
        let mut used = vec![false; self.nodes.len()];
        for &n in &self.connectivity {
            used[n as usize] = true;
        }
        if let Some(n) = used.iter().position(|u| !u) {
            return Err(MeshError::UnusedNode {
                node: n as u32,
                position: self.nodes[n].into(),
                count: used.iter().filter(|u| !**u).count(),
            });
        }
        let mut shortest = f64::INFINITY;
        for e in 0..self.elements() {
            let x = self.element_positions(e);
            for [a, b] in H8_EDGES {
                shortest = shortest.min((x[b as usize] - x[a as usize]).norm());
            }
        }
        let pairs = close_pairs(&self.nodes, shortest);
        let wrong = match pairs.is_empty() {
            true => Vec::new(),
            false => self.wrong_pairs(&pairs, slits),
        };
        match wrong.first() {
            None => Ok(()),
            Some(&[first, second]) => Err(MeshError::DuplicateNodes {
                tags: None,
                first,
                second,
                position: self.nodes[first as usize].into(),
                count: wrong.len(),
            }),
        }
    }

    /// Pairs of nodes at the same place that cannot be meant: within one part, unless it has `slits`, or of two elements that fill
    /// the same place. Parts that only touch are kept apart: they may be partners in contact.
    fn wrong_pairs(&self, pairs: &[[u32; 2]], slits: bool) -> Vec<[u32; 2]> {
        let part = self.parts();
        let mut twin: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for &[a, b] in pairs {
            // The first of all nodes at a place stands for them.
            twin[b as usize] = twin[a as usize].min(twin[b as usize]);
        }
        let mut places: Vec<([u32; 8], u32)> = (0..self.elements())
            .map(|e| {
                let nodes = self.element(e);
                let mut key = self.kind.corners().map(|a| twin[nodes[a] as usize]);
                key.sort_unstable();
                (key, e as u32)
            })
            .collect();
        places.sort_unstable();
        let mut doubled = vec![false; self.nodes.len()];
        for group in places.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() > 1) {
            for node in group.iter().flat_map(|(_, e)| self.element(*e as usize)) {
                doubled[*node as usize] = true;
            }
        }
        let wrong = |[a, b]: &&[u32; 2]| {
            !slits && part[*a as usize] == part[*b as usize]
                || (doubled[*a as usize] && doubled[*b as usize])
        };
        pairs.iter().filter(wrong).copied().collect()
    }

    /// Number of pairs of nodes at the same place, in parts that are not connected.
    pub(super) fn touching_pairs(&self) -> usize {
        let mut shortest = f64::INFINITY;
        for e in 0..self.elements() {
            let x = self.element_positions(e);
            for [a, b] in H8_EDGES {
                shortest = shortest.min((x[b as usize] - x[a as usize]).norm());
            }
        }
        close_pairs(&self.nodes, shortest).len()
    }

    fn check_faces(&self) -> Result<(), MeshError> {
        let table = FaceTable::new(self);
        for group in table.groups() {
            let same_side = || {
                let [a, b] = [group[0].1, group[1].1].map(|f| self.face_corners(f));
                !is_opposite(a, b)
            };
            if group.len() > 2 || (group.len() == 2 && same_side()) {
                let nodes = group[0].0.map(|n| self.nodes[n as usize]);
                return Err(MeshError::NonManifold {
                    elements: group.iter().map(|row| row.1.element).collect(),
                    position: (nodes.iter().sum::<Vec3>() / 4.0).into(),
                });
            }
            // Quadratic faces have more nodes than the corners they were found by.
            if self.kind == ElementKind::Q18
                && let [a, b] = group
            {
                let [one, other] = [a.1, b.1].map(|f| self.nodes_of(&[f]));
                if one != other {
                    let nodes = a.0.map(|n| self.nodes[n as usize]);
                    return Err(MeshError::UnlikeFaces {
                        elements: [a.1.element, b.1.element],
                        position: (nodes.iter().sum::<Vec3>() / 4.0).into(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// Whether two faces with the same nodes (u fastest) look in opposite directions.
pub(super) fn is_opposite(a: [u32; 4], b: [u32; 4]) -> bool {
    // Around the face: 0, 1, 3, 2. In an opposite face the successor of a node is its predecessor in the other.
    let around = |f: [u32; 4]| [f[0], f[1], f[3], f[2]];
    let (a, b) = (around(a), around(b));
    match b.iter().position(|&n| n == a[0]) {
        Some(i) => b[(i + 3) % 4] == a[1] && b[(i + 1) % 4] == a[3] && b[(i + 2) % 4] == a[2],
        None => false,
    }
}

/// Pairs of nodes closer than [`SAME_PLACE`] times `size`, sorted.
pub(super) fn close_pairs(nodes: &[Vec3], size: f64) -> Vec<[u32; 2]> {
    let tolerance = SAME_PLACE * size;
    // Cells of half the shortest edge hold a node or two; a node next to a cell's border is also put into the cell
    // beyond, so that both nodes of a pair always share a cell.
    let cell = 0.5 * size;
    // The shift keeps the nodes of regular meshes off the borders of cells.
    let index = |x: f64| (x / cell + 0.31).floor() as i64;
    let mut cells = Vec::with_capacity(nodes.len());
    for (n, x) in nodes.iter().enumerate() {
        let low = x.map(|v| index(v - tolerance));
        let high = x.map(|v| index(v + tolerance));
        for i in low.x..=high.x {
            for j in low.y..=high.y {
                for k in low.z..=high.z {
                    cells.push(([i, j, k], n as u32));
                }
            }
        }
    }
    cells.sort_unstable();
    let mut pairs = Vec::new();
    for group in cells.chunk_by_mut(|a, b| a.0 == b.0) {
        if group.len() > MOST_AT_ONE_PLACE {
            group.sort_by(|a, b| {
                let [a, b] = [a.1, b.1].map(|n| nodes[n as usize]);
                let order = |k: usize| a[k].total_cmp(&b[k]);
                order(0).then(order(1)).then(order(2))
            });
        }
        for (i, a) in group.iter().enumerate() {
            // Of very many nodes in one place each is paired with the next ones only: all pairs would be as many as
            // their square.
            for b in group[i + 1..].iter().take(MOST_AT_ONE_PLACE) {
                if (nodes[a.1 as usize] - nodes[b.1 as usize]).norm() <= tolerance {
                    pairs.push([a.1.min(b.1), a.1.max(b.1)]);
                }
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
