//! A surface that charges what searches for closest points do on it to the grant of a file.

use super::grant::{CELL, Grant, PART, PIECE};
use crate::bezier::BezierPiece;
use crate::project::cells::parts;
use crate::project::{Joining, PatchSet, PatchSetError};
use crate::surface::{Jet, Surface};
use crate::trim::Trim;
use crate::{NurbsPatch, Vec3};

/// Border points in each span of a side; of a trim curve as many for each degree.
pub const STEPS: usize = 4;
/// Cost, in evaluations, of each border point of a patch when a set is made of it.
const BORDER: u64 = 4;

/// A patch, with its trim or without. Its evaluations and pieces are charged to a grant; searches end when no work is left.
#[derive(Debug, Clone)]
pub struct Metered<'a> {
    patch: &'a NurbsPatch,
    trim: Option<&'a Trim>,
    grant: &'a Grant,
    /// Cost of an evaluation.
    cost: u64,
}

impl<'a> Metered<'a> {
    pub fn untrimmed(patch: &'a NurbsPatch, grant: &'a Grant) -> Self {
        Self {
            patch,
            trim: None,
            grant,
            cost: Grant::evaluation(patch.degree()),
        }
    }

    pub fn trimmed(patch: &'a NurbsPatch, grant: &'a Grant) -> Self {
        Self {
            trim: patch.trim(),
            ..Self::untrimmed(patch, grant)
        }
    }

    /// The patch itself.
    pub fn patch(&self) -> &'a NurbsPatch {
        self.patch
    }

    /// Number of border points.
    fn border(&self) -> u64 {
        let points = match self.trim {
            Some(trim) => {
                let curves = trim.loops().iter().flat_map(|l| &l.curves);
                let bases = curves.map(|c| c.parameter.basis());
                bases.map(|b| b.span_count() * b.degree()).sum::<usize>()
            }
            None => {
                2 * [0, 1]
                    .map(|dir| self.patch.spans(dir).len())
                    .iter()
                    .sum::<usize>()
            }
        };
        (STEPS * points) as u64
    }

    /// Bytes that a set of the patch takes, before anything is projected onto it. Finding out is charged to the grant.
    pub fn bytes(&self) -> u64 {
        self.bytes_and_cells()[0]
    }

    /// The same with the Bezier pieces that projections of as many points as the border has, and of some inside, make.
    pub fn bytes_for_projections(&self) -> u64 {
        let [bytes, cells] = self.bytes_and_cells();
        bytes + cells.min(self.border() + 25) * PIECE_BYTES
    }

    fn bytes_and_cells(&self) -> [u64; 2] {
        let pieces = self.bezier_pieces();
        let points: u64 = pieces.iter().map(|p| p.points.len() as u64).sum();
        let cells = cells(&pieces);
        let bytes = self.border() * BORDER_POINT + cells * CELL_BYTES + points * 32;
        [bytes, cells]
    }

    /// Work of integrating over the patch: 16 evaluations for every cell, and for every part of the border.
    pub fn work_of_area(&self) -> u64 {
        16 * self.cost * (cells(&self.bezier_pieces()) + self.border())
    }

    /// Number of edges.
    fn edges(&self) -> u64 {
        self.trim.map_or(4, |trim| trim.curve_count() as u64)
    }
}

/// Why a set was not made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoSet {
    /// No work is left of the grant.
    #[error("that takes more work than a file of this length is granted")]
    Work,
    /// It is larger than what may be in use for a while.
    #[error("that takes more memory than a file of this length is granted")]
    Memory,
    /// The patches make no set.
    #[error(transparent)]
    Patches(#[from] PatchSetError),
}

