//! Curves of a trim from end to end: which parts lie on the sides of the domain, and where they cross lines of constant parameter.

use super::Trim;
use super::monotone::{Monotone, Point};

/// Distance from a side of the domain, as a share of its extent, that counts as on it.
const ON_SIDE: f64 = 1e-7;
/// Sine of the angle between tangents at which a curve has a corner.
const CORNER: f64 = 1e-6;
/// Cuts nearer to each other than this share of the curve are one.
const SAME: f64 = 1e-10;

/// A part of a curve without corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePart {
    /// Its parameters.
    pub range: [f64; 2],
    /// The side of the domain on which it lies (0 and 1: start and end of xi1; 2 and 3: those of xi2).
    pub side: Option<usize>,
}

impl Trim {
    /// Curve `k` (counted over all loops) in parts that have no corners, each on one side of the domain or on none.
    pub fn parts(&self, k: usize, domain: [[f64; 2]; 2]) -> Vec<CurvePart> {
        let side = |piece: &Monotone| -> Option<usize> {
            (0..4).find(|side| {
                let (d, [a, b]) = (side / 2, domain[side / 2]);
                let at = [a, b][side % 2];
                let near = |p: Point| (p[d] - at).abs() <= ON_SIDE * (b - a);
                near(piece.from) && near(piece.to)
            })
        };
        let mut out: Vec<CurvePart> = Vec::new();
        let mut before: Option<&Monotone> = None;
        for piece in self.pieces_of(k) {
            let side = side(piece);
            match (out.last_mut(), before) {
                (Some(last), Some(before)) if last.side == side && !corner(before, piece) => {
                    last.range[1] = piece.t[1];
                }
                _ => out.push(CurvePart {
                    range: piece.t,
                    side,
                }),
            }
            before = Some(piece);
        }
        out
    }

    /// A part of curve `k` cut where one of its coordinates takes one of the values `lines[direction]`: ascending ranges of its
    /// parameter.
    pub fn cut_at(&self, k: usize, range: [f64; 2], lines: [&[f64]; 2]) -> Vec<[f64; 2]> {
        let [start, end] = range;
        let mut cuts = vec![start];
        for piece in self.pieces_of(k) {
            let [low, high] = piece.bounds();
            for (d, lines) in lines.iter().enumerate() {
                let within = lines.iter().filter(|x| low[d] <= **x && **x <= high[d]);
                cuts.extend(within.map(|x| piece.parameter(piece.solve(d, *x))));
            }
        }
        let tiny = SAME * (end - start);
        cuts.retain(|t| *t == start || (*t > start + tiny && *t < end - tiny));
        cuts.push(end);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a <= tiny);
        cuts.windows(2).map(|w| [w[0], w[1]]).collect()
    }

    /// Pieces of a curve, in its direction, but for straight lines across gaps.
    fn pieces_of(&self, k: usize) -> impl Iterator<Item = &Monotone> {
        (self.pieces().iter()).filter(move |p| p.curve as usize == k && p.t[1] > p.t[0])
    }
}

fn corner(before: &Monotone, after: &Monotone) -> bool {
    let unit = |[x, y]: Point| {
        let size = x.hypot(y);
        [x / size, y / size]
    };
    let (a, b) = (unit(before.tangent(1.0).1), unit(after.tangent(0.0).1));
    let (sin, cos) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    // A tangent of no length (a cusp, doubled control points) is none either.
    !(sin.abs() <= CORNER && cos > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::NurbsCurve;
    use crate::curve::conic::elliptic_arc;
    use crate::trim::{TrimCurve, TrimLoop};
    use nalgebra::Vector2;
    use std::f64::consts::TAU;

    fn curve(parameter: NurbsCurve<2>) -> TrimCurve {
        TrimCurve {
            parameter,
            space: None,
            entity: 0,
        }
    }

    /// A polyline round the domain whose last corner is cut off: four parts on sides, one on none. A circle has no corners, and
    /// crosses a line twice.
    #[test]
    fn parts_and_crossings() {
        let points = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [0.5, 1.0],
            [0.0, 0.4],
            [0.0, 0.0],
        ];
        let points = points.map(Vector2::from);
        let knots = vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0];
        let outer = NurbsCurve::new(1, knots, &points, None).unwrap();
        let hole = elliptic_arc(
            Vector2::new(1.0, 0.5),
            Vector2::x() * 0.2,
            Vector2::y() * 0.2,
            0.0,
            TAU,
        );
        let loops = [outer, hole.unwrap()].map(|c| TrimLoop {
            curves: vec![curve(c)],
        });
        let domain = [[0.0, 2.0], [0.0, 1.0]];
        let trim = Trim::new(loops.into(), domain, 1e-9).unwrap();
        let sides: Vec<_> = trim.parts(0, domain).iter().map(|p| p.side).collect();
        assert_eq!(sides, [Some(2), Some(1), Some(3), None, Some(0)]);
        let whole = trim.parts(1, domain);
        assert_eq!(whole.len(), 1, "{whole:?}");
        let cut = trim.cut_at(1, whole[0].range, [&[1.1, 1.9], &[]]);
        assert_eq!(cut.len(), 3, "{cut:?}");
        let circle = &trim.curve(1).unwrap().parameter;
        for at in [cut[0][1], cut[1][1]] {
            assert!((circle.point(at).x - 1.1).abs() < 1e-14);
        }
        // A line through both ends of the curve, or one that touches it, cuts off nothing.
        assert_eq!(trim.cut_at(1, whole[0].range, [&[], &[0.5]]).len(), 2);
        assert_eq!(trim.cut_at(0, [3.0, 4.0], [&[0.25], &[]]).len(), 2);
    }
}
