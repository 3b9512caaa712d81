//! CAD surfaces as thin shells: one NURBS patch is the mid-surface, its knot spans are the elements, its control points the
//! nodes.
mod anchors;
mod borders;
mod edges;
mod error;
mod refine;
pub(crate) mod seams;
mod select;
mod trims;

use super::{ElementKind, Face, Mesh};
pub use anchors::Anchor;
pub(crate) use borders::width_across;
pub use borders::{Border, BorderPoint, TrimEdge};
use covact_geometry::{NurbsPatch, PatchShape, Vec3};
pub use error::NurbsError;
pub use refine::Fineness;
pub use seams::{Joints, Near, Seam};
use std::collections::BTreeMap;
pub use trims::{Cut, GROUP, Kept};

/// Degree of the elements along both directions.
pub const DEGREE: usize = 3;

/// An edge of a patch: its side 0 is xi1 = start, 1 is xi1 = end, 2 is xi2 = start, 3 is xi2 = end. Scenes count from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Edge {
    patch: u32,
    side: u8,
}

impl Edge {
    /// All four of the first patch.
    pub const ALL: [Edge; 4] = Edge::of(0);

    /// All four of a patch.
    pub const fn of(patch: usize) -> [Edge; 4] {
        let patch = patch as u32;
        [
            Edge { patch, side: 0 },
            Edge { patch, side: 1 },
            Edge { patch, side: 2 },
            Edge { patch, side: 3 },
        ]
    }

    /// Place of its patch in [`NurbsSheet::patches`].
    pub const fn patch(self) -> usize {
        self.patch as usize
    }

    /// Which of the four it is, counted from zero.
    pub const fn side(self) -> usize {
        self.side as usize
    }

    /// The direction that is constant along it.
    pub const fn direction(self) -> usize {
        self.side as usize / 2
    }

    /// Whether that is at its end, not at its start.
    pub const fn at_end(self) -> bool {
        self.side % 2 == 1
    }
}

/// A patch of a sheet, bicubic and as fine as the elements are to be.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetPatch {
    /// The mid-surface, without a trim. `rho_1 x rho_2` points to the top.
    pub patch: NurbsPatch,
    /// Number of the face in its file.
    pub face: u32,
    /// xi1 runs against that of the file, so that all patches have their top on one side.
    pub reversed: bool,
    /// Number of its first control point in the sheet.
    pub first_node: u32,
    /// Number of its first element in the sheet.
    pub first_element: u32,
    /// What a trim leaves of it; none where it is whole.
    pub cut: Option<Cut>,
}

impl SheetPatch {
    /// Knot spans along both directions.
    pub fn spans(&self) -> [usize; 2] {
        [0, 1].map(|dir| self.patch.spans(dir).len())
    }

    /// Elements.
    pub fn elements(&self) -> usize {
        self.spans().iter().product()
    }

    /// Control points.
    pub fn nodes(&self) -> usize {
        self.patch.homogeneous().len()
    }

    /// Control points at the corners, numbered in the sheet: xi1 fastest, as it is here.
    pub fn corners(&self) -> [u32; 4] {
        let [nu, nv] = self.patch.counts();
        [0, nu - 1, nu * (nv - 1), nu * nv - 1].map(|k| self.first_node + k as u32)
    }

    /// Number of an edge as the file's parameters count it, from one.
    fn side_in_file(&self, edge: Edge) -> usize {
        1 + match (self.reversed, edge.side) {
            (true, side @ 0..=1) => usize::from(1 - side),
            (_, side) => usize::from(side),
        }
    }
}

/// Patches that stand for a shell of constant thickness, joined along common edges.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsSheet {
    /// One at least.
    pub patches: Vec<SheetPatch>,
    /// Where they are joined.
    pub joints: Joints,
    /// Half of it lies on either side.
    pub thickness: f64,
    /// Membrane strains are assumed.
    pub assumed_membrane: bool,
    /// Borders that each set of nodes is made of, where it is made of borders.
    pub edge_sets: BTreeMap<String, Vec<Border>>,
    /// Points of curves of trims that have a node of their own, which supports hold; their nodes follow the control points.
    pub anchors: Vec<Anchor>,
}