/// A set of patches, as far as the grant allows with so many bytes in use for other sets.
pub fn set_of<'a>(
    patches: Vec<Metered<'a>>,
    joining: Joining,
    (grant, in_use): (&Grant, u64),
) -> Result<PatchSet<Metered<'a>>, NoSet> {
    let own: u64 = patches.iter().map(Metered::bytes).sum();
    let wanted = own.saturating_add(bytes_of_pairs(&patches));
    let room = grant.passing_bytes();
    let left = room.checked_sub(wanted.saturating_add(in_use));
    // At least one point more: none left means that there was no room for one.
    grant.allow_more(left.ok_or(NoSet::Memory)?.saturating_add(1));
    let work: u64 = patches.iter().map(|p| p.border() * BORDER * p.cost).sum();
    if !grant.spend(work) {
        return Err(NoSet::Work);
    }
    let set = PatchSet::join(patches, joining)?;
    // Polylines without the points that they need are no basis to compare edges.
    if !grant.take_more(0) {
        return Err(NoSet::Memory);
    }
    // Edges that were not compared for want of work are not joined.
    match grant.is_spent() {
        true => Err(NoSet::Work),
        false => Ok(set),
    }
}

/// Bytes of the polylines of a set's edges.
pub fn bytes_of_edges(set: &PatchSet<Metered>) -> u64 {
    let points = set.topology.edges.iter().map(|e| e.samples.len() as u64);
    points.sum::<u64>() * KEPT_POINT
}

/// Bytes of the pairs of edges that are compared.
fn bytes_of_pairs(patches: &[Metered]) -> u64 {
    let boxes: Vec<[Vec3; 2]> = patches.iter().map(|p| p.patch.bounds()).collect();
    let meet = |a: usize, b: usize| {
        let ([low, high], other) = (boxes[a], boxes[b]);
        (0..3).all(|k| low[k] <= other[1][k] && other[0][k] <= high[k])
    };
    let edges: Vec<u64> = patches.iter().map(Metered::edges).collect();
    let pairs = (0..patches.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    let meeting = pairs.filter(|&(a, b)| meet(a, b));
    meeting
        .map(|(a, b)| (edges[a] + edges[b]) * PAIR_BYTES)
        .sum()
}

impl Surface for Metered<'_> {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.patch.domain()
    }

    fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        self.patch.spans(dir)
    }

    fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        self.patch.find_span(xi)
    }

    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        self.grant.spend(self.cost);
        self.patch.jet_in_span(span, xi)
    }

    fn jet(&self, xi: [f64; 2]) -> Jet {
        self.grant.spend(self.cost);
        self.patch.jet(xi)
    }

    fn point(&self, xi: [f64; 2]) -> Vec3 {
        self.grant.spend(self.cost);
        self.patch.point(xi)
    }

    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        let pieces = Surface::bezier_pieces(self.patch);
        self.grant.spend(CELL * self.cost * cells(&pieces));
        pieces
    }

    fn bezier_piece(&self, span: [usize; 2]) -> BezierPiece {
        self.grant.spend(PIECE * self.cost);
        Surface::bezier_piece(self.patch, span)
    }

    fn crease_knots(&self, dir: usize) -> Vec<f64> {
        self.patch.crease_knots(dir)
    }

    fn sharp_knots(&self, dir: usize, angle: f64) -> Vec<f64> {
        self.patch.sharp_knots(dir, angle)
    }

    fn trim(&self) -> Option<&Trim> {
        self.trim
    }

    fn may_go_on(&self) -> bool {
        self.grant.spend(PART * self.cost)
    }

    fn may_sample(&self) -> bool {
        self.grant.take_more(TURN_POINT)
    }
}

/// Bytes of the samples of an edge for each border point, while the vector of them grows; of a cell's box with its place in the
/// tree; and of a piece with its proofs.
const BORDER_POINT: u64 = 600;
const CELL_BYTES: u64 = 180;
const PIECE_BYTES: u64 = 2_000;
/// Bytes of a point of a polyline where an edge turns: while the polyline is made, and afterwards.
const TURN_POINT: u64 = 200;
const KEPT_POINT: u64 = 52;
/// Bytes of a pair of edges, where patches whose boxes meet have as many pairs as edges.
const PAIR_BYTES: u64 = 300;

