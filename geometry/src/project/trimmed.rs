//! What a search needs to know of trims: which cells lie inside, outside or across the border, and the trim curves in
//! space as exact Bezier pieces.
//!
//! A piece of a trim curve within one Bezier piece of the surface is a rational Bezier curve in space: the surface's control
//! net is run through de Casteljau's algorithm with the polynomials of the parameter curve in place of numbers.

use super::piece::hull;
use super::set::Grid;
use crate::bezier::BezierPiece;
use crate::surface::{Surface, Vec3};
use crate::trim::{Monotone, Part, Trim, binomials};

/// Control polygons of curve leaves turn by about this much at most (radians).
const TURN: f64 = 0.5;
/// Most leaves of one monotone piece within one span of the surface.
const MOST: usize = 16;

/// A piece of a trim curve in space.
#[derive(Debug, Clone)]
pub(super) struct CurveLeaf {
    pub patch: u32,
    /// Number of the curve over all loops of the patch.
    pub curve: u32,
    /// Parameters of the curve.
    pub t: [f64; 2],
    /// Span of the surface on the side that belongs to it.
    pub span: [usize; 2],
    /// Start and length of its control points in [`Trimmed::nets`].
    net: [usize; 2],
}

/// Cells and trim curves of a set; empty where no patch is trimmed.
#[derive(Debug, Clone, Default)]
pub(super) struct Trimmed {
    /// How every piece lies.
    parts: Vec<Part>,
    /// Sorted by patch, curve and parameter.
    pub leaves: Vec<CurveLeaf>,
    nets: Vec<[f64; 4]>,
}

impl Trimmed {
    /// Takes note of the pieces of a patch, the last one so far.
    pub fn push_patch<S: Surface>(
        &mut self,
        patch: &S,
        number: u32,
        grid: &Grid,
        beziers: &[BezierPiece],
    ) {
        let first = grid.first as usize;
        let Some(trim) = patch.trim() else {
            if !self.parts.is_empty() {
                self.parts.resize(first + grid.count(), Part::Inside);
            }
            return;
        };
        self.parts.resize(first, Part::Inside);
        let parts = grid.places(number).map(|p| trim.part(p.domain));
        self.parts.extend(parts);
        let start = self.leaves.len();
        for piece in trim.pieces() {
            if piece.t[0] < piece.t[1] {
                self.push_curve(patch, trim, number, piece, grid, beziers);
            }
        }
        self.leaves[start..]
            .sort_by(|a, b| (a.curve.cmp(&b.curve)).then(a.t[0].total_cmp(&b.t[0])));
    }

    /// Adds the leaves of a monotone piece: cut at the knot lines of the surface, then as often as it turns.
    fn push_curve<S: Surface>(
        &mut self,
        surface: &S,
        trim: &Trim,
        patch: u32,
        piece: &Monotone,
        grid: &Grid,
        beziers: &[BezierPiece],
    ) {
        let [low, high] = piece.bounds();
        let mut cuts = vec![0.0, 1.0];
        for k in 0..2 {
            let inner = grid.breaks[k]
                .iter()
                .filter(|&&x| low[k] < x && x < high[k]);
            cuts.extend(inner.map(|&x| piece.solve(k, x)));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| *a - *b <= 1e-13);
        if let Some(last) = cuts.last_mut() {
            *last = 1.0;
        }
        let domain = surface.domain();
        let extent = domain.map(|[a, b]| b - a);
        for pair in cuts.windows(2) {
            let middle = piece.point(0.5 * (pair[0] + pair[1]));
            // Parts outside of the domain (by more than rounding) bound nothing.
            let outside = (0..2).any(|k| {
                let slack = 1e-5 * extent[k];
                middle[k] < domain[k][0] - slack || middle[k] > domain[k][1] + slack
            });
            if outside {
                continue;
            }
            let (a, b) = (piece.point(pair[0]), piece.point(pair[1]));
            let span = surface.find_span(inward(trim, middle, [a, b], domain));
            let Some(bezier) = beziers.get(span[0] + grid.spans[0] * span[1]) else {
                continue;
            };
            let net = compose(bezier, &restricted(&piece.net, pair[0], pair[1]));
            let parts = (turning(&net) / TURN).ceil().clamp(1.0, MOST as f64) as usize;
            let mut rest = net;
            let at = |k: usize| {
                let share = k as f64 / parts as f64;
                piece.parameter(pair[0] + share * (pair[1] - pair[0]))
            };
            for k in 0..parts {
                let own = if k + 1 < parts {
                    let mut right = vec![[0.0; 4]; rest.len()];
                    split_curve(&mut rest, &mut right, 1.0 / (parts - k) as f64);
                    std::mem::replace(&mut rest, right)
                } else {
                    std::mem::take(&mut rest)
                };
                self.leaves.push(CurveLeaf {
                    patch,
                    curve: piece.curve,
                    t: [at(k), at(k + 1)],
                    span,
                    net: [self.nets.len(), own.len()],
                });
                self.nets.extend(own);
            }
        }
    }

