//! Closed loops of parameter curves from the boundaries of a face: loops that go round a closed surface are joined to one
//! another or to its border.

use super::curves::{Tally, curves};
use super::enclosed::{signed_area, without_spikes};
use super::face::Boundary;
use super::host::{Host, Xi};
use super::spikes::without_ends;
use super::unroll::{Chain, chain_of_area};
use crate::NurbsCurve;
use crate::curve::CurveError;
use crate::trim::{TrimCurve, TrimLoop};

/// Gaps between curves up to this share of the domain are closed by moving ends.
pub const GAP: f64 = 1e-3;

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

pub(super) fn line(from: Xi, to: Xi) -> Result<TrimCurve, String> {
    Ok(TrimCurve {
        parameter: NurbsCurve::line(from, to).map_err(|e| e.to_string())?,
        space: None,
        entity: 0,
    })
}

pub(super) fn start(curve: &TrimCurve) -> Xi {
    curve.parameter.ends()[0]
}

pub(super) fn end(curve: &TrimCurve) -> Xi {
    curve.parameter.ends()[1]
}

pub(super) fn shifted(curve: TrimCurve, by: Xi) -> Result<TrimCurve, CurveError> {
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
