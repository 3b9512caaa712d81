//! Curves in space that run through a pole of their surface, where the parameter that turns about it jumps by half a turn.

use super::curves::parameters;
use super::face::Part;
use super::host::{Host, Xi};
use crate::curve::CurveError;
use crate::{NurbsCurve, Vec3};

/// Curves run through a pole where they come this near to it, as a share of the surface's size.
const THROUGH: f64 = 1e-7;
/// The pole lies between the ends of a curve where it is farther from them than this share of the size.
const INNER: f64 = 1e-4;
const ITERATIONS: usize = 20;

/// Points that a side of the parameter rectangle shrinks to.
fn poles(host: &Host) -> Vec<Vec3> {
    let sides = (0..2).flat_map(|dir| [(dir, 0), (dir, 1)]);
    let along = |(dir, end): (usize, usize), share: f64| {
        let mut xi = Xi::zeros();
        xi[dir] = host.domain[dir][end];
        xi[1 - dir] = host.domain[1 - dir][0] + share * host.extent(1 - dir);
        host.patch.point(xi.into())
    };
    let shrunk = |side: &(usize, usize)| {
        let first = along(*side, 0.0);
        let off = |k: u32| (along(*side, f64::from(k) / 8.0) - first).norm();
        (1..=8).all(|k| off(k) <= THROUGH * host.size)
    };
    sides.filter(shrunk).map(|side| along(side, 0.0)).collect()
}

/// Curves one after the other, the one that runs through a pole cut there. Where they come to both poles, or end at one,
/// they stay: which way round it they go on is then told by what they bound.
pub(super) fn cut(host: &Host, parts: &[Part<3>]) -> Result<Vec<Part<3>>, CurveError> {
    let poles = poles(host);
    let mut through = Vec::new();
    for pole in &poles {
        let places = parts.iter().map(|part| nearest(&part.curve, pole));
        let place = places.enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        through.extend(place.filter(|(_, (_, off))| *off <= THROUGH * host.size));
    }
    let [(number, (t, _))] = through[..] else {
        return Ok(parts.to_vec());
    };
    let curve = &parts[number].curve;
    let at = curve.point(t);
    if (curve.ends().iter()).any(|x| (x - at).norm() <= INNER * host.size) {
        return Ok(parts.to_vec());
    }
    let [a, b] = curve.domain();
    let mut out = parts.to_vec();
    let piece = |domain| -> Result<Part<3>, CurveError> {
        Ok(Part {
            entity: parts[number].entity,
            curve: curve.with_domain(domain)?,
        })
    };
    out[number] = piece([a, t])?;
    out.insert(number + 1, piece([t, b])?);
    Ok(out)
}

/// Parameter of the point of a curve that is nearest to `q`, and its distance, by Newton's method from the nearest of many.
fn nearest(curve: &NurbsCurve<3>, q: &Vec3) -> (f64, f64) {
    let off = |t: f64| (curve.point(t) - q).norm();
    let [a, b] = curve.domain();
    let starts = parameters(curve.basis(), 4);
    let Some(mut t) = starts.min_by(|s, t| off(*s).total_cmp(&off(*t))) else {
        return (a, f64::INFINITY);
    };
    for _ in 0..ITERATIONS {
        let jet = curve.jet(t);
        let d = jet.point - q;
        let next = (t - d.dot(&jet.d1) / jet.d1.norm_squared()).clamp(a, b);
        if !next.is_finite() || off(next) >= off(t) {
            break;
        }
        t = next;
    }
    (t, off(t))
}
