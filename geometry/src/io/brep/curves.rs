//! Boundary curves of a face in the parameter plane of its patch: those that the file gives there, if they agree with those
//! in space, else the space curves projected.

use super::super::report::TrimReport;
use super::chain::Chain;
use super::face::{Part, Preference, Stretch};
use super::fit::{Fitted, fit, smooth_breaks};
use super::grant::Grant;
use super::host::{Host, Xi};
use super::poles;
use super::sides::along_side;
use crate::trim::TrimCurve;
use crate::{NurbsCurve, Vec3};

/// Fitted curves keep to what they stand for within this share of the size of the surface.
const FIT: f64 = 1e-7;
/// Projected curves may lie this far off the surface, as a share of its size; beyond it they do not belong to it.
const OFF: f64 = 1e-2;
/// Curves in the parameter plane that lie farther than this from those in space, as a share of the size, are not meant.
const WRONG: f64 = 1e-3;
/// Curves may leave the domain by this share of it and still be taken.
pub const BEYOND: f64 = 1e-3;

/// Curves beyond the border by less than this share of the domain are on it.
pub const NOISE: f64 = 1e-9;

/// What the curves of one face did; added to the report of the file if the face is read.
pub type Tally = TrimReport;

pub fn add(total: &mut TrimReport, face: &Tally) {
    total.curves += face.curves;
    total.exact += face.exact;
    total.refitted += face.refitted;
    total.projected += face.projected;
    total.rejected += face.rejected;
    total.largest_gap = total.largest_gap.max(face.largest_gap);
    total.largest_error = total.largest_error.max(face.largest_error);
    total.tolerance = total.tolerance.max(face.tolerance);
    total.bridged += face.bridged;
    total.largest_bridge = total.largest_bridge.max(face.largest_bridge);
}

/// A stretch in the parameter plane of the patch.
pub fn curves(
    host: &Host,
    stretch: &Stretch,
    tally: &mut Tally,
    complaints: &mut Vec<String>,
) -> Result<Vec<TrimCurve>, String> {
    let given = match stretch.parameter.is_empty() {
        true => Err("there are none".to_owned()),
        false => given(host, stretch),
    };
    match given {
        Ok(given) if given.gap <= host.agree || stretch.space.is_empty() => Ok(given.take(tally)),
        Ok(given) => {
            let gap = given.gap;
            // Space curves count where the file says so, or where the others cannot be meant, if they do lie on the surface.
            if stretch.preference == Preference::Space || gap > WRONG * host.size {
                let mut fresh = Tally::default();
                if let Ok(curves) = projected(host, stretch, &mut fresh)
                    && fresh.largest_gap < 0.5 * gap
                {
                    let against = match stretch.preference {
                        Preference::Parameter => ", although the file prefers the former",
                        _ => "",
                    };
                    complaints.push(format!(
                        "its curves in the parameter plane lie up to {gap:.1e} from those in space, which were projected{against}"
                    ));
                    fresh.rejected = 1;
                    add(tally, &fresh);
                    return Ok(curves);
                }
            }
            complaints.push(format!(
                "its curves in the parameter plane lie up to {gap:.1e} from those in space; the former bound it"
            ));
            Ok(given.take(tally))
        }
        Err(reason) if stretch.space.is_empty() => Err(reason),
        Err(reason) => {
            if !stretch.parameter.is_empty() {
                complaints.push(format!(
                    "its curves in the parameter plane are of no use ({reason}); those in space were projected"
                ));
                tally.rejected += 1;
            }
            projected(host, stretch, tally)
        }
    }
}

/// Curves from the file's parameter plane.
struct Given {
    curves: Vec<TrimCurve>,
    exact: usize,
    error: f64,
    /// Largest distance from the curves in space.
    gap: f64,
}

impl Given {
    fn take(self, tally: &mut Tally) -> Vec<TrimCurve> {
        let n = self.curves.len();
        tally.curves += n;
        tally.exact += self.exact;
        tally.refitted += n - self.exact;
        tally.largest_error = tally.largest_error.max(self.error);
        tally.largest_gap = tally.largest_gap.max(self.gap);
        self.curves
    }
}

