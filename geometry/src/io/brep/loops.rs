//! Closed loops of parameter curves from the boundaries of a face: curves moved by periods to follow each other, poles
//! bridged, loops that go round a closed surface joined to one another or to its border.

use super::curves::{Tally, curves};
use super::enclosed::{runs_back, signed_area, without_spikes};
use super::face::Boundary;
use super::host::{Host, Xi};
use super::spikes::without_ends;
use crate::NurbsCurve;
use crate::curve::CurveError;
use crate::trim::{TrimCurve, TrimLoop};

/// Gaps between curves up to this share of the domain are closed by moving ends.
pub const GAP: f64 = 1e-3;

/// A chain of curves, and how many periods it ends from where it began.
struct Chain {
    curves: Vec<TrimCurve>,
    turns: [i32; 2],
    /// Gaps (lengths in space) between curves that are one in the file's tolerance only.
    gaps: Vec<f64>,
}

/// The loops of a face. `outer_first` orders them so that the first is the one that bounds most.
pub fn loops(
    host: &Host,
    boundaries: &[Boundary],
    outer_first: bool,
    tally: &mut Tally,
    complaints: &mut Vec<String>,
) -> Result<Vec<TrimLoop>, String> {
    let mut closed = Vec::new();
    let mut winding = Vec::new();
    for boundary in boundaries {
        let named = |reason: String| format!("{}: {reason}", boundary.name);
        let mut found = Vec::new();
        let mut said = Vec::new();
        for stretch in &boundary.stretches {
            found.push(curves(host, stretch, tally, &mut said).map_err(named)?);
        }
        complaints.extend(said.into_iter().map(named));
        let chain = chain_of_area(host, found).map_err(named)?;
        tally.bridged += chain.gaps.len();
        tally.largest_bridge = (chain.gaps.iter()).fold(tally.largest_bridge, |a, &b| a.max(b));
        if chain.turns == [0, 0] {
            let curves = without_spikes(host, chain.curves).map_err(named)?;
            // What was a seam and nothing else leaves the whole surface.
            if !curves.is_empty() {
                let (curves, cut) = without_ends(host, curves).map_err(named)?;
                if cut > 0.0 {
                    complaints.push(named(format!(
                        "its boundary runs there and back over a length of {cut:.1e}, which bounds nothing and was cut off"
                    )));
                }
                closed.push(curves);
            }
        } else {
            winding.push(chain);
        }
    }
    if !winding.is_empty() {
        closed.insert(0, joined(host, winding)?);
    }
    if outer_first {
        let area = |curves: &Vec<TrimCurve>| signed_area(curves).abs();
        if let Some(first) =
            (0..closed.len()).max_by(|&a, &b| area(&closed[a]).total_cmp(&area(&closed[b])))
        {
            closed.swap(0, first);
        }
    }
    Ok(closed
        .into_iter()
        .map(|curves| TrimLoop { curves })
        .collect())
}

fn line(from: Xi, to: Xi) -> Result<TrimCurve, String> {
    Ok(TrimCurve {
        parameter: NurbsCurve::line(from, to).map_err(|e| e.to_string())?,
        space: None,
        entity: 0,
    })
}

fn start(curve: &TrimCurve) -> Xi {
    curve.parameter.ends()[0]
}

fn end(curve: &TrimCurve) -> Xi {
    curve.parameter.ends()[1]
}

fn shifted(curve: TrimCurve, by: Xi) -> Result<TrimCurve, CurveError> {
    if by == Xi::zeros() {
        return Ok(curve);
    }
    Ok(TrimCurve {
        parameter: curve.parameter.transformed(&|x| x + by)?,
        ..curve
    })
}

