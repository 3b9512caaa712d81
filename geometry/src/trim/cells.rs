//! Integration over what a trim leaves of a rectangle of parameters.
//!
//! The rectangle is cut into strips across one of its directions, at the ends of the monotone pieces of the loops within it. In a
//! strip the pieces are graphs over that direction that do not cross, and what lies between two neighbours is kept or not. A part
//! that is kept is a quadrilateral with two straight sides, over which a rule is mapped: along the strip by the parameter of the
//! piece that bounds it, so that a curve whose tangent turns across the strip does no harm (height functions: R. I. Saye, SIAM J.
//! Sci. Comput. 37, 2015; quadrilaterals along the curve: P. Antolin, A. Buffa, M. Martinelli, CMAME 355, 2019).

use super::monotone::{Monotone, Point};
use super::{Part, Trim};

/// Differences of integrals below this part of the rectangle's are not made smaller.
const FINE: f64 = 1e-11;
/// Most halvings of a part.
const DEPTH: u32 = 12;
/// Strips and heights below this part of the rectangle are nothing.
const THIN: f64 = 1e-12;

/// A point of a rule in the plane of parameters, with its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RulePoint {
    /// Where it is.
    pub xi: [f64; 2],
    /// What it stands for, in the area of parameters.
    pub weight: f64,
}

/// A monotone piece within the rectangle, over a range of its own parameter.
struct Arc<'a> {
    piece: &'a Monotone,
    /// Ends in the direction of the strips, ascending.
    range: [f64; 2],
}

/// What bounds a part across the strip.
#[derive(Clone, Copy)]
enum Side<'a> {
    Straight(f64),
    Curve(&'a Monotone),
}

impl Side<'_> {
    /// The other coordinate where coordinate `k` is `value`.
    fn height(self, k: usize, value: f64) -> f64 {
        match self {
            Side::Straight(at) => at,
            Side::Curve(piece) => piece.point(piece.solve(k, value))[1 - k],
        }
    }
}

/// A part of a strip that is kept.
struct Cell<'a> {
    /// The direction along the strip.
    k: usize,
    range: [f64; 2],
    sides: [Side<'a>; 2],
}

impl Trim {
    /// Rules for the part of a rectangle that belongs to the surface: a group of `rule.len()^2` points for each quadrilateral
    /// that it is cut into, mapped from a rule of points and weights on [0, 1]. One group, the rule itself, where nothing is cut
    /// away; none where nothing, or less than 1e-10 of the rectangle, is left. Area and moments up to the third in both
    /// directions are exact to about 1e-11 of the rectangle's if the rule has four points or more.
    pub fn rules(&self, rectangle: [[f64; 2]; 2], rule: &[[f64; 2]]) -> Vec<Vec<RulePoint>> {
        let width = rectangle.map(|[a, b]| b - a);
        let whole = Cell {
            k: 0,
            range: rectangle[0],
            sides: rectangle[1].map(Side::Straight),
        };
        match self.part(rectangle) {
            Part::Inside => return vec![whole.rule(rule)],
            Part::Outside => return Vec::new(),
            Part::Cut => {}
        }
        let arcs = [0, 1].map(|k| self.arcs(rectangle, k));
        // Strips along the direction in which the pieces are longer.
        let length = |k: usize| -> f64 {
            let all = arcs[k].iter();
            all.map(|a| (a.range[1] - a.range[0]) / width[k]).sum()
        };
        let k = usize::from(length(1) > length(0));
        let cells = self.strips(rectangle, k, &arcs[k]);
        let mut out = Vec::new();
        for cell in &cells {
            cell.refine(rule, rectangle, DEPTH, &mut out);
        }
        let all = |out: &[Vec<RulePoint>]| -> f64 { out.iter().flatten().map(|p| p.weight).sum() };
        let (area, full) = (all(&out), width[0] * width[1]);
        if area > (1.0 - 1e-12) * full {
            return vec![whole.rule(rule)];
        }
        if area < 1e-10 * full {
            return Vec::new();
        }
        out
    }