    /// Control points of a leaf.
    pub fn net(&self, leaf: &CurveLeaf) -> &[[f64; 4]] {
        &self.nets[leaf.net[0]..leaf.net[0] + leaf.net[1]]
    }

    /// Gives back the memory that more patches would have taken.
    pub fn shrink(&mut self) {
        self.parts.shrink_to_fit();
        self.leaves.shrink_to_fit();
        self.nets.shrink_to_fit();
    }

    /// Boxes for the tree: those of the pieces, turned inside out where the piece is trimmed away, then those of the leaves.
    pub fn finish_boxes(&self, boxes: &mut Vec<[Vec3; 2]>) {
        let away = [f64::INFINITY, f64::NEG_INFINITY].map(Vec3::from_element);
        for (own, part) in boxes.iter_mut().zip(&self.parts) {
            if *part == Part::Outside {
                *own = away;
            }
        }
        boxes.extend(self.leaves.iter().map(|leaf| hull(self.net(leaf))));
    }

    /// Whether a piece lies inside of its trim, if there is one.
    #[inline]
    pub fn is_inside(&self, piece: u32) -> bool {
        self.parts.is_empty() || self.parts[piece as usize] == Part::Inside
    }

    /// Whether the border of the trim runs through a piece.
    #[inline]
    pub fn is_cut(&self, piece: u32) -> bool {
        !self.parts.is_empty() && self.parts[piece as usize] == Part::Cut
    }

    /// The largest rectangle of cells that are all inside, grown from the cell at `place` within `block`; the cell alone where
    /// it is not inside itself.
    pub fn block(&self, grid: &Grid, place: [u32; 2], block: [[u32; 2]; 2]) -> [[u32; 2]; 2] {
        if self.parts.is_empty() {
            return block;
        }
        let mut out = place.map(|c| [c, c + 1]);
        if !self.is_inside(grid.piece(place)) {
            return out;
        }
        for k in 0..2 {
            for end in 0..2 {
                let mut wider = out;
                wider[k][end] = block[k][end];
                let mut cells = (wider[1][0]..wider[1][1])
                    .flat_map(|j| (wider[0][0]..wider[0][1]).map(move |i| [i, j]));
                if cells.all(|cell| self.is_inside(grid.piece(cell))) {
                    out = wider;
                }
            }
        }
        out
    }

    /// Number of the leaf that holds a parameter of a curve.
    pub fn leaf_at(&self, patch: u32, curve: u32, t: f64) -> Option<usize> {
        let before = |leaf: &CurveLeaf| (leaf.patch, leaf.curve) < (patch, curve);
        let start = self.leaves.partition_point(before);
        let own = self.leaves[start..]
            .partition_point(|l| (l.patch, l.curve) == (patch, curve) && l.t[0] <= t);
        let leaf = self.leaves.get(start + own.saturating_sub(1))?;
        ((leaf.patch, leaf.curve) == (patch, curve)).then_some(start + own.saturating_sub(1))
    }
}

