//! Edges of the patches of a sheet.
use super::{Border, Edge, NurbsSheet, SheetPatch};

impl NurbsSheet {
    /// Spans of a patch with the sides (as [`Edge::side`] counts them) along which they are joined, by the middle of the side.
    pub fn joined_sides(&self, patch: usize) -> Vec<(usize, usize)> {
        let part = &self.patches[patch];
        let counts = part.spans();
        let mut out = Vec::new();
        for edge in Edge::of(patch) {
            let (across, along) = (edge.direction(), 1 - edge.direction());
            let ranges: Vec<[f64; 2]> = (self.joints.seams.iter())
                .flat_map(|seam| [0, 1].map(|k| (seam.edges[k], seam.ranges[k])))
                .filter(|(of, _)| *of == Border::Edge(edge))
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
}
