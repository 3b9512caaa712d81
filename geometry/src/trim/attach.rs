//! From the loops of a file to a trimmed patch.

use super::{Trim, TrimCurve, TrimError, TrimLoop};
use crate::basis::{Basis, WIDTH};
use crate::curve::NurbsCurve;
use crate::patch::NurbsPatch;
use nalgebra::{Matrix2, Vector2};

/// Sides of an outer loop that lie this close (a share of the domain) to a rectangle make it one, and sides of the
/// rectangle this close to the border of the domain are the border.
const RECTANGLE: f64 = 1e-7;
/// Sides of a rectangle this near to a knot, as a share of the domain, lie on it.
const BESIDE: f64 = 1e-9;
/// Loops may leave the domain by this much (a share of it); the surface is continued there.
const BEYOND: f64 = 1e-6;
/// A polygon with less than this share of the area of the square on its diagonal has none.
const NO_AREA: f64 = 1e-10;
/// Polygons by which areas and crossings are found lie this near to their loops, as a share of the domain.
const FLAT: f64 = 1e-5;
/// The most points of such a polygon beside those at which pieces begin: 130 kB. The same circle a hundred times in a loop would
/// have ten times as many.
const MOST: usize = 8_000;

/// What was noticed about a loop.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TrimNoteKind {
    /// A gap (a share of the domain) after the curve with this number was closed.
    Gap(usize, f64),
    /// The loop has no area and was left out.
    ZeroArea,
    /// The loop crosses itself; points count as inside by the even-odd rule.
    SelfIntersecting,
    /// A hole that lies outside of the domain and was left out.
    Outside,
    /// The outer loop is a rectangle of parameters: the domain of the patch was narrowed to it.
    Rectangle([[f64; 2]; 2]),
    /// The loop was moved by whole periods of a closed surface.
    Shifted([i32; 2]),
    /// The seam of a closed surface was moved: the domain in direction `.0` begins at `.1` now.
    Seam(usize, f64),
}

/// Something noticed about a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimNote {
    /// Number of the loop, as given.
    pub loop_number: usize,
    /// What it is.
    pub kind: TrimNoteKind,
}

/// A patch with its loops.
#[derive(Debug, Clone)]
pub struct Trimmed {
    /// The patch, with a narrower domain, a moved seam or a trim.
    pub patch: NurbsPatch,
    /// What was noticed.
    pub notes: Vec<TrimNote>,
}

/// A loop on its way: its number in the file, and its own trim for tests.
struct Item {
    number: usize,
    trim: Trim,
}

impl NurbsPatch {
    /// The patch bounded by loops of parameter curves. With `has_outer` the first loop is the outer one, else the border of
    /// the domain is. Gaps up to `gap_allowed` (a share of the domain) are closed.
    ///
    /// An outer loop that is an axis-parallel rectangle (to 1e-7 of the domain) becomes a narrower domain, so the patch
    /// is not trimmed where there are no holes. Where the surface is closed in a direction, loops that leave its domain are
    /// moved by whole periods, and the seam of the surface is moved where one crosses it. A trim that the patch has is
    /// replaced.
    ///
    /// # Errors
    /// Open or empty loops; an outer loop without area; loops that leave the domain by more than 1e-6 of it and cannot be
    /// moved. The number is that of the loop.
    pub fn trimmed_by(
        &self,
        loops: Vec<TrimLoop>,
        has_outer: bool,
        gap_allowed: f64,
    ) -> Result<Trimmed, TrimError> {
        let mut patch = self.clone().with_trim(None);
        let mut notes = Vec::new();
        let mut note = |loop_number: usize, kind| notes.push(TrimNote { loop_number, kind });
        let extent = patch.domain().map(|[a, b]| b - a);
        let mut items = Vec::new();
        for (number, a_loop) in loops.into_iter().enumerate() {
            let trim = Trim::new(vec![a_loop], patch.domain(), gap_allowed)
                .map_err(|e| renumber(e, number))?;
            for gap in trim.gaps() {
                note(number, TrimNoteKind::Gap(gap.curve, gap.width));
            }
            let polygon = trim.polygons_within(FLAT, MOST).swap_remove(0);
            if area(&polygon, extent) < NO_AREA && !crosses_itself(&polygon) {
                if has_outer && number == 0 {
                    return Err(TrimError::ZeroArea(number));
                }
                note(number, TrimNoteKind::ZeroArea);
                continue;
            }
            if crosses_itself(&polygon) {
                note(number, TrimNoteKind::SelfIntersecting);
            }
            items.push(Item { number, trim });
        }
        for dir in 0..2 {
            patch = into_domain(patch, dir, &mut items, &mut note)?;
        }
        let mut outer = has_outer;
        if has_outer
            && let Some(first) = items.first()
            && let Some(rectangle) = rectangle(&first.trim, patch.domain())
        {
            let rectangle = on_knots(rectangle, &patch);
            if rectangle != patch.domain() {
                patch = patch
                    .with_domain(rectangle)
                    .map_err(|_| TrimError::Beyond(first.number, RECTANGLE))?;
                note(first.number, TrimNoteKind::Rectangle(rectangle));
            }
            items.remove(0);
            outer = false;
        }
        let domain = patch.domain();
        let mut kept = Vec::new();
        for (place, item) in items.into_iter().enumerate() {
            let bounds = item.trim.bounds();
            let is_outer = outer && place == 0;
            let outside =
                (0..2).any(|k| bounds[k][1] <= domain[k][0] || bounds[k][0] >= domain[k][1]);
            if outside && !is_outer {
                note(item.number, TrimNoteKind::Outside);
                continue;
            }
            let beyond = beyond(bounds, domain);
            if beyond > BEYOND {
                return Err(TrimError::Beyond(item.number, beyond));
            }
            kept.extend(item.trim.loops);
        }
        if !outer && !kept.is_empty() {
            kept.insert(0, border(domain)?);
        }
        let trim = if kept.is_empty() {
            None
        } else {
            Some(Trim::new(kept, domain, gap_allowed.max(BEYOND))?)
        };
        Ok(Trimmed {
            patch: patch.with_trim(trim),
            notes,
        })
    }
}

