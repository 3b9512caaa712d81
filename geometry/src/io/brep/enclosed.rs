//! What a closed loop encloses in the parameter plane of a surface, and seams that it runs through there and back.

use super::host::{Host, Xi};
use super::loops::{GAP, reversed};
use crate::curve::CurveError;
use crate::trim::{TrimCurve, TrimLoop};
use std::collections::VecDeque;

/// Whether curves of a chain are one line of the parameter plane, run through in opposite directions.
pub(super) fn runs_back(host: &Host, curves: &[TrimCurve]) -> bool {
    let rest = |k: usize| curves[k + 1..].iter();
    (0..curves.len()).any(|k| rest(k).any(|other| are_opposed(host, &curves[k], other)))
}

fn are_opposed(host: &Host, a: &TrimCurve, b: &TrimCurve) -> bool {
    let near = |a: Xi, b: Xi| (0..2).all(|d| (a[d] - b[d]).abs() <= GAP * host.extent(d));
    let straight = |curve: &TrimCurve| curve.parameter.homogeneous().len() == 2;
    let middle = |curve: &TrimCurve| {
        let [a, b] = curve.parameter.domain();
        curve.parameter.point(0.5 * (a + b))
    };
    let [ends, other] = [a, b].map(|c| c.parameter.ends());
    near(ends[0], other[1])
        && near(ends[1], other[0])
        && !near(ends[0], ends[1])
        && (straight(a) && straight(b) || near(middle(a), middle(b)))
}

/// A loop without the curves that it runs through there and back. On a surface that is closed by itself these are its seams,
/// where curves in space do not say that both sides of the face meet. They lie within the face: the loop that is left runs
/// clockwise where they lie outside of it.
pub(super) fn without_spikes(
    host: &Host,
    curves: Vec<TrimCurve>,
) -> Result<Vec<TrimCurve>, String> {
    if !host.is_round() || !runs_back(host, &curves) {
        return Ok(curves);
    }
    let mut left: VecDeque<TrimCurve> = VecDeque::with_capacity(curves.len());
    let mut spikes = Vec::new();
    for curve in curves {
        match left
            .back()
            .is_some_and(|last| are_opposed(host, last, &curve))
        {
            true => spikes.extend(left.pop_back()),
            false => left.push_back(curve),
        }
    }
    while left.len() > 1 && are_opposed(host, &left[0], &left[left.len() - 1]) {
        spikes.extend(left.pop_front());
        left.pop_back();
    }
    let left = Vec::from(left);
    let Some(spike) = spikes.first().filter(|_| !left.is_empty()) else {
        return Ok(left);
    };
    let [a, b] = spike.parameter.domain();
    let clockwise = !encloses(host, &left, spike.parameter.point(0.5 * (a + b)));
    if clockwise == (signed_area(&left) < 0.0) {
        return Ok(left);
    }
    let turned = left.iter().rev().map(reversed).collect::<Result<_, _>>();
    turned.map_err(|e: CurveError| e.to_string())
}

/// Whether a loop encloses a point in the parameter plane, or the same point some periods away.
fn encloses(host: &Host, curves: &[TrimCurve], xi: Xi) -> bool {
    let corners = polygon(curves);
    let within = |p: Xi| {
        let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
        let crossed = pairs.filter(|(a, b)| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y)
        });
        crossed.count() % 2 == 1
    };
    let periods = |d: usize| if host.closed[d] { -2..=2 } else { 0..=0 };
    let mut copies = periods(0).flat_map(|i| periods(1).map(move |j| [i, j]));
    copies.any(|[i, j]| {
        within(xi + Xi::new(f64::from(i) * host.extent(0), f64::from(j) * host.extent(1)))
    })
}

/// Points along a loop in the parameter plane, several for each span.
fn polygon(curves: &[TrimCurve]) -> Vec<Xi> {
    let mut polygon = Vec::new();
    for curve in curves {
        let basis = curve.parameter.basis();
        let n = 4 * basis.degree();
        for span in 0..basis.span_count() {
            let [a, b] = basis.span_range(span);
            let at = |k: usize| curve.parameter.point(a + (b - a) * (k as f64 / n as f64));
            polygon.extend((0..n).map(at));
        }
    }
    polygon
}

/// Area that a loop bounds in the parameter plane, negative where it runs clockwise, by a polygon.
pub(super) fn signed_area(curves: &[TrimCurve]) -> f64 {
    let polygon = polygon(curves);
    let Some(&origin) = polygon.first() else {
        return 0.0;
    };
    let next = polygon.iter().skip(1).chain(polygon.first());
    let pairs = polygon.iter().zip(next);
    let twice: f64 = pairs.map(|(p, q)| (p - origin).perp(&(q - origin))).sum();
    0.5 * twice
}

/// Whether the first loop, on a surface that is closed by itself (a sphere, a torus), runs so that what lies to its left is
/// all but what it encloses in the parameter plane. (A loop along the seams bounds all of it whichever way it runs.)
pub fn bounds_outside(host: &Host, loops: &[TrimLoop]) -> bool {
    let whole = host.extent(0) * host.extent(1);
    let outside = |l: &TrimLoop| (-0.999 * whole..0.0).contains(&signed_area(&l.curves));
    host.is_round()
        && loops
            .first()
            .is_some_and(|l| outside(l) && !has_seam(host, &l.curves))
}

/// Whether two curves of a loop are the two sides of a seam: a period apart, and run through in opposite directions.
fn has_seam(host: &Host, curves: &[TrimCurve]) -> bool {
    let ends = |c: &TrimCurve| c.parameter.ends();
    let opposed = |a: [Xi; 2], b: [Xi; 2]| {
        (0..2).filter(|&d| host.closed[d]).any(|d| {
            let near = |x: Xi, y: Xi| {
                (0..2).all(|k| {
                    let period = if k == d { host.extent(k) } else { 0.0 };
                    ((x[k] - y[k]).abs() - period).abs() <= GAP * host.extent(k)
                })
            };
            near(a[0], b[1]) && near(a[1], b[0])
        })
    };
    let rest = |k: usize| curves[k + 1..].iter();
    (0..curves.len()).any(|k| rest(k).any(|other| opposed(ends(&curves[k]), ends(other))))
}
