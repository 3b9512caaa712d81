//! Space curves that run along a side of their surface, which needs no search over the whole of it.

use super::host::{Host, Xi};
use crate::{NurbsCurve, Vec3};

/// A curve runs along a side where it keeps within this share of the surface's size.
const NEAR: f64 = 1e-7;
/// Points of each span of a side among which a start is looked for.
const STARTS: usize = 4;
const ITERATIONS: usize = 12;

/// The line in the parameter plane that stands for a space curve along one side of a surface, and how far the points of the
/// curve lie off it. `None` where it runs along none, or along two.
pub fn along_side(host: &Host, points: &[Vec3]) -> Option<(NurbsCurve<2>, f64)> {
    if host.closed != [false; 2] {
        return None;
    }
    let mut found = None;
    for dir in 0..2 {
        for end in 0..2 {
            let side = Side::of(host, dir, host.domain[dir][end]);
            if let Some(line) = side.follow(points)? {
                if found.is_some() {
                    return None;
                }
                found = Some(line);
            }
        }
    }
    // Without work left, not all sides were followed to their ends: the curve may run along two.
    let (ends, off) = found.filter(|_| !host.grant.is_spent())?;
    Some((NurbsCurve::line(ends[0], ends[1]).ok()?, off))
}

/// A side of a surface: parameter `dir` is fixed.
struct Side<'h, 'p> {
    host: &'h Host<'p>,
    dir: usize,
    fixed: f64,
    /// Range of the other parameter.
    range: [f64; 2],
}

impl<'h, 'p> Side<'h, 'p> {
    fn of(host: &'h Host<'p>, dir: usize, fixed: f64) -> Self {
        Self {
            host,
            dir,
            fixed,
            range: host.domain[1 - dir],
        }
    }

    fn at(&self, t: f64) -> Xi {
        let mut xi = Xi::repeat(self.fixed);
        xi[1 - self.dir] = t;
        xi
    }

    /// Ends of the line under a row of points and their largest distance from the side. The outer `None` says that the file
    /// is granted no more work, the inner one that the points lie elsewhere.
    #[allow(clippy::option_option)]
    fn follow(&self, points: &[Vec3]) -> Option<Option<([Xi; 2], f64)>> {
        let spans = self.host.patch.spans(1 - self.dir);
        let starts = STARTS * spans.len() + 1;
        let first = starts as u64 * self.host.evaluation();
        self.host.grant.work(first).ok()?;
        let [first, rest @ ..] = points else {
            return Some(None);
        };
        let share = |k: usize| {
            let [a, b] = spans[(k / STARTS).min(spans.len() - 1)];
            match k == STARTS * spans.len() {
                true => b,
                false => a + (b - a) * (k % STARTS) as f64 / STARTS as f64,
            }
        };
        let far = |t: f64| (self.host.patch.point(self.at(t).into()) - first).norm_squared();
        let nearest = (0..starts).map(share).map(|t| (far(t), t));
        let Some((_, mut t)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return Some(None);
        };
        let mut off = self.nearest(first, &mut t);
        let (from, mut sense) = (t, 0.0);
        for x in rest {
            if off > NEAR * self.host.size {
                return Some(None);
            }
            let before = t;
            off = off.max(self.nearest(x, &mut t));
            let step = t - before;
            // A curve that turns round runs along no line.
            if step * sense < 0.0 {
                return Some(None);
            }
            if step != 0.0 {
                sense = step;
            }
        }
        let found = off <= NEAR * self.host.size && t != from;
        Some(found.then_some(([self.at(from), self.at(t)], off)))
    }

    /// Distance of a point from the side, near a parameter, which becomes that of the nearest point: Newton's method.
    fn nearest(&self, x: &Vec3, t: &mut f64) -> f64 {
        let along = 1 - self.dir;
        let [low, high] = self.range;
        let cost = self.host.evaluation();
        for _ in 0..ITERATIONS {
            if !self.host.grant.spend(cost) {
                return f64::INFINITY;
            }
            let jet = self.host.patch.jet(self.at(*t).into());
            let d = jet.rho - x;
            let (d1, d2) = (jet.rho_i[along], jet.rho_ij[2 * along]);
            let metric = d1.norm_squared();
            let bend = metric + d.dot(&d2);
            let next = *t - d.dot(&d1) / if bend > 0.1 * metric { bend } else { metric };
            if !next.is_finite() {
                return f64::INFINITY;
            }
            let next = next.clamp(low, high);
            let step = (next - *t).abs();
            *t = next;
            if step <= 1e-14 * (high - low) {
                break;
            }
        }
        let off = (self.host.patch.point(self.at(*t).into()) - x).norm();
        if off.is_nan() { f64::INFINITY } else { off }
    }
}
