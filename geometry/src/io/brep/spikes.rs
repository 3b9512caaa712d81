//! Ends of boundary curves that run back along each other. Such a spike bounds no area, but it would be an edge of the face
//! where there is no face.

use super::host::{Host, Xi};
use crate::NurbsCurve;
use crate::curve::CurveError;
use crate::trim::TrimCurve;

/// Ends of curves lie on a straight line within this share of the domain.
const ON_LINE: f64 = 1e-7;
/// Between its ends a curve may leave the line by this share of the distance at which points count as the same.
const BETWEEN: f64 = 0.1;
/// Points of a Bezier piece that are looked at.
const POINTS: usize = 8;

/// A loop without its spikes, and the length in space of what was cut off. A loop that is nothing else stays as it is.
pub(super) fn without_ends(
    host: &Host,
    curves: Vec<TrimCurve>,
) -> Result<(Vec<TrimCurve>, f64), String> {
    let mut left = curves.clone();
    let (mut k, mut tried, mut length) = (0, 0, 0.0);
    // Each junction once, and anew where something was cut off at it.
    while left.len() > 1 && tried < left.len() {
        let next = (k + 1) % left.len();
        let Some(cut) = overlap(host, &left[k], &left[next]) else {
            (k, tried) = (next, tried + 1);
            continue;
        };
        (tried, length) = (0, length + cut.length);
        let [a, b] = [&left[k], &left[next]].map(|c| c.parameter.domain());
        let kept = [[a[0], cut.t[0]], [cut.t[1], b[1]]];
        let mut gone = Vec::with_capacity(2);
        for (place, [from, to]) in [k, next].into_iter().zip(kept) {
            if from < to {
                left[place] = part(&left[place], [from, to]).map_err(|e| e.to_string())?;
            } else {
                gone.push(place);
            }
        }
        gone.sort_unstable();
        for place in gone.into_iter().rev() {
            left.remove(place);
        }
        // The curve in front of the junction, or what stands there now.
        k = k.saturating_sub(1).min(left.len().saturating_sub(1));
    }
    match left.len() {
        0 | 1 if left.len() < curves.len() && !is_closed(&left) => Ok((curves, 0.0)),
        _ => Ok((left, length)),
    }
}

fn is_closed(curves: &[TrimCurve]) -> bool {
    curves.iter().any(|c| {
        let [a, b] = c.parameter.ends();
        let [low, high] = c.parameter.domain();
        let middle = c.parameter.point(0.5 * (low + high));
        (a - b).norm() < (a - middle).norm()
    })
}

fn part(curve: &TrimCurve, domain: [f64; 2]) -> Result<TrimCurve, CurveError> {
    Ok(TrimCurve {
        parameter: curve.parameter.with_domain(domain)?,
        // The curve in space that the file gives is longer.
        space: None,
        entity: curve.entity,
    })
}

/// Where a curve and the next one are to be cut.
struct Cut {
    t: [f64; 2],
    /// In space.
    length: f64,
}