/// A point of the parameter plane a little to the inner side of a border point, `ends` being points before and after it;
/// the point itself where both sides are alike.
fn inward(trim: &Trim, middle: [f64; 2], ends: [[f64; 2]; 2], domain: [[f64; 2]; 2]) -> [f64; 2] {
    let extent = domain.map(|[a, b]| b - a);
    let along = [0, 1].map(|k| (ends[1][k] - ends[0][k]) / extent[k]);
    let length = along[0].hypot(along[1]);
    if length == 0.0 || length.is_nan() {
        return middle;
    }
    let side = |step: f64| {
        [
            middle[0] - step * along[1] / length * extent[0],
            middle[1] + step * along[0] / length * extent[1],
        ]
    };
    let step = 1e-6 * length.min(1.0);
    let step = match [side(step), side(-step)].map(|xi| trim.contains(xi)) {
        [true, false] => step,
        [false, true] => -step,
        _ => return middle,
    };
    [0, 1].map(|k| side(1e-3 * step)[k].clamp(domain[k][0], domain[k][1]))
}

/// The part from `a` to `b` of a planar net.
fn restricted(net: &[[f64; 3]], a: f64, b: f64) -> Vec<[f64; 3]> {
    // As a space net with nothing in its third place.
    let mut left: Vec<[f64; 4]> = net.iter().map(|&[x, y, w]| [x, y, 0.0, w]).collect();
    let mut right = left.clone();
    if b < 1.0 {
        split_curve(&mut left, &mut right, b);
    }
    if a > 0.0 {
        split_curve(&mut left, &mut right, a / b);
        left = right;
    }
    left.iter().map(|&[x, y, _, w]| [x, y, w]).collect()
}

/// Control points of the surface curve over a parameter curve (w x, w y, w).
fn compose(bezier: &BezierPiece, curve: &[[f64; 3]]) -> Vec<[f64; 4]> {
    let weight: Vec<f64> = curve.iter().map(|c| c[2]).collect();
    // The factors of both neighbours in one step of de Casteljau's algorithm.
    let factors = [0, 1].map(|k| {
        let [a, b] = bezier.domain[k];
        let up: Vec<f64> = curve.iter().map(|c| (c[k] - a * c[2]) / (b - a)).collect();
        let down: Vec<f64> = up.iter().zip(&weight).map(|(u, w)| w - u).collect();
        [down, up]
    });
    let n1 = bezier.degree[0] + 1;
    let rows = bezier.points.chunks(n1).map(|row| {
        let points = row.iter().map(|p| p.map(|x| vec![x])).collect();
        casteljau(points, &factors[0])
    });
    let [x, y, z, w] = casteljau(rows.collect(), &factors[1]);
    (0..w.len()).map(|k| [x[k], y[k], z[k], w[k]]).collect()
}

/// De Casteljau's algorithm on points whose coordinates are polynomials.
fn casteljau(mut points: Vec<[Vec<f64>; 4]>, factors: &[Vec<f64>; 2]) -> [Vec<f64>; 4] {
    let m = factors[0].len() - 1;
    // Products of polynomials in Bernstein form: sums of products of the coefficients, each times its binomial.
    let scaled =
        |f: &[f64]| -> Vec<f64> { f.iter().zip(binomials(m)).map(|(x, c)| x * c).collect() };
    let factors = [scaled(&factors[0]), scaled(&factors[1])];
    let mut other = Vec::new();
    while points.len() > 1 {
        let n = points[0][0].len() - 1;
        let own: Vec<f64> = binomials(n).collect();
        let all: Vec<f64> = binomials(n + m).collect();
        let product = |a: &[f64], b: &[f64], out: &mut Vec<f64>| {
            out.clear();
            out.resize(n + m + 1, 0.0);
            for (i, (a, c)) in a.iter().zip(&own).enumerate() {
                for (out, b) in out[i..].iter_mut().zip(b) {
                    *out += a * c * b;
                }
            }
            for (out, c) in out.iter_mut().zip(&all) {
                *out /= c;
            }
        };
        points = points
            .windows(2)
            .map(|pair| {
                [0, 1, 2, 3].map(|c| {
                    let mut sum = Vec::new();
                    product(&pair[0][c], &factors[0], &mut sum);
                    product(&pair[1][c], &factors[1], &mut other);
                    for (sum, x) in sum.iter_mut().zip(&other) {
                        *sum += x;
                    }
                    sum
                })
            })
            .collect();
    }
    points.pop().unwrap_or_default()
}