    /// The monotone pieces within a rectangle, less those that run across direction `k`.
    fn arcs(&self, rectangle: [[f64; 2]; 2], k: usize) -> Vec<Arc<'_>> {
        let tiny = rectangle.map(|[a, b]| THIN * (b - a));
        let mut out = Vec::new();
        for piece in self.pieces() {
            let [low, high] = piece.bounds();
            // What touches a side, or lies in it, bounds nothing within.
            let misses = |d: usize| {
                high[d] <= rectangle[d][0] + tiny[d] || low[d] >= rectangle[d][1] - tiny[d]
            };
            if misses(0) || misses(1) {
                continue;
            }
            let mut ends = [0.0, 1.0];
            for d in 0..2 {
                let rises = piece.from[d] <= piece.to[d];
                for (side, value) in rectangle[d].into_iter().enumerate() {
                    let beyond = low[d] < value && high[d] > value;
                    if beyond {
                        let s = piece.solve(d, value);
                        // The part above the lower side, and below the upper one.
                        match (side == 0) == rises {
                            true => ends[0] = f64::max(ends[0], s),
                            false => ends[1] = f64::min(ends[1], s),
                        }
                    }
                }
            }
            if ends[1] <= ends[0] {
                continue;
            }
            let at = ends.map(|s| piece.point(s)[k]);
            let range = [at[0].min(at[1]), at[0].max(at[1])];
            if range[1] - range[0] > tiny[k] {
                out.push(Arc { piece, range });
            }
        }
        out
    }

    /// The parts of all strips that are kept.
    fn strips<'a>(&'a self, rectangle: [[f64; 2]; 2], k: usize, arcs: &[Arc<'a>]) -> Vec<Cell<'a>> {
        let [low, high] = rectangle[k];
        let [bottom, top] = rectangle[1 - k];
        let tiny = THIN * (high - low);
        let mut cuts = vec![low, high];
        // Pieces that were left out for running across end a strip, too.
        let near = self.pieces().iter().filter(|p| {
            let [from, to] = p.bounds();
            from[1 - k] <= top && to[1 - k] >= bottom
        });
        let ends = near.flat_map(|p| [p.from[k], p.to[k]]);
        cuts.extend(arcs.iter().flat_map(|a| a.range).chain(ends));
        cuts.retain(|c| *c >= low && *c <= high);
        cuts.sort_by(f64::total_cmp);
        let mut out = Vec::new();
        let mut start = low;
        for end in cuts {
            if end - start <= tiny {
                continue;
            }
            let middle = 0.5 * (start + end);
            let mut within: Vec<(f64, Side)> = arcs
                .iter()
                .filter(|a| a.range[0] < middle && a.range[1] > middle)
                .map(|a| {
                    let side = Side::Curve(a.piece);
                    (side.height(k, middle), side)
                })
                .collect();
            within.push((bottom, Side::Straight(bottom)));
            within.push((top, Side::Straight(top)));
            within.sort_by(|a, b| a.0.total_cmp(&b.0));
            for pair in within.windows(2) {
                let [(a, from), (b, to)] = [pair[0], pair[1]];
                if b - a <= THIN * (top - bottom) {
                    continue;
                }
                let mut at: Point = [middle; 2];
                at[1 - k] = 0.5 * (a + b);
                if self.contains(at) {
                    out.push(Cell {
                        k,
                        range: [start, end],
                        sides: [from, to],
                    });
                }
            }
            start = end;
        }
        out
    }
}