fn given(host: &Host, stretch: &Stretch) -> Result<Given, String> {
    let (mut exact, mut error) = (0, 0.0f64);
    let mut own = Vec::with_capacity(stretch.parameter.len());
    let shift = host.turns(bounds(&stretch.parameter));
    for part in &stretch.parameter {
        let curve = match host.exact(&part.curve, shift) {
            Some(curve) => {
                exact += 1;
                curve
            }
            None => {
                let fitted = refitted(host, &part.curve, shift)?;
                error = error.max(fitted.error);
                fitted.curve
            }
        };
        let beyond = sample(&curve, 2)
            .map(|xi| host.beyond(xi))
            .fold(0.0, f64::max);
        if beyond.is_nan() || beyond > BEYOND {
            return Err(format!(
                "they leave the domain of the surface by {:.1e} of it",
                beyond
            ));
        }
        own.push((part.entity, inside(host, curve)));
    }
    let mut gap = 0.0f64;
    let mut backwards = false;
    if !stretch.space.is_empty() {
        let chain = Chain::new(&stretch.space);
        for (_, curve) in &own {
            for xi in sample(curve, 1) {
                let off = chain.distance(&host.point(xi));
                gap = if off.is_nan() {
                    f64::INFINITY
                } else {
                    gap.max(off)
                };
            }
        }
        // Ends tell the direction, and whether one of the two is shorter than the other.
        let ends = chain.ends();
        let (first, last) = (&own[0].1, &own[own.len() - 1].1);
        let own_ends = [host.point(first.ends()[0]), host.point(last.ends()[1])];
        let apart = |a: &[Vec3; 2], b: &[Vec3; 2]| (a[0] - b[0]).norm().max((a[1] - b[1]).norm());
        let along = apart(&own_ends, &ends);
        let against = apart(&own_ends, &[ends[1], ends[0]]);
        // A closed chain may begin anywhere.
        let round = |e: &[Vec3; 2]| (e[0] - e[1]).norm() <= host.agree;
        if !(round(&ends) && round(&own_ends)) {
            backwards = against < 0.1 * along && !round(&ends);
            gap = gap.max(if backwards { against } else { along });
        }
    }
    if backwards {
        own = own
            .into_iter()
            .rev()
            .map(|(entity, curve)| Ok((entity, curve.reversed()?)))
            .collect::<Result<_, crate::curve::CurveError>>()
            .map_err(|e| e.to_string())?;
    }
    let paired = own.len() == stretch.space.len();
    let curves = own.into_iter().enumerate().map(|(k, (entity, parameter))| {
        let space = stretch.space.get(k).filter(|_| paired);
        TrimCurve {
            entity: match (stretch.edge, space) {
                (0, Some(space)) => space.entity,
                (0, None) => entity,
                (edge, _) => edge,
            },
            space: space.map(|s| s.curve.clone()).filter(|space| {
                // Members in another order, or of other lengths: no pair.
                let ends = parameter.ends().map(|xi| host.point(xi));
                let other = space.ends();
                (0..2).all(|i| (ends[i] - other[i]).norm() <= host.agree.max(2.0 * gap))
            }),
            parameter,
        }
    });
    Ok(Given {
        curves: curves.collect(),
        exact,
        error,
        gap,
    })
}