/// Sign of a face of a sheet: its outward normal along the normal of the mid-surface. None for other numbers than 4, the bottom,
/// and 5, the top.
pub fn side(face: Face) -> Option<f64> {
    match face.face {
        4 => Some(-1.0),
        5 => Some(1.0),
        _ => None,
    }
}

/// A point of a sheet's mid-surface with the shape functions of the control points that act on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetPoint {
    /// Control points, numbered in the sheet.
    pub nodes: [u32; 16],
    /// Shape functions of those control points.
    pub n: [f64; 16],
    /// Derivatives along xi1 and xi2.
    pub n_i: [[f64; 16]; 2],
    /// Undeformed area that it stands for.
    pub area: f64,
    /// Weight of the rule, in parameters.
    pub weight: f64,
    /// Unit normal of the undeformed mid-surface.
    pub normal: Vec3,
    /// Position on the undeformed mid-surface.
    pub position: Vec3,
}

impl SheetPatch {
    /// A point of a span that stands for `weight` of its parameters; `positions` are the control points of the patch.
    fn point(
        &self,
        span: [usize; 2],
        xi: [f64; 2],
        weight: f64,
        positions: &[Vec3],
        room: &mut PatchShape,
    ) -> SheetPoint {
        self.patch.shape_in_span(span, xi, room);
        let mut out = SheetPoint {
            nodes: [0; 16],
            n: [0.0; 16],
            n_i: [[0.0; 16]; 2],
            area: 0.0,
            weight,
            normal: Vec3::zeros(),
            position: Vec3::zeros(),
        };
        let mut tangents = [Vec3::zeros(); 2];
        for a in 0..16 {
            out.nodes[a] = room.indices[a] + self.first_node;
            out.n[a] = room.n[a];
            let x = positions[room.indices[a] as usize];
            out.position += x * room.n[a];
            for (k, tangent) in tangents.iter_mut().enumerate() {
                out.n_i[k][a] = room.n_i[a][k];
                *tangent += x * room.n_i[a][k];
            }
        }
        let normal = tangents[0].cross(&tangents[1]);
        out.area = weight * normal.norm();
        out.normal = normal.normalize();
        out
    }
}

impl NurbsSheet {
    /// Elements of all patches.
    pub fn elements(&self) -> usize {
        self.patches.iter().map(SheetPatch::elements).sum()
    }

    /// Control points of all patches.
    pub fn nodes(&self) -> usize {
        self.patches.iter().map(SheetPatch::nodes).sum()
    }

    /// Positions of all control points.
    pub fn positions(&self) -> Vec<Vec3> {
        let all = self.patches.iter();
        all.flat_map(|p| p.patch.points()).collect()
    }

    /// The patch that element `e` belongs to, and its span there.
    pub fn place(&self, e: usize) -> (&SheetPatch, [usize; 2]) {
        let after = (self.patches).partition_point(|p| p.first_element as usize <= e);
        let patch = &self.patches[after.max(1) - 1];
        let own = e - patch.first_element as usize;
        let nu = patch.spans()[0];
        (patch, [own % nu, own / nu])
    }

    /// Ranges of parameters of element `e`.
    pub fn range(&self, e: usize) -> [[f64; 2]; 2] {
        let (patch, at) = self.place(e);
        [0, 1].map(|dir| patch.patch.spans(dir)[at[dir]])
    }

    /// Name of a set of a patch: `edge.1` of the only one, `12.edge.1` of face 12 of several.
    fn name(&self, patch: usize, set: &str) -> String {
        match self.patches.len() {
            1 => set.to_owned(),
            _ => format!("{}.{set}", self.patches[patch].face),
        }
    }

