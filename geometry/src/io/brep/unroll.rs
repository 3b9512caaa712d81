//! Chains of curves in the parameter plane of a closed surface: curves moved by periods to follow each other, poles bridged.

use super::curves::bounds_of;
use super::enclosed::{runs_back, signed_area};
use super::host::{Host, Xi};
use super::loops::{GAP, end, line, reversed, shifted, start};
use crate::curve::CurveError;
use crate::trim::TrimCurve;

/// A chain of curves, and how many periods it ends from where it began.
pub(super) struct Chain {
    pub curves: Vec<TrimCurve>,
    pub turns: [i32; 2],
    /// Gaps (lengths in space) between curves that are one in the file's tolerance only.
    pub gaps: Vec<f64>,
    /// Poles of a closed surface that it passes between two of its curves.
    passages: usize,
}

/// Whether the stretches follow each other in space, and round to the first.
fn follows(host: &Host, stretches: &[Vec<TrimCurve>]) -> bool {
    let n = stretches.len();
    (0..n).all(|k| {
        let (Some(last), Some(first)) = (stretches[k].last(), stretches[(k + 1) % n].first())
        else {
            return true;
        };
        (host.point(end(last)) - host.point(start(first))).norm() <= joint(host)
    })
}

/// Ends of curves this near to each other in space are one point.
fn joint(host: &Host) -> f64 {
    (10.0 * host.agree).max(host.bridged)
}

/// Turns stretches round where their flags do not make them follow each other.
fn directed(host: &Host, stretches: Vec<Vec<TrimCurve>>) -> Result<Vec<Vec<TrimCurve>>, String> {
    if follows(host, &stretches) {
        return Ok(stretches);
    }
    let turn = |s: &Vec<TrimCurve>| -> Result<Vec<TrimCurve>, String> {
        let turned = s.iter().rev().map(reversed).collect::<Result<_, _>>();
        turned.map_err(|e: CurveError| e.to_string())
    };
    for first in [stretches[0].clone(), turn(&stretches[0])?] {
        let mut out = vec![first];
        for next in &stretches[1..] {
            let last = out[out.len() - 1].last().map(|c| host.point(end(c)));
            let (Some(last), Some(a), Some(b)) = (last, next.first(), next.last()) else {
                out.push(next.clone());
                continue;
            };
            let to = |xi: Xi| (host.point(xi) - last).norm();
            match to(start(a)) <= to(end(b)) {
                true => out.push(next.clone()),
                false => out.push(turn(next)?),
            }
        }
        if follows(host, &out) {
            return Ok(out);
        }
    }
    // Left as it is; the gap is named where the chain is made.
    Ok(stretches)
}

/// One chain of all stretches. At a pole the turning parameter of the next curve is any: of the chains that go on whole periods
/// apart from each other there, the one that closes in the parameter plane and bounds an area is meant. (A boundary is a
/// closed curve of that plane. Space curves alone do not say which way round a pole they go on, and a chain that took the
/// shorter way may go round the closed surface, or back along the same side of a seam.) A chain that runs back along one of
/// its own curves, or spans more than a period, is meant only if no other bounds an area: a seam is two lines of that plane.
pub(super) fn chain_of_area(host: &Host, stretches: Vec<Vec<TrimCurve>>) -> Result<Chain, String> {
    let stretches = directed(host, stretches)?;
    let whole = host.extent(0) * host.extent(1);
    let bounds =
        |chain: &Chain| chain.turns == [0, 0] && signed_area(&chain.curves).abs() > 1e-9 * whole;
    let plain = |chain: &Chain| !runs_back(host, &chain.curves) && within_period(host, chain);
    let first = chain(host, &stretches, &[])?;
    let choices = ways(first.passages);
    if choices.is_empty() || bounds(&first) && plain(&first) {
        return Ok(first);
    }
    let mut best = None;
    for turns in &choices {
        let curves = stretches.iter().map(Vec::len).sum::<usize>() as u64;
        host.grant.work(curves * CURVE * host.evaluation())?;
        let made = chain(host, &stretches, turns)?;
        if bounds(&made) && plain(&made) {
            return Ok(made);
        }
        if best.is_none() && bounds(&made) {
            best = Some(made);
        }
    }
    Ok(match bounds(&first) {
        true => first,
        false => best.unwrap_or(first),
    })
}

