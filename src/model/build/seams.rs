//! What is told of patches that nearly meet, or run over each other.
use super::super::SurfaceModel;
use super::super::error::number;
use super::Builder;
use covact_geometry::Vec3;
use covact_geometry::project::{Gap, Overlap};

impl Builder<'_> {
    /// Warns of gaps between patches that are too wide for their edges to be joined, and notes where patches run over each
    /// other.
    pub(super) fn seams(&mut self, name: &str, model: &SurfaceModel, labels: &[String]) {
        if model.facets.is_some() {
            return;
        }
        let edges = model.set.edges();
        let label = |patch: u32| labels.get(patch as usize).map_or("?", String::as_str);
        let place = |x: &Vec3| match model.motion.pose(0.0) {
            Ok(pose) => pose.transform_point(&(*x).into()).coords,
            Err(_) => *x,
        };
        let at = |x: &Vec3| {
            let [x, y, z] = [0, 1, 2].map(|k| number(place(x)[k]));
            format!("({x}, {y}, {z})")
        };
        let widest = |a: &&Gap, b: &&Gap| a.gap.total_cmp(&b.gap);
        if let Some(gap) = edges.open_gaps.iter().max_by(widest) {
            let [one, other] = gap.edges.map(|e| label(e.0));
            self.warnings.push(format!(
                "surface `{name}`: {} gap(s) between edges too far apart to be joined, the widest {} at {} between {one} and \
                 {other}: slave points over it touch nothing where they are farther from its sides than a quarter of their spacing; close it \
                 in the file, or set `cad.tolerance` above it (now {})",
                edges.open_gaps.len(),
                number(gap.gap),
                at(&gap.at),
                number(edges.tolerance)
            ));
        }
        let label_pair = |gap: &Gap| gap.edges.map(|e| format!("{} {}", label(e.0), edge(e.1)));
        if let Some(gap) = edges.bridged.iter().max_by(widest) {
            let [one, other] = label_pair(gap);
            self.notes.push(format!(
                "surface `{name}`: {} pair(s) of edges were joined over gaps wider than {}, the widest {} at {} between \
                 {one} and {other}",
                edges.bridged.len(),
                number(edges.resolution),
                number(gap.gap),
                at(&gap.at),
            ));
        }
        let nearest = |a: &&Gap, b: &&Gap| a.gap.total_cmp(&b.gap);
        if let Some(gap) = edges.stacked.iter().min_by(nearest) {
            let [one, other] = label_pair(gap);
            self.notes.push(format!(
                "surface `{name}`: {} pair(s) of edges lie near each other but were not joined, as both patches leave them \
                 in the same direction, like sheets on top of each other; the nearest {} apart at {}: {one} and {other}",
                edges.stacked.len(),
                number(gap.gap),
                at(&gap.at),
            ));
        }
        let deepest = |a: &&Overlap, b: &&Overlap| a.depth.total_cmp(&b.depth);
        if let Some(overlap) = edges.overlaps.iter().max_by(deepest) {
            let [one, other] = [overlap.edge.0, overlap.patch].map(label);
            self.notes.push(format!(
                "surface `{name}`: {} free edge(s) run into another patch, farthest that of {one} into {other}, by {} at {}: \
                 they are not joined, and slave points there meet the nearer one",
                edges.overlaps.len(),
                number(overlap.depth),
                at(&overlap.at)
            ));
        }
    }
}

/// An edge of a patch in words.
fn edge(number: u32) -> String {
    match number {
        n @ 0..4 => format!("side {n}"),
        n => format!("trim curve {}", n - 4),
    }
}
