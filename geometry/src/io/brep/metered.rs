//! A surface that charges what searches for closest points do on it to the grant of a file.

use super::grant::{CELL, Grant, PART, PIECE};
use crate::bezier::BezierPiece;
use crate::project::cells::parts;
use crate::surface::{Jet, Surface};
use crate::trim::Trim;
use crate::{NurbsPatch, Vec3};

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
}

/// Bytes that a set of one patch with so many border points takes, with the Bezier pieces that projections of as many points and
/// some inside make.
pub fn bytes_of_set(patch: &NurbsPatch, border: usize) -> u64 {
    let pieces = Surface::bezier_pieces(patch);
    let points: u64 = pieces.iter().map(|p| p.points.len() as u64).sum();
    let [border, cells] = [border as u64, cells(&pieces)];
    border * BORDER_POINT + cells * CELL_BYTES + points * 32 + cells.min(border + 25) * PIECE_BYTES
}

/// Bytes of the samples of an edge for each border point, while the vector of them grows; of a cell's box with its place in the
/// tree; and of a piece with its proofs.
const BORDER_POINT: u64 = 600;
const CELL_BYTES: u64 = 180;
const PIECE_BYTES: u64 = 2_000;

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
}