fn renumber(error: TrimError, number: usize) -> TrimError {
    match error {
        TrimError::Empty(_) => TrimError::Empty(number),
        TrimError::Open(_, curve, gap) => TrimError::Open(number, curve, gap),
        other => other,
    }
}

/// A rectangle with its sides on the knots that they lie beside by rounding, so that no span without an extent is cut off.
fn on_knots(mut rectangle: [[f64; 2]; 2], patch: &NurbsPatch) -> [[f64; 2]; 2] {
    for (dir, sides) in rectangle.iter_mut().enumerate() {
        let [a, b] = patch.domain()[dir];
        let knots: Vec<f64> = patch.spans(dir).into_iter().flatten().collect();
        for side in sides {
            let beside = knots
                .iter()
                .find(|&&t| (t - *side).abs() <= BESIDE * (b - a));
            *side = beside.copied().unwrap_or(*side);
        }
    }
    rectangle
}

/// How far bounds leave the domain, as a share of it.
fn beyond(bounds: [[f64; 2]; 2], domain: [[f64; 2]; 2]) -> f64 {
    (0..2)
        .map(|k| {
            let [a, b] = domain[k];
            (a - bounds[k][0]).max(bounds[k][1] - b) / (b - a)
        })
        .fold(0.0, f64::max)
}

/// The border of a domain as a loop of four lines: xi2 = start, xi1 = end, xi2 = end, xi1 = start.
pub(super) fn border(domain: [[f64; 2]; 2]) -> Result<TrimLoop, TrimError> {
    let [[a, b], [c, d]] = domain;
    let corners = [[a, c], [b, c], [b, d], [a, d]].map(Vector2::from);
    let curves = (0..4)
        .map(|k| {
            let line = NurbsCurve::line(corners[k], corners[(k + 1) % 4]);
            Ok(TrimCurve {
                parameter: line.map_err(|_| TrimError::Move(0))?,
                space: None,
                entity: 0,
            })
        })
        .collect::<Result<_, TrimError>>()?;
    Ok(TrimLoop { curves })
}

/// The rectangle that a single loop is, sides near the border of the domain moved onto it; `None` where it is none.
fn rectangle(trim: &Trim, domain: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let bounds = trim.bounds();
    let slack = domain.map(|[a, b]| RECTANGLE * (b - a));
    let on_side = trim.pieces().iter().all(|piece| {
        (0..2).any(|k| {
            bounds[k].iter().any(|side| {
                (piece.from[k] - side).abs() <= slack[k] && (piece.to[k] - side).abs() <= slack[k]
            })
        })
    });
    let middle = bounds.map(|[a, b]| 0.5 * (a + b));
    let wide = (0..2).all(|k| bounds[k][1] - bounds[k][0] > 4.0 * slack[k]);
    if !(on_side && wide && trim.contains(middle)) {
        return None;
    }
    let snapped = [0, 1].map(|k| {
        let mut side = bounds[k];
        for (side, border) in side.iter_mut().zip(domain[k]) {
            if (*side - border).abs() <= slack[k] {
                *side = border;
            }
        }
        side
    });
    let inside = (0..2).all(|k| snapped[k][0] >= domain[k][0] && snapped[k][1] <= domain[k][1]);
    inside.then_some(snapped)
}