/// How far a control polygon turns (radians), at least a little for legs of uneven length.
fn turning(net: &[[f64; 4]]) -> f64 {
    let point = |p: &[f64; 4]| Vec3::new(p[0], p[1], p[2]) / p[3];
    let legs: Vec<Vec3> = net
        .windows(2)
        .map(|p| point(&p[1]) - point(&p[0]))
        .collect();
    let sum: f64 = legs
        .windows(2)
        .map(|d| d[0].cross(&d[1]).norm().atan2(d[0].dot(&d[1])))
        .sum();
    if sum.is_finite() { sum } else { 0.0 }
}

/// Cuts a control net at `t` (0 to 1): `left` becomes the first part, `right` the second one.
pub(super) fn split_curve(left: &mut [[f64; 4]], right: &mut [[f64; 4]], t: f64) {
    let n = left.len();
    // The last of the shrinking row is final for the right part; the first one for the left part.
    right.copy_from_slice(left);
    for (r, left) in left.iter_mut().enumerate().skip(1) {
        for i in 0..n - r {
            let next = right[i + 1];
            for (x, next) in right[i].iter_mut().zip(next) {
                *x += t * (next - *x);
            }
        }
        *left = right[0];
    }
}

/// Whether a rational Bezier curve is proved to lie outside of the open ball of radius `c` about `q`: as for surface
/// pieces, no Bernstein coefficient of `|w (rho - q)|^2 - c^2 w^2` is negative.
pub(super) fn curve_outside_ball(
    net: &[[f64; 4]],
    q: &Vec3,
    c: f64,
    room: &mut Vec<[f64; 4]>,
) -> bool {
    let n = net.len();
    room.clear();
    let mut factor = 1.0;
    for (i, p) in net.iter().enumerate() {
        let w = p[3] * factor;
        room.push([
            p[0] * factor - q.x * w,
            p[1] * factor - q.y * w,
            p[2] * factor - q.z * w,
            c * w,
        ]);
        factor *= (n - 1 - i) as f64 / (i + 1) as f64;
    }
    let product =
        |a: &[f64; 4], b: &[f64; 4]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - a[3] * b[3];
    // The ends first: they fail soonest.
    let ends = product(&room[0], &room[0]).min(product(&room[n - 1], &room[n - 1]));
    if ends < 0.0 || ends.is_nan() {
        return false;
    }
    (1..2 * n - 2).all(|l| {
        let from = l.saturating_sub(n - 1);
        let sum: f64 = (from..=l.min(n - 1))
            .map(|j| product(&room[j], &room[l - j]))
            .sum();
        sum >= 0.0
    })
}

/// Binomials stay finite in the products above up to this number of control points.
pub(super) const MOST_POINTS: usize = 460;

const _: () = assert!(crate::basis::MAX_DEGREE * 2 * crate::basis::MAX_DEGREE < MOST_POINTS);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trim::choose;

    #[test]
    fn binomials_of_the_highest_degree_are_finite() {
        let most = choose(MOST_POINTS, MOST_POINTS / 2);
        assert!((most * most).is_finite());
    }
}