/// Cost, in evaluations, of adding a curve to a chain.
const CURVE: u64 = 10;
/// Poles passed by a boundary at which other ways to go on are tried.
const PASSAGES: usize = 3;

/// The periods by which a chain may go on elsewhere at each of `passages` poles, few and small ones first. None where it
/// passes no pole.
fn ways(passages: usize) -> Vec<Vec<f64>> {
    let n = passages.min(PASSAGES) as u32;
    let steps = [0.0, 1.0, -1.0, 2.0, -2.0];
    let way = |k: usize| -> Vec<f64> { (0..n).map(|i| steps[k / 5usize.pow(i) % 5]).collect() };
    let mut ways: Vec<_> = (1..5usize.pow(n)).map(way).collect();
    let length = |way: &[f64]| way.iter().map(|t| t.abs()).sum::<f64>();
    ways.sort_by(|a, b| length(a).total_cmp(&length(b)));
    ways
}

/// Whether a chain spans no more than one period of a closed surface.
fn within_period(host: &Host, chain: &Chain) -> bool {
    let bounds = bounds_of(chain.curves.iter().map(|c| &c.parameter));
    (0..2).filter(|&d| host.closed[d]).all(|d| {
        let [low, high] = bounds[d];
        high - low <= (1.0 + GAP) * host.extent(d)
    })
}

/// The chain that goes on `turns` periods away after each pole that it passes (after the last of them none).
fn chain(host: &Host, stretches: &[Vec<TrimCurve>], turns: &[f64]) -> Result<Chain, String> {
    let mut out: Vec<TrimCurve> = Vec::new();
    let mut gaps = Vec::new();
    let mut passages = 0;
    let at_pole = |xi: Xi| {
        let stuck = host.stuck(xi);
        [0, 1].map(|d| stuck[d] && host.closed[d])
    };
    for curve in stretches.iter().flatten() {
        let curve = curve.clone();
        let Some(last) = out.last().map(end) else {
            out.push(curve);
            continue;
        };
        let from = start(&curve);
        let mut by = host.nearest_copy(from, last) - from;
        let pole = at_pole(last);
        for d in (0..2).filter(|&d| pole[d]) {
            // What the file says counts; periods make no difference to the point.
            by[d] = turns.get(passages).unwrap_or(&0.0) * host.extent(d);
            passages += 1;
        }
        let curve = shifted(curve, by).map_err(|e| e.to_string())?;
        gaps.extend(bridge(host, &mut out, last, start(&curve))?);
        out.push(curve);
    }
    let (Some(first), Some(last)) = (out.first().map(start), out.last().map(end)) else {
        return Err("has no curves".to_owned());
    };
    // Where the first curve begins, in the copy that the last one reaches.
    let mut target = host.nearest_copy(first, last);
    let pole = at_pole(last);
    for d in (0..2).filter(|&d| pole[d]) {
        target[d] = first[d];
    }
    gaps.extend(bridge(host, &mut out, last, target)?);
    let turns = [0, 1].map(|d| ((target[d] - first[d]) / host.extent(d)).round() as i32);
    Ok(Chain {
        curves: out,
        turns,
        gaps,
        passages,
    })
}

/// Adds a straight line from `from` to `to` where they are one point in space (a pole) but not in the parameter plane.
/// Returns the length of a gap in space that is left to be closed by moving ends.
fn bridge(host: &Host, out: &mut Vec<TrimCurve>, from: Xi, to: Xi) -> Result<Option<f64>, String> {
    let share = (0..2)
        .map(|d| (to[d] - from[d]).abs() / host.extent(d))
        .fold(0.0, f64::max);
    if share <= 1e-9 {
        return Ok(None);
    }
    let start = host.point(from);
    let away = (1..=8)
        .map(|k| (host.point(from.lerp(&to, f64::from(k) / 8.0)) - start).norm())
        .fold(0.0, f64::max);
    if away.is_nan() || away > joint(host) {
        return Err(format!(
            "is open: a gap of {away:.1e} in space, {share:.1e} of the domain of the surface"
        ));
    }
    // A line across a gap would be an edge that no neighbour has.
    if away > 10.0 * host.agree {
        return Ok(Some(away));
    }
    // Small gaps are closed where the trim is made, without a curve of their own.
    if share > GAP {
        out.push(line(from, to)?);
    }
    Ok(None)
}