/// Moves loops that leave the domain in direction `dir` of a closed surface into it, and the seam where that does not do.
fn into_domain(
    patch: NurbsPatch,
    dir: usize,
    items: &mut [Item],
    note: &mut impl FnMut(usize, TrimNoteKind),
) -> Result<NurbsPatch, TrimError> {
    let [a, b] = patch.domain()[dir];
    let period = b - a;
    let slack = BEYOND * period;
    let inside = |item: &Item| {
        let [low, high] = item.trim.bounds()[dir];
        low >= a - slack && high <= b + slack
    };
    if items.iter().all(inside) || !closed(&patch, dir) {
        return Ok(patch);
    }
    // A seam that no loop crosses: the old one, or where a loop begins.
    let crosses = |item: &Item, start: f64| {
        let [low, high] = item.trim.bounds()[dir];
        let place = (low - start + slack).div_euclid(period);
        high > start + (place + 1.0) * period + slack
    };
    let starts = items.iter().map(|item| {
        let low = item.trim.bounds()[dir][0];
        let start = low - period * (low - a + slack).div_euclid(period);
        if (start - a).abs() <= slack { a } else { start }
    });
    let found = std::iter::once(a)
        .chain(starts)
        .find(|&start| !items.iter().any(|item| crosses(item, start)));
    let Some(start) = found else {
        let worst = items.iter().find(|item| crosses(item, a));
        let (number, bounds) = worst.map_or((0, patch.domain()), |i| (i.number, i.trim.bounds()));
        return Err(TrimError::Beyond(number, beyond(bounds, patch.domain())));
    };
    let patch = if start == a {
        patch
    } else {
        let number = items.first().map_or(0, |i| i.number);
        note(number, TrimNoteKind::Seam(dir, start));
        reseamed(&patch, dir, start).ok_or(TrimError::Beyond(number, 1.0))?
    };
    for item in items {
        let low = item.trim.bounds()[dir][0];
        let periods = (low - start + slack).div_euclid(period);
        if periods != 0.0 {
            let mut by = Vector2::zeros();
            by[dir] = -periods * period;
            item.trim = item
                .trim
                .mapped(&Matrix2::identity(), &by, patch.domain())
                .map_err(|_| TrimError::Move(item.number))?;
            let mut shifted = [0; 2];
            shifted[dir] = -periods as i32;
            note(item.number, TrimNoteKind::Shifted(shifted));
        }
    }
    Ok(patch)
}

/// Whether both ends of direction `dir` are the same line in space (to 1e-9 of the patch's extent), not merely a point.
fn closed(patch: &NurbsPatch, dir: usize) -> bool {
    let [low, high] = patch.bounds();
    let tolerance = 1e-9 * (high - low).norm();
    let domain = patch.domain();
    let mut length = 0.0f64;
    let samples = 4 * patch.spans(1 - dir).len() + 1;
    let [c, d] = domain[1 - dir];
    let together = (0..=samples).all(|k| {
        let mut xi = [c + (d - c) * k as f64 / samples as f64; 2];
        xi[dir] = domain[dir][0];
        let start = patch.point(xi);
        xi[dir] = domain[dir][1];
        let end = patch.point(xi);
        xi[dir] = 0.5 * (domain[dir][0] + domain[dir][1]);
        length = length.max((patch.point(xi) - start).norm());
        (end - start).norm() <= tolerance
    });
    together && length > tolerance
}