    /// The seam with the largest angle between the normals of its two sides, and that angle (degrees); none without seams. All seams
    /// are looked at, or those along curves of trims.
    pub fn sharpest_fold(&self, trims: bool) -> Option<(&Seam, f64)> {
        let normal = |edge: Border, s: f64| {
            let part = &self.patches[edge.patch()];
            let jet = part.patch.jet(part.line(edge).xi(s));
            jet.rho_i[0].cross(&jet.rho_i[1])
        };
        let angle = |seam: &Seam| {
            let [a, b] = seam.edges;
            let [own, other] = [a, b].map(|border| self.curve(border));
            let [low, high] = seam.ranges[0];
            (0..=8)
                .map(|k| {
                    let s = low + (high - low) * f64::from(k) / 8.0;
                    let (foot, _) = other.foot(&own.point(s));
                    let (n, m) = (normal(a, s), normal(b, foot));
                    n.cross(&m).norm().atan2(n.dot(&m)).to_degrees()
                })
                .fold(0.0, f64::max)
        };
        let of_trim = |seam: &&Seam| seam.edges.iter().any(|e| matches!(e, Border::Trim(_)));
        let seams = self.joints.seams.iter();
        let all = seams.filter(|seam| !trims || of_trim(seam));
        let all = all.map(|seam| (seam, angle(seam)));
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// A border as a curve, from its first end to its last.
    pub(crate) fn curve(&self, border: Border) -> seams::Curve<'_> {
        let part = &self.patches[border.patch()];
        let line = part.line(border);
        let whole = line.whole();
        seams::Curve::new(&part.patch, border, line, whole)
    }

    /// Number of connected parts.
    pub fn parts(&self) -> usize {
        let mut part: Vec<usize> = (0..self.patches.len()).collect();
        for seam in &self.joints.seams {
            let [a, b] = seam.edges.map(|e| part[e.patch()]);
            part.iter_mut()
                .filter(|p| **p == a.max(b))
                .for_each(|p| *p = a.min(b));
        }
        part.iter().enumerate().filter(|(k, p)| k == *p).count()
    }

    /// `n x n` Gauss points of some elements, element after element, xi1 fastest (see [`Self::sampled`]).
    ///
    /// # Errors
    /// A number of points that no rule has.
    pub fn points(
        &self,
        elements: impl Iterator<Item = usize>,
        n: usize,
    ) -> Result<Vec<SheetPoint>, crate::fem::quadrature::QuadratureError> {
        let rule = crate::fem::gauss(n)?;
        Ok(self.sampled(elements, &rule))
    }

    /// As [`Self::points`] with any rule. Elements that a trim cuts have the points of what is left of them.
    pub fn sampled(
        &self,
        elements: impl Iterator<Item = usize>,
        rule: &crate::fem::Rule,
    ) -> Vec<SheetPoint> {
        let mut room = PatchShape::default();
        let mut out = Vec::new();
        let mut known: Option<(&SheetPatch, Vec<Vec3>)> = None;
        for e in elements {
            let (patch, span) = self.place(e);
            let positions = match known {
                Some((of, positions)) if std::ptr::eq(of, patch) => positions,
                _ => patch.patch.points(),
            };
            match self.kept(e) {
                trims::Kept::Whole => {}
                trims::Kept::Nothing => {
                    known = Some((patch, positions));
                    continue;
                }
                trims::Kept::Part(points) => {
                    let of = points.iter();
                    out.extend(
                        of.map(|p| patch.point(span, p.xi, p.weight, &positions, &mut room)),
                    );
                    known = Some((patch, positions));
                    continue;
                }
            }
            let [u, v] = [0, 1].map(|dir| patch.patch.basis(dir).span_range(span[dir]));
            for (t, wt) in rule.iter() {
                for (s, ws) in rule.iter() {
                    let xi = [
                        0.5 * (u[0] + u[1]) + 0.5 * s * (u[1] - u[0]),
                        0.5 * (v[0] + v[1]) + 0.5 * t * (v[1] - v[0]),
                    ];
                    let weight = 0.25 * ws * wt * (u[1] - u[0]) * (v[1] - v[0]);
                    out.push(patch.point(span, xi, weight, &positions, &mut room));
                }
            }
            known = Some((patch, positions));
        }
        out
    }

