//! Edges of the patches of a sheet.
use super::{DEGREE, Edge, NurbsSheet, SheetPatch, SheetPoint};
use covact_geometry::{PatchShape, Vec3};
use std::collections::BTreeMap;

impl NurbsSheet {
    /// Edges that are not joined to another one, all along or in part, and of which a trim leaves something.
    pub fn free_edges(&self) -> Vec<Edge> {
        let all = (0..self.patches.len()).flat_map(Edge::of);
        all.filter(|edge| !self.joints.inner.contains(edge))
            .filter(|edge| self.patches[edge.patch()].keeps(*edge))
            .collect()
    }

    /// Spans of a patch with the sides (as [`Edge::side`] counts them) along which they are joined, by the middle of the side.
    pub fn joined_sides(&self, patch: usize) -> Vec<(usize, usize)> {
        let part = &self.patches[patch];
        let counts = part.spans();
        let mut out = Vec::new();
        for edge in Edge::of(patch) {
            let (across, along) = (edge.direction(), 1 - edge.direction());
            let ranges: Vec<[f64; 2]> = (self.joints.seams.iter())
                .flat_map(|seam| [0, 1].map(|k| (seam.edges[k], seam.ranges[k])))
                .filter(|(of, _)| *of == edge)
                .map(|(_, range)| range)
                .collect();
            for (k, [a, b]) in part.patch.spans(along).into_iter().enumerate() {
                let middle = 0.5 * (a + b);
                if ranges.iter().any(|[a, b]| (*a..=*b).contains(&middle)) {
                    let mut at = [if edge.at_end() { counts[across] - 1 } else { 0 }; 2];
                    at[along] = k;
                    out.push((at[0] + counts[0] * at[1], edge.side()));
                }
            }
        }
        out
    }

    /// The set of an edge.
    pub fn edge_name(&self, edge: Edge) -> String {
        let number = self.patches[edge.patch()].side_in_file(edge);
        self.name(edge.patch(), &format!("edge.{number}"))
    }

    /// Control points along an edge, `row` rows away from it.
    pub fn row(&self, edge: Edge, row: usize) -> Vec<u32> {
        let SheetPatch {
            patch, first_node, ..
        } = &self.patches[edge.patch()];
        let counts = patch.counts();
        let across = edge.direction();
        let at = match edge.at_end() {
            false => row,
            true => counts[across] - 1 - row,
        };
        (0..counts[1 - across])
            .map(|k| match across {
                0 => (at + counts[0] * k) as u32,
                _ => (k + counts[0] * at) as u32,
            })
            .map(|n| n + first_node)
            .collect()
    }

    /// Gauss points along an edge, element after element, with the undeformed length that each stands for.
    pub fn edge_points(&self, edge: Edge) -> Vec<Vec<(SheetPoint, f64)>> {
        let across = edge.direction();
        let patch = &self.patches[edge.patch()];
        let spans = [0, 1].map(|dir| patch.patch.spans(dir));
        let last = spans[across].len() - 1;
        let (end, at) = match edge.at_end() {
            false => (0, spans[across][0][0]),
            true => (last, spans[across][last][1]),
        };
        let rule = crate::fem::gauss(DEGREE + 1).expect("a rule of four points exists");
        let positions = patch.patch.points();
        let mut room = PatchShape::default();
        let mut of = |k: usize, [a, b]: [f64; 2]| {
            let mut span = [end; 2];
            span[1 - across] = k;
            let points = rule.iter().map(|(s, w)| {
                let mut xi = [at; 2];
                xi[1 - across] = 0.5 * (a + b) + 0.5 * s * (b - a);
                let p = patch.point(span, xi, 0.5 * w * (b - a), &positions, &mut room);
                let tangent: Vec3 = (p.nodes.iter().zip(p.n_i[1 - across]))
                    .map(|(n, d)| positions[(*n - patch.first_node) as usize] * d)
                    .sum();
                (p, p.weight * tangent.norm())
            });
            points.collect()
        };
        let along = spans[1 - across].iter().enumerate();
        along.map(|(k, range)| of(k, *range)).collect()
    }

    /// Integral of every control point's shape function along an edge (length).
    pub fn edge_lengths(&self, edge: Edge) -> Vec<(u32, f64)> {
        let mut lengths: BTreeMap<u32, f64> = BTreeMap::new();
        for (p, length) in self.edge_points(edge).iter().flatten() {
            for (node, n) in p.nodes.iter().zip(p.n).filter(|(_, n)| *n != 0.0) {
                *lengths.entry(*node).or_default() += n * length;
            }
        }
        lengths.into_iter().collect()
    }
}