/// A curve that leaves the domain a little, with the control points outside put onto the border, where the surface ends. In a
/// direction in which the surface is closed only a curve that is nowhere farther out is changed: it runs along the seam.
fn inside(host: &Host, curve: NurbsCurve<2>) -> NurbsCurve<2> {
    let points = curve.homogeneous().iter();
    let points: Vec<Xi> = points.map(|p| Xi::new(p[0] / p[3], p[1] / p[3])).collect();
    let out = |x: &Xi, d: usize| {
        let [a, b] = host.domain[d];
        (a - x[d]).max(x[d] - b) / (b - a)
    };
    let worst = [0, 1].map(|d| points.iter().map(|x| out(x, d)).fold(0.0, f64::max));
    if worst[0] <= NOISE && worst[1] <= NOISE {
        return curve;
    }
    // Control points may lie outside of a curve that does not leave the domain; those far out shape it inside and stay.
    let overshoot = |curve: &NurbsCurve<2>| {
        let [u, v] = bounds_of(std::iter::once(curve));
        [0, 1].map(|d| out(&Xi::new(u[0], v[0]), d).max(out(&Xi::new(u[1], v[1]), d)))
    };
    let mut curve = curve;
    let mut reach = overshoot(&curve).map(|own| if own > NOISE { 4.0 * own } else { 0.0 });
    for d in (0..2).filter(|&d| host.closed[d]) {
        reach[d] = if worst[d] <= BEYOND { BEYOND } else { 0.0 };
    }
    loop {
        let near = |x: Xi| {
            Xi::from_fn(|d, _| match out(&x, d) <= reach[d].min(BEYOND) {
                true => x[d].clamp(host.domain[d][0], host.domain[d][1]),
                false => x[d],
            })
        };
        let Ok(next) = curve.transformed(&near) else {
            return curve;
        };
        curve = next;
        let left = overshoot(&curve);
        let mut again = false;
        for d in 0..2 {
            if !host.closed[d] && left[d] > 1e-7 && reach[d] < BEYOND {
                reach[d] = 4.0 * reach[d].max(left[d]);
                again = true;
            }
        }
        if !again {
            return curve;
        }
    }
}

/// Box around curves of the file's parameter plane.
pub fn bounds(parts: &[Part<2>]) -> [[f64; 2]; 2] {
    bounds_of(parts.iter().map(|p| &p.curve))
}

/// Box around curves.
pub fn bounds_of<'a>(curves: impl Iterator<Item = &'a NurbsCurve<2>>) -> [[f64; 2]; 2] {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for curve in curves {
        let ts: Vec<f64> = parameters(curve.basis(), 2).collect();
        let points: Vec<Xi> = ts.iter().map(|&t| curve.point(t)).collect();
        for d in 0..2 {
            let order = |a: &usize, b: &usize| points[*a][d].total_cmp(&points[*b][d]);
            let (low, high) = ((0..ts.len()).min_by(order), (0..ts.len()).max_by(order));
            let (Some(low), Some(high)) = (low, high) else {
                continue;
            };
            let around = |k: usize| {
                [
                    ts[k.saturating_sub(1)],
                    ts[k],
                    ts[(k + 1).min(ts.len() - 1)],
                ]
            };
            bounds[d][0] = bounds[d][0].min(extreme(curve, d, around(low), f64::min));
            bounds[d][1] = bounds[d][1].max(extreme(curve, d, around(high), f64::max));
        }
    }
    bounds
}

/// The extreme coordinate `d` of a curve near the second of three parameters: Newton's method for a stationary point.
fn extreme(
    curve: &NurbsCurve<2>,
    d: usize,
    [a, mut t, b]: [f64; 3],
    better: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut best = curve.point(t)[d];
    for _ in 0..6 {
        let jet = curve.jet(t);
        best = better(best, jet.point[d]);
        let next = (t - jet.d1[d] / jet.d2[d]).clamp(a, b);
        if !next.is_finite() || next == t {
            break;
        }
        t = next;
    }
    better(best, curve.point(t)[d])
}

/// A curve of the file's parameter plane where the patch's parameters are not a linear map of it.
fn refitted(host: &Host, file: &NurbsCurve<2>, shift: Xi) -> Result<Fitted, String> {
    let breaks = smooth_breaks(file.basis());
    let cost = Grant::evaluation_of_curve(file.degree()) + host.evaluation();
    let mut path = |t: f64, _: Xi| {
        host.grant.work(cost)?;
        Ok(host.of_file(file.point(t) + shift))
    };
    let start = path(breaks[0], Xi::zeros())?;
    fit(host, &breaks, &mut path, start, FIT * host.size)
}