/// Number of cells into which a set cuts the pieces of a patch.
fn cells(pieces: &[BezierPiece]) -> u64 {
    let mut most: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
    for piece in pieces {
        for ((most, &span), parts) in most.iter_mut().zip(&piece.span).zip(parts(piece)) {
            most.resize(most.len().max(span + 1), 1);
            most[span] = most[span].max(parts);
        }
    }
    let [m, n] = most.map(|parts| parts.iter().sum::<usize>() as u64);
    m.saturating_mul(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PatchSet, Status};

    /// A bicubic patch that waves, above the square from -1 to 1.
    fn waves() -> NurbsPatch {
        let n = 8;
        let points = (0..n * n).map(|k| {
            let [x, y] = [k % n, k / n].map(|i| 2.0 * i as f64 / (n - 1) as f64 - 1.0);
            Vec3::new(x, y, 0.3 * (9.0 * x).sin() * (7.0 * y).cos())
        });
        let points: Vec<Vec3> = points.collect();
        let knots: Vec<f64> = (0..n + 4).map(|i| i.clamp(3, n) as f64).collect();
        NurbsPatch::new([3, 3], [knots.clone(), knots], [n, n], &points, None).unwrap()
    }

    /// Closest points equal those of the patch itself while work is left. Without work, a search ends after one local iteration
    /// and reports that nothing is proved.
    #[test]
    fn searches_are_paid_for_and_end() {
        let patch = waves();
        let plain = PatchSet::new(vec![patch.clone()], None).unwrap();
        let queries: Vec<Vec3> = (0..20)
            .map(|k| Vec3::new(0.09 * f64::from(k) - 0.8, 0.3, 0.7))
            .collect();
        let grant = Grant::of_lines(1000, 1000);
        let set = PatchSet::new(vec![Metered::untrimmed(&patch, &grant)], None).unwrap();
        for q in &queries {
            let before = grant.left();
            let (foot, own) = (set.project(q, None, 9.0), plain.project(q, None, 9.0));
            assert_eq!(foot, own);
            assert!(before - grant.left() > 2 * Grant::evaluation([3, 3]));
        }
        assert!(!grant.spend(u64::MAX));
        let mut unproved = 0;
        for q in &queries {
            let foot = set.project(q, None, 9.0);
            unproved += usize::from(foot.is_none_or(|f| f.status == Status::NotConverged));
        }
        assert_eq!(unproved, queries.len());
        assert!(grant.is_spent());
    }

    /// Two patches with a common side are joined as those that charge nothing, or refused, however much work is left.
    #[test]
    fn joined_as_without_a_grant_or_refused() {
        let one = waves();
        let other = one.clone().reversed(0).unwrap();
        let moved = other.homogeneous().iter().map(|p| {
            let [x, y, z, w] = *p;
            [2.0 - x, y, z, w]
        });
        let bases = [other.basis(0).clone(), other.basis(1).clone()];
        let other = NurbsPatch::from_homogeneous(bases, moved.collect()).unwrap();
        let plain = PatchSet::new(vec![one.clone(), other.clone()], None).unwrap();
        assert_eq!(plain.edges().joints.len(), 1);
        let (mut joined, mut refused) = (0, 0);
        for left in [
            1, 10_000, 30_000, 50_000, 100_000, 200_000, 400_000, 4_000_000,
        ] {
            let grant = Grant::of_lines(0, 1000);
            grant.spend(grant.left() - left);
            let patches = [&one, &other].map(|p| Metered::untrimmed(p, &grant));
            match set_of(patches.to_vec(), Joining::default(), (&grant, 0)) {
                Ok(set) => {
                    assert_eq!(set.edges(), plain.edges());
                    joined += 1;
                }
                Err(reason) => {
                    assert_eq!(reason, NoSet::Work);
                    assert!(grant.is_spent());
                    refused += 1;
                }
            }
        }
        assert!(joined > 1 && refused > 2, "{joined} {refused}");
        // Not the work, but the memory of a hundred of them is more than a file without a line may take.
        let grant = Grant::of_lines(0, 0);
        let patches = vec![Metered::untrimmed(&one, &grant); 100];
        let refused = set_of(patches, Joining::default(), (&grant, 0));
        assert_eq!(refused.err(), Some(NoSet::Memory));
    }
}
