//! Rational B-spline surfaces, entity 128.

use super::super::error::Fail;
use super::Model;
use super::curve_spline::pieces;
use super::directory::Entry;
use super::params::Params;
use super::transform::Affine;
use crate::{NurbsPatch, PatchError, Vec3};

/// The patches of a surface, or why there is none; and how many values its own data took (pointers to properties
/// follow). There are several where a knot inside is repeated more often than the degree, so that the surface is in
/// pieces; those of the first direction run fastest.
pub struct Surface {
    pub patches: Result<Vec<NurbsPatch>, String>,
    pub values: usize,
}

/// Sizes in front of the data: upper indices K of the control points and degrees M, by direction.
struct Header {
    counts: [usize; 2],
    degree: [usize; 2],
    /// PROP1 and PROP2.
    closed: [bool; 2],
    polynomial: bool,
}

/// Values up to the first knot: type, K1, K2, M1, M2, PROP1 to PROP5.
const HEADER: usize = 10;

impl Header {
    fn read(params: &Params) -> Result<Self, Fail> {
        let mut counts = [0; 2];
        let mut degree = [0; 2];
        for d in 0..2 {
            counts[d] = params.count(1 + d, &format!("the upper index K{}", d + 1))?;
            degree[d] = params.count(3 + d, &format!("the degree M{}", d + 1))?;
            // Each index has a knot of its own, so more than there are values cannot be.
            if counts[d] >= params.len() {
                let expected = format!(
                    "an upper index K{} that the {} values of this entity can fill",
                    d + 1,
                    params.len()
                );
                return Err(params.fail(1 + d, expected));
            }
            counts[d] += 1;
            if degree[d] == 0 || degree[d] >= counts[d] {
                let expected = format!("a degree M{} from 1 to K{0} = {}", d + 1, counts[d] - 1);
                return Err(params.fail(3 + d, expected));
            }
        }
        let mut flags = [false; 5];
        for (i, flag) in flags.iter_mut().enumerate() {
            *flag = match params.integer(5 + i, "a property flag")? {
                0 => false,
                1 => true,
                _ => return Err(params.fail(5 + i, format!("0 or 1 for flag PROP{}", i + 1))),
            };
        }
        // PROP4 and PROP5 (periodic) say nothing that the knots do not say.
        Ok(Self {
            counts,
            degree,
            closed: [flags[0], flags[1]],
            polynomial: flags[2],
        })
    }
}

/// Reads an entity 128 and maps its points by `map`. Damaged data is an error; data that is whole but makes no surface
/// is a reason to skip it.
pub fn read(
    model: &Model,
    entry: &Entry,
    map: &Affine,
    notes: &mut Vec<String>,
) -> Result<Surface, Fail> {
    let params = model.params(entry)?;
    let header = Header::read(&params)?;
    let Header { counts, degree, .. } = header;
    let knot_counts = [counts[0] + degree[0] + 1, counts[1] + degree[1] + 1];
    // Cannot overflow: each count is below the number of values, which fit in memory.
    let points = counts[0].saturating_mul(counts[1]);
    let values = points
        .saturating_mul(4)
        .saturating_add(HEADER + knot_counts[0] + knot_counts[1] + 4);
    if params.len() < values {
        let expected = format!(
            "{values} values for {} x {} control points of degree {} x {}",
            counts[0], counts[1], degree[0], degree[1]
        );
        return Err(params.fail(params.len(), expected));
    }
    let mut at = HEADER;
    let mut take = |count: usize, what: &str| {
        at += count;
        params.reals(at - count, count, what)
    };
    let mut note = |text: String| notes.push(format!("entity {} (128): {text}", entry.number));
    let mut knots = [
        take(knot_counts[0], "a knot of the first direction")?,
        take(knot_counts[1], "a knot of the second direction")?,
    ];
    let weights = take(points, "a weight")?;
    let coordinates = take(3 * points, "a coordinate of a control point")?;
    let range = take(4, "a limit of the parameter range U0, U1, V0, V1")?;

    let scale = model.global.scale;
    let net: Vec<Vec3> = coordinates
        .chunks_exact(3)
        .map(|c| map.apply(Vec3::new(c[0], c[1], c[2])) / scale)
        .collect();
    let rational = weights.iter().any(|&w| w != weights[0]) || weights[0] <= 0.0;
    if rational && header.polynomial {
        note(
            "the flag PROP3 says polynomial, but the weights differ; the weights count".to_owned(),
        );
    }
    for (d, knots) in knots.iter_mut().enumerate() {
        let moved = merge_close(knots);
        if moved > 0 {
            note(format!(
                "direction {}: {moved} knots moved onto their neighbour",
                d + 1
            ));
        }
    }
    let resolution = model.global.resolution.unwrap_or(0.0) / scale;
    let mut net = Net {
        counts,
        knots,
        points: net,
        weights: if rational { weights } else { Vec::new() },
    };
    let joined: usize = (0..2).map(|d| net.join(d, degree[d], resolution)).sum();
    if joined > 0 {
        note(format!(
            "{joined} knot(s) repeated more often than the degree, with equal points on both sides: the surface goes on there"
        ));
    }
    let Net {
        counts,
        knots,
        points: net,
        weights,
    } = net;
    let weights = rational.then_some(&weights[..]);
    let whole = match in_pieces(degree, &knots, counts, &net, weights) {
        Ok(pieces) => pieces,
        Err(e) => {
            return Ok(Surface {
                patches: Err(e.to_string()),
                values,
            });
        }
    };
    if whole.len() > 1 {
        note(format!(
            "knots repeated more often than the degree: read as {} patches",
            whole.len()
        ));
    }
    let full = [0, 1].map(|d| [knots[d][degree[d]], knots[d][counts[d]]]);
    let domain = match allowed_range(full, &knots, &range, &mut note) {
        Ok(domain) => domain,
        Err(reason) => {
            return Ok(Surface {
                patches: Err(reason),
                values,
            });
        }
    };
    let single = whole.len() == 1;
    let mut patches = Vec::with_capacity(whole.len());
    for patch in whole {
        match cut(patch, domain) {
            Some(Ok(patch)) => patches.push(patch),
            // Outside of the range.
            None => {}
            Some(Err(e)) => {
                return Ok(Surface {
                    patches: Err(e.to_string()),
                    values,
                });
            }
        }
    }
    if let ([patch], true) = (&patches[..], single) {
        check_closed(patch, header.closed, model.global.resolution, &mut note);
    }
    Ok(Surface {
        patches: Ok(patches),
        values,
    })
}