/// Space curves projected onto the surface, one for one except where they run through a pole.
fn projected(host: &Host, stretch: &Stretch, tally: &mut Tally) -> Result<Vec<TrimCurve>, String> {
    let mut curves = Vec::with_capacity(stretch.space.len());
    let mut near = Xi::from_fn(|d, _| 0.5 * (host.domain[d][0] + host.domain[d][1]));
    for part in &poles::cut(host, &stretch.space).map_err(|e| e.to_string())? {
        let (fitted, off) = match host.exact_projection(&part.curve) {
            Some(curve) => {
                let off = sample_space(&part.curve)
                    .map(|(t, x)| (host.patch.point(curve.point(t).into()) - x).norm())
                    .fold(0.0, f64::max);
                (Fitted { curve, error: 0.0 }, off)
            }
            None => {
                let points: Vec<Vec3> = sample_space(&part.curve).map(|(_, x)| x).collect();
                match along_side(host, &points) {
                    Some((curve, off)) => (Fitted { curve, error: 0.0 }, off),
                    None => project(host, part, near)?,
                }
            }
        };
        belongs(host, part, off)?;
        near = fitted.curve.ends()[1];
        tally.curves += 1;
        tally.projected += 1;
        tally.largest_error = tally.largest_error.max(fitted.error);
        tally.largest_gap = tally.largest_gap.max(off);
        curves.push(TrimCurve {
            parameter: inside(host, fitted.curve),
            space: Some(part.curve.clone()),
            entity: if stretch.edge == 0 {
                part.entity
            } else {
                stretch.edge
            },
        });
    }
    Ok(curves)
}

/// An error where a curve with a point this far off the surface cannot be on it.
fn belongs(host: &Host, part: &Part<3>, off: f64) -> Result<(), String> {
    if off <= OFF * host.size {
        return Ok(());
    }
    Err(format!(
        "curve {} lies {off:.1e} or more off the surface, of which it should bound a part",
        part.entity
    ))
}

/// A space curve on the surface, and how far it lies off it.
fn project(host: &Host, part: &Part<3>, near: Xi) -> Result<(Fitted, f64), String> {
    let space = &part.curve;
    let [a, b] = space.domain();
    let mut off = 0.0f64;
    let mut path = |t: f64, near: Xi| {
        let (mut xi, distance) = host.foot(&space.point(t), near)?;
        // Said at once: what is off the surface takes pieces without end to follow.
        belongs(host, part, distance)?;
        off = off.max(distance);
        let stuck = host.stuck(xi);
        if stuck != [false; 2] {
            // At a pole the turning parameter is what it tends to on the way there.
            let h = if t + 2e-3 * (b - a) <= b { 1e-3 } else { -1e-3 } * (b - a);
            let x1 = host.foot(&space.point(t + h), near)?.0;
            let x2 = host.foot(&space.point(t + 2.0 * h), x1)?.0;
            for d in (0..2).filter(|&d| stuck[d]) {
                xi[d] = 2.0 * x1[d] - x2[d];
            }
        }
        Ok(xi)
    };
    let breaks = smooth_breaks(space.basis());
    // A start on the seam belongs to the side on which the curve goes on.
    let inner = path(a + (b - a) * 1e-3, near)?;
    let fitted = fit(host, &breaks, &mut path, inner, FIT * host.size)?;
    Ok((fitted, off))
}

/// Points of a curve of the plane: `density` times degree plus one in each span.
fn sample(curve: &NurbsCurve<2>, density: usize) -> impl Iterator<Item = Xi> + '_ {
    parameters(curve.basis(), density).map(|t| curve.point(t))
}

fn sample_space(curve: &NurbsCurve<3>) -> impl Iterator<Item = (f64, Vec3)> + '_ {
    parameters(curve.basis(), 2).map(|t| (t, curve.point(t)))
}

pub(super) fn parameters(
    basis: &crate::basis::Basis,
    density: usize,
) -> impl Iterator<Item = f64> + '_ {
    let n = density * (basis.degree() + 1);
    let end = basis.domain()[1];
    (0..basis.span_count())
        .flat_map(move |span| {
            let [a, b] = basis.span_range(span);
            (0..n).map(move |k| a + (b - a) * (k as f64 / n as f64))
        })
        .chain([end])
}