impl Cell<'_> {
    /// The rule on it: along the strip by the parameter of its first curved side, if it has one.
    fn rule(&self, rule: &[[f64; 2]]) -> Vec<RulePoint> {
        let k = self.k;
        let [start, end] = self.range;
        let leads = self.sides.iter().find_map(|side| match side {
            Side::Curve(piece) => Some((*piece, self.range.map(|x| piece.solve(k, x)))),
            Side::Straight(_) => None,
        });
        let mut out = Vec::with_capacity(rule.len() * rule.len());
        for [s, w] in rule {
            let (x, along) = match leads {
                Some((piece, [a, b])) => {
                    let s = a + s * (b - a);
                    let (_, tangent) = piece.tangent(s);
                    (piece.point(s)[k], (tangent[k] * (b - a)).abs())
                }
                None => (start + s * (end - start), end - start),
            };
            let [from, to] = self.sides.map(|side| side.height(k, x));
            for [t, v] in rule {
                let mut xi = [x; 2];
                xi[1 - k] = from + t * (to - from);
                out.push(RulePoint {
                    xi,
                    weight: w * along * v * (to - from),
                });
            }
        }
        out
    }

    /// Adds its rule, or those of its halves where they give another result.
    fn refine(
        &self,
        rule: &[[f64; 2]],
        rectangle: [[f64; 2]; 2],
        depth: u32,
        out: &mut Vec<Vec<RulePoint>>,
    ) {
        let own = self.rule(rule);
        if depth == 0 || !self.sides.iter().any(|s| matches!(s, Side::Curve(_))) {
            out.push(own);
            return;
        }
        let middle = self.middle();
        let halves = [[self.range[0], middle], [middle, self.range[1]]].map(|range| Cell {
            k: self.k,
            range,
            sides: self.sides,
        });
        let size: f64 = rectangle.iter().map(|[a, b]| b - a).product();
        let moments = |points: &mut dyn Iterator<Item = RulePoint>| {
            points.fold([0.0; 2], |[area, moment], p| {
                let [x, y] = [0, 1].map(|d| {
                    let [a, b] = rectangle[d];
                    (p.xi[d] - a) / (b - a)
                });
                [area + p.weight, moment + p.weight * (x * y).powi(3)]
            })
        };
        let one = moments(&mut own.iter().copied());
        let two = moments(&mut halves.iter().flat_map(|h| h.rule(rule)));
        if one
            .iter()
            .zip(two)
            .all(|(a, b)| (a - b).abs() <= FINE * size)
        {
            out.push(own);
            return;
        }
        for half in halves {
            half.refine(rule, rectangle, depth - 1, out);
        }
    }

    /// Where it is halved: in the middle of the parameter of its curve.
    fn middle(&self) -> f64 {
        for side in &self.sides {
            if let Side::Curve(piece) = side {
                let [a, b] = self.range.map(|x| piece.solve(self.k, x));
                let middle = piece.point(0.5 * (a + b))[self.k];
                if middle > self.range[0] && middle < self.range[1] {
                    return middle;
                }
            }
        }
        0.5 * (self.range[0] + self.range[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::conic::elliptic_arc;
    use crate::trim::{TrimCurve, TrimLoop};
    use nalgebra::Vector2;
    use std::f64::consts::{PI, TAU};

    /// Gauss points and weights on [0, 1].
    const RULE: [[f64; 2]; 4] = [
        [0.06943184420297371, 0.17392742256872692],
        [0.33000947820757187, 0.32607257743127305],
        [0.6699905217924281, 0.32607257743127305],
        [0.9305681557970263, 0.17392742256872692],
    ];

    fn ellipse(centre: [f64; 2], [a, b]: [f64; 2]) -> TrimLoop {
        let [e1, e2] = [Vector2::x() * a, Vector2::y() * b];
        let parameter = elliptic_arc(Vector2::from(centre), e1, e2, 0.0, TAU).unwrap();
        let curve = TrimCurve {
            parameter,
            space: None,
            entity: 0,
        };
        TrimLoop {
            curves: vec![curve],
        }
    }

    /// Integral of `f` over all cells of a grid.
    fn integral(trim: &Trim, n: usize, f: impl Fn([f64; 2]) -> f64) -> (f64, usize) {
        let at = |k: usize| k as f64 / n as f64;
        let (mut sum, mut groups) = (0.0, 0);
        for k in 0..n * n {
            let cell = [k % n, k / n].map(|k| [at(k), at(k + 1)]);
            let all = trim.rules(cell, &RULE);
            groups += all.len();
            sum += all
                .iter()
                .flatten()
                .map(|p| p.weight * f(p.xi))
                .sum::<f64>();
            let inside = |p: &RulePoint| {
                (0..2).all(|d| p.xi[d] >= cell[d][0] && p.xi[d] <= cell[d][1]) && p.weight > 0.0
            };
            for p in all.iter().flatten() {
                assert!(inside(p) && trim.contains(p.xi), "{n}: {cell:?} {p:?}");
            }
        }
        (sum, groups)
    }

    /// Areas and moments of inertia of a disc, and of the square with an elliptic hole, on grids of any fineness; also where
    /// lines of the grid touch the curve.
    #[test]
    fn areas_and_moments_are_exact() {
        for n in [1, 2, 3, 5, 8, 20] {
            for radius in [0.4, 0.25, 0.31, 0.01] {
                let circle = Trim::new(vec![ellipse([0.5; 2], [radius; 2])], [[0.0, 1.0]; 2], 1e-9);
                let circle = circle.unwrap();
                let (area, groups) = integral(&circle, n, |_| 1.0);
                let exact = PI * radius * radius;
                assert!((area - exact).abs() < 2e-11, "{n} {radius}: {area} {exact}");
                let polar = |[x, y]: [f64; 2]| (x - 0.5).powi(2) + (y - 0.5).powi(2);
                let (inertia, _) = integral(&circle, n, polar);
                assert!((inertia - 0.5 * PI * radius.powi(4)).abs() < 2e-11);
                assert!(groups < 40 * n, "{groups} groups for {n}");
            }
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let border = TrimLoop {
                curves: (0..4)
                    .map(|k| {
                        let ends = [corners[k], corners[(k + 1) % 4]].map(Vector2::from);
                        TrimCurve {
                            parameter: crate::curve::NurbsCurve::line(ends[0], ends[1]).unwrap(),
                            space: None,
                            entity: 0,
                        }
                    })
                    .collect(),
            };
            let axes = [0.22, 0.09];
            let plate = vec![border, ellipse([0.47, 0.36], axes)];
            let plate = Trim::new(plate, [[0.0, 1.0]; 2], 1e-9).unwrap();
            let (area, _) = integral(&plate, n, |_| 1.0);
            let hole = PI * axes[0] * axes[1];
            assert!((area - 1.0 + hole).abs() < 2e-11, "{n}: {area}");
            let (moment, _) = integral(&plate, n, |[x, _]| x * x * x);
            // Of the hole: 3 c I + c^3 A with I = A a^2 / 4.
            let exact = 0.25 - hole * (0.47f64.powi(3) + 0.75 * 0.47 * axes[0] * axes[0]);
            assert!((moment - exact).abs() < 2e-11, "{n}: {moment} {exact}");
        }
    }
}