/// Control points of a surface, those of the first direction fastest.
struct Net {
    counts: [usize; 2],
    knots: [Vec<f64>; 2],
    points: Vec<Vec3>,
    /// Empty where all are equal.
    weights: Vec<f64>,
}

impl Net {
    /// Joins the surface at knots inside that are repeated more often than the degree, if the points on both sides are equal
    /// (to rounding, or to the resolution where that is finer than a millionth of the size): some systems write all splines
    /// as a row of Bezier pieces. Returns at how many knots.
    fn join(&mut self, dir: usize, degree: usize, resolution: f64) -> usize {
        let count = self.counts[dir];
        if degree == 0 || self.knots[dir].len() != count + degree + 1 {
            return 0;
        }
        let low = self
            .points
            .iter()
            .fold(Vec3::repeat(f64::INFINITY), |a, b| a.inf(b));
        let high = self
            .points
            .iter()
            .fold(Vec3::repeat(f64::NEG_INFINITY), |a, b| a.sup(b));
        let size = (high - low).norm();
        let slack = (1e-9 * size).max(resolution.min(1e-6 * size));
        let across = self.counts[1 - dir];
        let place = |i: usize, line: usize, counts: [usize; 2]| match dir {
            0 => i + counts[0] * line,
            _ => line + counts[0] * i,
        };
        let weight = |k: usize| self.weights.get(k).copied().unwrap_or(1.0);
        let same = |i: usize, j: usize| {
            (0..across).all(|line| {
                let (a, b) = (place(i, line, self.counts), place(j, line, self.counts));
                let (v, w) = (weight(a), weight(b));
                (self.points[a] - self.points[b]).norm() <= slack
                    && (v - w).abs() <= 1e-9 * v.abs().max(w.abs())
            })
        };
        let ranges = pieces(degree, &self.knots[dir], count);
        let mut dropped = vec![false; count];
        let mut joined = 0;
        for pair in ranges.windows(2) {
            let (last, next) = (pair[0].end - 1, pair[1].start);
            if same(last, next) {
                dropped[last + 1..=next].iter_mut().for_each(|d| *d = true);
                joined += 1;
            }
        }
        if joined == 0 {
            return 0;
        }
        let kept: Vec<usize> = (0..count).filter(|&i| !dropped[i]).collect();
        let mut counts = self.counts;
        counts[dir] = kept.len();
        let mut order = vec![0; kept.len() * across];
        for (new, &old) in kept.iter().enumerate() {
            for line in 0..across {
                order[place(new, line, counts)] = place(old, line, self.counts);
            }
        }
        self.points = order.iter().map(|&k| self.points[k]).collect();
        if !self.weights.is_empty() {
            self.weights = order.iter().map(|&k| self.weights[k]).collect();
        }
        // A point that goes takes one of the knots of its place with it: that of its own number is one of them.
        let knots = std::mem::take(&mut self.knots[dir]);
        let left = knots.into_iter().enumerate();
        let left = left.filter(|(k, _)| !dropped.get(*k).copied().unwrap_or(false));
        self.knots[dir] = left.map(|(_, t)| t).collect();
        self.counts = counts;
        joined
    }
}