pub(super) fn reversed(curve: &TrimCurve) -> Result<TrimCurve, CurveError> {
    Ok(TrimCurve {
        parameter: curve.parameter.reversed()?,
        space: curve.space.as_ref().map(NurbsCurve::reversed).transpose()?,
        entity: curve.entity,
    })
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

/// One chain of all stretches. At a pole the turning parameter of the next curve is any: of the chains that go on a period
/// apart from each other there, the one that closes in the parameter plane and bounds an area is meant. (A boundary is a
/// closed curve of that plane. Space curves alone do not say which way round a pole they go on, and a chain that took the
/// shorter way may go round the closed surface, or back along the same side of a seam.) A chain that runs back along one of
/// its own curves is meant only if no other bounds an area: a seam is two lines of that plane.
fn chain_of_area(host: &Host, stretches: Vec<Vec<TrimCurve>>) -> Result<Chain, String> {
    let stretches = directed(host, stretches)?;
    let whole = host.extent(0) * host.extent(1);
    let bounds =
        |chain: &Chain| chain.turns == [0, 0] && signed_area(&chain.curves).abs() > 1e-9 * whole;
    let plain = |chain: &Chain| !runs_back(host, &chain.curves) && within_period(host, chain);
    let mut chains = Vec::with_capacity(5);
    for turns in [0.0, 1.0, -1.0, 2.0, -2.0] {
        let made = chain(host, &stretches, turns)?;
        if bounds(&made) && plain(&made) {
            return Ok(made);
        }
        chains.push(made);
    }
    let best = chains.iter().position(bounds).unwrap_or(0);
    Ok(chains.swap_remove(best))
}

/// Whether a chain spans no more than one period of a closed surface.
fn within_period(host: &Host, chain: &Chain) -> bool {
    (0..2).filter(|&d| host.closed[d]).all(|d| {
        let ends = chain.curves.iter().flat_map(|c| c.parameter.ends());
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), xi| {
            (a.min(xi[d]), b.max(xi[d]))
        });
        high - low <= (1.0 + GAP) * host.extent(d)
    })
}