    /// Integral of every control point's shape function over the mid-surface.
    pub fn tributary_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.nodes()];
        let elements = self.elements();
        let rule = crate::fem::gauss(DEGREE + 1).expect("a rule of four points exists");
        for p in self.sampled(0..elements, &rule) {
            for (node, n) in p.nodes.iter().zip(p.n) {
                areas[*node as usize] += n * p.area;
            }
        }
        areas
    }

    /// Control points and knot spans as a mesh, with the sets `top`, `bottom`, `edge.1` to `edge.4` and `corner.1` to
    /// `corner.4`. Of several patches the sets of each begin with the number of its face, those of edges that are joined all
    /// along are left out, and `rim` holds the others.
    pub fn mesh(&mut self) -> Mesh {
        let mut room = PatchShape::default();
        let count = self.elements();
        let mut connectivity = Vec::with_capacity(16 * count);
        let (mut node_sets, mut face_sets) = (BTreeMap::new(), BTreeMap::new());
        let nodes = self.positions();
        let left: Vec<bool> = (0..count).map(|e| *self.kept(e) != Kept::Nothing).collect();
        let faces = |first: u32, count: usize, face: u8| -> Vec<Face> {
            (first..first + count as u32)
                .filter(|element| left[*element as usize])
                .map(|element| Face { element, face })
                .collect()
        };
        let several = self.patches.len() > 1;
        for (k, part) in self.patches.iter().enumerate() {
            let spans = part.spans();
            for j in 0..spans[1] {
                for i in 0..spans[0] {
                    let [u, v] = [0, 1].map(|dir| part.patch.basis(dir).span_range([i, j][dir]));
                    let middle = [0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])];
                    part.patch.shape_in_span([i, j], middle, &mut room);
                    connectivity.extend(room.indices.iter().map(|n| n + part.first_node));
                }
            }
            let corners = part.corners().into_iter().enumerate();
            for (c, corner) in corners.filter(|(c, _)| part.keeps_corner(*c)) {
                let number = 1 + if part.reversed { c ^ 1 } else { c };
                let name = self.name(k, &format!("corner.{number}"));
                node_sets.insert(name, vec![corner]);
            }
            if several {
                let own = part.first_node..part.first_node + part.nodes() as u32;
                for (name, face) in [("bottom", 4), ("top", 5)] {
                    let name = self.name(k, name);
                    node_sets.insert(name.clone(), own.clone().collect());
                    face_sets.insert(name, faces(part.first_element, part.elements(), face));
                }
            }
        }
        self.edge_sets = self.named_borders();
        for (name, borders) in &self.edge_sets {
            node_sets.insert(name.clone(), self.border_nodes(borders));
        }
        for (name, face) in [("bottom", 4), ("top", 5)] {
            node_sets.insert(name.to_owned(), (0..nodes.len() as u32).collect());
            face_sets.insert(name.to_owned(), faces(0, count, face));
        }
        Mesh {
            kind: ElementKind::Nurbs,
            nodes,
            connectivity,
            node_sets,
            face_sets,
        }
    }

    /// Smallest and largest coordinates of the control points.
    pub fn bounds(&self) -> [Vec3; 2] {
        let all = self.patches.iter().map(|p| p.patch.bounds());
        all.reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])])
            .unwrap_or_default()
    }

    /// Longest length of every span along both directions, of all patches.
    fn lengths(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|dir| {
            let all = self.patches.iter();
            all.flat_map(|p| refine::lengths(&p.patch, dir)).collect()
        })
    }

    /// Shortest and longest side of the elements.
    pub fn span_lengths(&self) -> [f64; 2] {
        let both = self.lengths();
        let all = || both.iter().flatten().copied();
        [
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
        ]
    }

    /// Mean length of the spans' sides.
    pub fn span_length(&self) -> f64 {
        let mean = |all: &Vec<f64>| all.iter().sum::<f64>() / all.len() as f64;
        let [u, v] = self.lengths();
        0.5 * (mean(&u) + mean(&v))
    }
}

fn sorted(mut nodes: Vec<u32>) -> Vec<u32> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