/// A closed patch with the seam of direction `dir` moved to `start`, inside of the domain: the part before it follows behind
/// the end, one period later. The direction comes in Bezier form (knots of full multiplicity); `None` where the weights of
/// both ends do not agree.
fn reseamed(patch: &NurbsPatch, dir: usize, start: f64) -> Option<NurbsPatch> {
    let basis = patch.basis(dir);
    let [a, b] = patch.domain()[dir];
    let period = b - a;
    let p = basis.degree();
    let counts = patch.counts();
    let other = counts[1 - dir];
    let net = patch.homogeneous();
    let at = |i: usize, line: usize| {
        let place = if dir == 0 { [i, line] } else { [line, i] };
        net[place[0] + counts[0] * place[1]]
    };
    let mut ranges = Vec::new();
    for shift in [0.0, period] {
        for span in 0..basis.span_count() {
            let [from, to] = basis.span_range(span);
            let part = if shift == 0.0 {
                [from.max(start), to]
            } else {
                [from, to.min(start)]
            };
            if part[1] - part[0] > 1e-12 * period {
                ranges.push((span, part, shift));
            }
        }
    }
    let mut knots = Vec::new();
    let mut lines: Vec<Vec<[f64; 4]>> = vec![Vec::new(); other];
    let mut factor = 1.0;
    for (k, (span, part, shift)) in ranges.iter().enumerate() {
        let mut c = [[0.0; WIDTH]; WIDTH];
        basis.bezier_coefficients(*span, *part, &mut c);
        let first = basis.first_function(*span);
        let pieces: Vec<Vec<[f64; 4]>> = (0..other)
            .map(|line| {
                c[..=p]
                    .iter()
                    .map(|c| {
                        let mut sum = [0.0; 4];
                        for (r, c) in c[..=p].iter().enumerate() {
                            for (sum, x) in sum.iter_mut().zip(at(first + r, line)) {
                                *sum += c * x;
                            }
                        }
                        sum
                    })
                    .collect()
            })
            .collect();
        if k > 0 && *shift != ranges[k - 1].2 {
            let ratio = |line: usize| Some(lines[line].last()?[3] / pieces[line][0][3]);
            factor = ratio(0)?;
            if (0..other).any(|line| ratio(line).is_none_or(|r| (r / factor - 1.0).abs() > 1e-9)) {
                return None;
            }
        }
        let copies = if k == 0 { p + 1 } else { p };
        knots.extend(std::iter::repeat_n(part[0] + shift, copies));
        for (line, piece) in lines.iter_mut().zip(pieces) {
            let skip = usize::from(k > 0);
            line.extend(piece[skip..].iter().map(|x| x.map(|x| x * factor)));
        }
    }
    knots.extend(std::iter::repeat_n(start + period, p + 1));
    let own = Basis::new(p, knots, lines[0].len()).ok()?;
    let n = lines[0].len();
    let points = if dir == 0 {
        lines.concat()
    } else {
        (0..n * other)
            .map(|k| lines[k % other][k / other])
            .collect()
    };
    let mut bases = [patch.basis(0).clone(), patch.basis(1).clone()];
    bases[dir] = own;
    NurbsPatch::from_homogeneous(bases, points).ok()
}

/// Area of a polygon as a share of the square on its diagonal, in parameters as shares of the domain; zero for a point.
fn area(polygon: &[[f64; 2]], extent: [f64; 2]) -> f64 {
    let Some(&origin) = polygon.first() else {
        return 0.0;
    };
    let at = |k: usize| {
        let p = polygon[k % polygon.len()];
        [0, 1].map(|d| (p[d] - origin[d]) / extent[d])
    };
    let sum: f64 = (0..polygon.len())
        .map(|k| {
            let (a, b) = (at(k), at(k + 1));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    let size = (0..polygon.len())
        .map(|k| at(k).map(f64::abs))
        .fold(0.0, |s: f64, [x, y]| s.max(x).max(y));
    if size < 1e-12 {
        0.0
    } else {
        (0.5 * sum).abs() / (size * size)
    }
}

/// Whether two sides of a polygon that do not follow each other cross at inner points.
fn crosses_itself(polygon: &[[f64; 2]]) -> bool {
    let n = polygon.len();
    let side = |k: usize| (polygon[k], polygon[(k + 1) % n]);
    let mut order: Vec<usize> = (0..n).collect();
    let low = |k: usize| side(k).0[0].min(side(k).1[0]);
    let high = |k: usize| side(k).0[0].max(side(k).1[0]);
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)));
    let mut active: Vec<usize> = Vec::new();
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let (x, y) = (u[0] * v[1], u[1] * v[0]);
        // What rounding may have made counts as touching.
        if (x - y).abs() <= 1e-12 * (x.abs() + y.abs()) {
            0.0
        } else {
            x - y
        }
    };
    for k in order {
        active.retain(|&other| high(other) >= low(k));
        let (a, b) = side(k);
        for &other in &active {
            let (c, d) = side(other);
            let opposite = |x: f64, y: f64| x > 0.0 && y < 0.0 || x < 0.0 && y > 0.0;
            if opposite(turn(a, b, c), turn(a, b, d)) && opposite(turn(c, d, a), turn(c, d, b)) {
                return true;
            }
        }
        active.push(k);
    }
    false
}