/// The part over which curve `b` runs back along the end of curve `a`.
fn overlap(host: &Host, a: &TrimCurve, b: &TrimCurve) -> Option<Cut> {
    let share = |xi: Xi| Xi::new(xi.x / host.extent(0), xi.y / host.extent(1));
    let tip = b.parameter.ends()[0];
    let joint = a.parameter.ends()[1];
    if (host.point(tip) - host.point(joint)).norm() > host.agree {
        return None;
    }
    // Pieces of both from the tip outward.
    let back: Vec<[f64; 2]> = spans(&a.parameter).map(|[s, t]| [t, s]).rev().collect();
    let ahead: Vec<[f64; 2]> = spans(&b.parameter).collect();
    let outer = |curve: &TrimCurve, ranges: &[[f64; 2]]| curve.parameter.point(ranges[0][1]);
    let ways = [outer(a, &back), outer(b, &ahead)].map(|xi| share(xi - tip));
    let lengths = ways.map(|w| w.norm());
    if lengths.iter().any(|&l| l.is_nan() || l <= ON_LINE) || ways[0].dot(&ways[1]) <= 0.0 {
        return None;
    }
    let way = ways[usize::from(lengths[1] > lengths[0])] / lengths[0].max(lengths[1]);
    let line = Line { host, tip, way };
    let runs = [(a, &back), (b, &ahead)].map(|(curve, ranges)| line.run(&curve.parameter, ranges));
    let reach = runs[0].1.min(runs[1].1);
    if reach <= ON_LINE {
        return None;
    }
    let cut =
        |curve: &TrimCurve, ranges: &[[f64; 2]], (pieces, end): (usize, f64)| match end <= reach {
            true => ranges[pieces - 1][1],
            false => line.place(&curve.parameter, &ranges[..pieces], reach),
        };
    let t = [cut(a, &back, runs[0]), cut(b, &ahead, runs[1])];
    let far = host.point(b.parameter.point(t[1]));
    Some(Cut {
        t,
        length: (far - host.point(tip)).norm(),
    })
}

fn spans(curve: &NurbsCurve<2>) -> impl DoubleEndedIterator<Item = [f64; 2]> + '_ {
    let basis = curve.basis();
    (0..basis.span_count()).map(|k| basis.span_range(k))
}

/// A straight line of the parameter plane, in shares of the domain.
struct Line<'h, 'p> {
    host: &'h Host<'p>,
    tip: Xi,
    way: Xi,
}

impl Line<'_, '_> {
    /// How far along the line a point lies, and how far beside it.
    fn of(&self, xi: Xi) -> (f64, f64) {
        let d = xi - self.tip;
        let d = Xi::new(d.x / self.host.extent(0), d.y / self.host.extent(1));
        (d.dot(&self.way), d.perp(&self.way).abs())
    }

    /// How many pieces of a curve run along the line, and how far they get.
    fn run(&self, curve: &NurbsCurve<2>, ranges: &[[f64; 2]]) -> (usize, f64) {
        let (mut count, mut end) = (0, 0.0);
        for &[from, to] in ranges {
            let Some(far) = self.along(curve, [from, to], end) else {
                break;
            };
            (count, end) = (count + 1, far);
        }
        (count, end)
    }

    /// Where a piece that begins at `start` on the line ends on it.
    fn along(&self, curve: &NurbsCurve<2>, [from, to]: [f64; 2], start: f64) -> Option<f64> {
        let (end, beside) = self.of(curve.point(to));
        if beside > ON_LINE || end.is_nan() || end <= start {
            return None;
        }
        let mut before = start - ON_LINE;
        for k in 1..POINTS {
            let xi = curve.point(from + (to - from) * (k as f64 / POINTS as f64));
            let (at, _) = self.of(xi);
            let extent = Xi::new(self.host.extent(0), self.host.extent(1));
            let on = self.tip + (self.way * at).component_mul(&extent);
            let off = (self.host.point(xi) - self.host.point(on)).norm();
            if at <= before || at >= end + ON_LINE || off > BETWEEN * self.host.agree {
                return None;
            }
            before = at;
        }
        Some(end)
    }

    /// Parameter of a curve that runs along the line where it gets to `reach`.
    fn place(&self, curve: &NurbsCurve<2>, ranges: &[[f64; 2]], reach: f64) -> f64 {
        let at = |t: f64| self.of(curve.point(t)).0;
        let holds = ranges.iter().find(|r| at(r[1]) >= reach);
        let Some(&[mut from, mut to]) = holds.or(ranges.last()) else {
            return curve.domain()[0];
        };
        for _ in 0..100 {
            let middle = 0.5 * (from + to);
            if middle == from || middle == to {
                break;
            }
            if at(middle) < reach {
                from = middle;
            } else {
                to = middle;
            }
        }
        to
    }
}