/// The chain that goes on `turns` periods away after the first pole.
fn chain(host: &Host, stretches: &[Vec<TrimCurve>], turns: f64) -> Result<Chain, String> {
    let mut out: Vec<TrimCurve> = Vec::new();
    let mut gaps = Vec::new();
    let mut left = turns;
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
            by[d] = left * host.extent(d);
            left = 0.0;
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

/// The widest gap between curves that follow each other, as a share of the domain.
pub fn widest_gap(host: &Host, loops: &[TrimLoop]) -> f64 {
    let share = |from: Xi, to: Xi| {
        let shares = (0..2).map(|d| (to[d] - from[d]).abs() / host.extent(d));
        shares.fold(0.0, f64::max)
    };
    let gaps = loops.iter().flat_map(|l| {
        let next = l.curves.iter().cycle().skip(1);
        l.curves.iter().zip(next)
    });
    gaps.map(|(a, b)| share(end(a), start(b)))
        .fold(0.0, f64::max)
}

/// Loops that go round a closed surface bound it together: two are joined by two lines across, one is joined to the border
/// on its left (boundaries run so that the face lies to their left).
fn joined(host: &Host, mut winding: Vec<Chain>) -> Result<Vec<TrimCurve>, String> {
    let round =
        |chain: &Chain| (0..2).find(|&d| chain.turns[d].abs() == 1 && chain.turns[1 - d] == 0);
    let cannot =
        || "loops go round the closed surface in a way that bounds no part of it".to_owned();
    let first = winding.remove(0);
    let dir = round(&first).ok_or_else(cannot)?;
    let turn = first.turns[dir];
    let mut period = Xi::zeros();
    period[dir] = host.extent(dir) * f64::from(turn);
    let from = start(&first.curves[0]);
    let mut out = first.curves;
    match (winding.pop(), winding.is_empty()) {
        (None, _) => {
            // To the left of increasing xi1 lies increasing xi2, to the left of increasing xi2 decreasing xi1.
            let upper = (turn > 0) == (dir == 0);
            let mut border = from;
            border[1 - dir] = host.domain[1 - dir][usize::from(upper)];
            if host.closed[1 - dir] {
                return Err(cannot());
            }
            out.push(line(from + period, border + period)?);
            out.push(line(border + period, border)?);
            out.push(line(border, from)?);
        }
        (Some(second), true) => {
            if round(&second) != Some(dir) {
                return Err(cannot());
            }
            let opposed = second.turns[dir] == -turn;
            let mut curves = match opposed {
                true => second.curves,
                false => second
                    .curves
                    .iter()
                    .rev()
                    .map(reversed)
                    .collect::<Result<_, _>>()
                    .map_err(|e: CurveError| e.to_string())?,
            };
            curves = from_where(host, curves, dir, from[dir]).map_err(|e| e.to_string())?;
            // Starts where the first loop ends, and runs back by a period.
            let begin = start(&curves[0]);
            let mut by = host.nearest_copy(begin, from + period) - begin;
            if !host.closed[1 - dir] {
                by[1 - dir] = 0.0;
            } else if opposed {
                // Closed both ways: of the two parts between the loops the face is the one to the left of the first.
                let upper = (turn > 0) == (dir == 0);
                let period = host.extent(1 - dir) * if upper { 1.0 } else { -1.0 };
                let ahead = (begin[1 - dir] - from[1 - dir]) / period;
                by[1 - dir] = -(ahead - 1e-9).floor() * period;
            }
            let curves = curves
                .into_iter()
                .map(|c| shifted(c, by))
                .collect::<Result<Vec<_>, _>>()
                .map_err(|e| e.to_string())?;
            out.push(line(from + period, start(&curves[0]))?);
            let last = end(&curves[curves.len() - 1]);
            out.extend(curves);
            out.push(line(last, from)?);
        }
        _ => return Err(cannot()),
    }
    Ok(out)
}

/// The curves of a loop that goes round, begun where parameter `dir` is a whole number of periods from `value`.
fn from_where(
    host: &Host,
    curves: Vec<TrimCurve>,
    dir: usize,
    value: f64,
) -> Result<Vec<TrimCurve>, CurveError> {
    let period = host.extent(dir);
    let turns = |x: f64| (x - value) / period;
    let near = |x: f64| (turns(x) - turns(x).round()).abs() < 1e-9;
    for (k, curve) in curves.iter().enumerate() {
        let [a, b] = curve.parameter.domain();
        let at = |t: f64| turns(curve.parameter.point(t)[dir]);
        let (from, to) = (at(a), at(b));
        if near(start(curve)[dir]) {
            return Ok(rotated(host, curves, k, None));
        }
        let target = if to > from { from.ceil() } else { from.floor() };
        if (target - from) * (target - to) >= 0.0 {
            continue;
        }
        let (mut low, mut high) = (a, b);
        for _ in 0..100 {
            let t = 0.5 * (low + high);
            if (at(t) < target) == (from < target) {
                low = t;
            } else {
                high = t;
            }
        }
        if low <= a || high >= b {
            continue;
        }
        let part = |domain| -> Result<TrimCurve, CurveError> {
            Ok(TrimCurve {
                parameter: curve.parameter.with_domain(domain)?,
                space: None,
                entity: curve.entity,
            })
        };
        let halves = [part([a, low])?, part([low, b])?];
        return Ok(rotated(host, curves, k, Some(halves)));
    }
    Ok(curves)
}

/// The loop begun at curve `k`, or at the second half of that curve.
fn rotated(
    host: &Host,
    mut curves: Vec<TrimCurve>,
    k: usize,
    halves: Option<[TrimCurve; 2]>,
) -> Vec<TrimCurve> {
    let mut k = k;
    if let Some([first, second]) = halves {
        curves[k] = first;
        curves.insert(k + 1, second);
        k += 1;
    }
    curves.rotate_left(k);
    // What stood in front of it now follows, a period on.
    let mut out: Vec<TrimCurve> = Vec::with_capacity(curves.len());
    for curve in curves {
        let moved = out.last().map(end).map(|last| {
            let from = start(&curve);
            host.nearest_copy(from, last) - from
        });
        match moved {
            Some(by) => match shifted(curve.clone(), by) {
                Ok(curve) => out.push(curve),
                Err(_) => out.push(curve),
            },
            None => out.push(curve),
        }
    }
    out
}