/// The patches into which a net falls at knots that are repeated `degree + 1` times or more.
fn in_pieces(
    degree: [usize; 2],
    knots: &[Vec<f64>; 2],
    counts: [usize; 2],
    net: &[Vec3],
    weights: Option<&[f64]>,
) -> Result<Vec<NurbsPatch>, PatchError> {
    let ranges = [0, 1].map(|d| {
        if degree[d] == 0 || knots[d].len() != counts[d] + degree[d] + 1 {
            std::iter::once(0..counts[d]).collect()
        } else {
            pieces(degree[d], &knots[d], counts[d])
        }
    });
    if ranges.iter().all(|r| r.len() == 1) {
        let patch = NurbsPatch::new(degree, knots.clone(), counts, net, weights)?;
        return Ok(vec![patch]);
    }
    let mut patches = Vec::new();
    for rows in &ranges[1] {
        for columns in &ranges[0] {
            let part = [columns, rows];
            let own = [0, 1].map(|d| knots[d][part[d].start..part[d].end + degree[d] + 1].to_vec());
            let indices = || {
                rows.clone()
                    .flat_map(|j| columns.clone().map(move |i| i + counts[0] * j))
            };
            let points: Vec<Vec3> = indices().map(|k| net[k]).collect();
            let weights: Option<Vec<f64>> = weights.map(|w| indices().map(|k| w[k]).collect());
            let sizes = [columns.len(), rows.len()];
            patches.push(NurbsPatch::new(
                degree,
                own,
                sizes,
                &points,
                weights.as_deref(),
            )?);
        }
    }
    Ok(patches)
}

/// The part of a patch inside of `domain`, `None` where there is none.
fn cut(patch: NurbsPatch, domain: [[f64; 2]; 2]) -> Option<Result<NurbsPatch, PatchError>> {
    let own = patch.domain();
    let part = [0, 1].map(|d| [own[d][0].max(domain[d][0]), own[d][1].min(domain[d][1])]);
    if part.iter().any(|[a, b]| a >= b) {
        None
    } else if part == own {
        Some(Ok(patch))
    } else {
        Some(patch.with_domain(part))
    }
}

/// Knots that rounding has set apart: differences up to 1e-9 of the whole range, of either sign, are closed. Writers
/// print as few as 9 digits; a span of that size has no extent in space but spoils derivatives.
pub fn merge_close(knots: &mut [f64]) -> usize {
    let range = knots.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b))
        - knots.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let mut moved = 0;
    for i in 1..knots.len() {
        let step = knots[i] - knots[i - 1];
        if step != 0.0 && step.abs() <= 1e-9 * range {
            knots[i] = knots[i - 1];
            moved += 1;
        }
    }
    moved
}

/// The part of the knots' range that the parameter range U0, U1, V0, V1 of the file leaves.
fn allowed_range(
    full: [[f64; 2]; 2],
    knots: &[Vec<f64>; 2],
    range: &[f64],
    note: &mut impl FnMut(String),
) -> Result<[[f64; 2]; 2], String> {
    let mut domain = full;
    for d in 0..2 {
        let [start, end] = full[d];
        let (mut from, mut to) = (range[2 * d], range[2 * d + 1]);
        let name = ["U", "V"][d];
        // Ten times what `with_domain` moves by itself, so that rounding in nine digits passes without a note.
        let slack = 1e-8 * (end - start);
        if from == to {
            note(format!(
                "the parameter range {name}0, {name}1 is empty; the knots' range was used"
            ));
            continue;
        }
        if from > to {
            return Err(format!(
                "the parameter range {name}0 = {from}, {name}1 = {to} runs backwards"
            ));
        }
        if to <= start || from >= end {
            return Err(format!(
                "the parameter range {name} = {from} to {to} lies outside of the knots' range {start} to {end}"
            ));
        }
        if from < start - slack || to > end + slack {
            note(format!(
                "the parameter range {name} = {from} to {to} exceeds the knots' range {start} to {end}, where the \
                 surface ends"
            ));
        }
        if (from - start).abs() <= slack || from < start {
            from = start;
        }
        if (to - end).abs() <= slack || to > end {
            to = end;
        }
        // A cut beside a knot, by rounding, would leave a span of no extent.
        for cut in [&mut from, &mut to] {
            if let Some(&knot) = knots[d]
                .iter()
                .find(|&&t| (t - *cut).abs() <= 1e-9 * (end - start))
            {
                *cut = knot;
            }
        }
        if from > start || to < end {
            note(format!(
                "cut to {name} = {from} to {to} of the knots' range {start} to {end}"
            ));
        }
        domain[d] = [from, to];
    }
    Ok(domain)
}

/// Notes a direction that is flagged closed while its two edges lie apart.
fn check_closed(
    patch: &NurbsPatch,
    closed: [bool; 2],
    resolution: Option<f64>,
    note: &mut impl FnMut(String),
) {
    let domain = patch.domain();
    let [low, high] = patch.bounds();
    let slack = resolution.unwrap_or(0.0).max(1e-6 * (high - low).norm());
    for d in (0..2).filter(|&d| closed[d]) {
        let gap = (0..=4)
            .map(|k| {
                let [from, to] = domain[1 - d];
                let across = from + (to - from) * f64::from(k) / 4.0;
                let at = |along: f64| {
                    patch.point(if d == 0 {
                        [along, across]
                    } else {
                        [across, along]
                    })
                };
                (at(domain[d][0]) - at(domain[d][1])).norm()
            })
            .fold(0.0, f64::max);
        if gap > slack {
            note(format!(
                "flagged closed in direction {}, but the two edges lie up to {gap:.3e} apart",
                d + 1
            ));
        }
    }
}
