//! B-spline curves and surfaces: with knots, uniform, quasi-uniform and Bezier, rational or not.

use super::curve::Kind;
use super::entity::{Entity, Told};
use super::place::point;
use super::scan::Item;
use super::scope::Scope;
use crate::basis::{Basis, MAX_DEGREE};
use crate::{NurbsCurve, NurbsPatch, Vec3};
use std::ops::Range;

/// Control points on both sides of a knot that parts a spline are one point if they are nearer than this share of all.
const TORN: f64 = 1e-9;

/// Which knots the type of an instance gives it without naming them.
fn implied(entity: &Entity, what: &str, degree: usize, count: usize) -> Told<Vec<f64>> {
    let is = |form: &str| entity.is(&format!("{form}_{what}"));
    let n = count + degree + 1;
    if is("UNIFORM") {
        return Ok((0..n).map(|k| k as f64 - degree as f64).collect());
    }
    let spans = count.saturating_sub(degree);
    if is("QUASI_UNIFORM") {
        let clamp = |k: usize| k.saturating_sub(degree).min(spans);
        return Ok((0..n).map(|k| clamp(k) as f64).collect());
    }
    if is("BEZIER") && (count - 1).is_multiple_of(degree) {
        let pieces = (count - 1) / degree;
        let knot = |k: usize| (k.saturating_sub(1) / degree).min(pieces) as f64;
        return Ok((0..n).map(knot).collect());
    }
    Err(format!(
        "{} gives no knots that fit its {count} control points",
        entity.describe()
    ))
}

/// Knots in full from their values and multiplicities.
fn expanded(
    entity: &Entity,
    [multiplicities, values]: [&Item; 2],
    degree: usize,
    count: usize,
) -> Told<Vec<f64>> {
    let values = entity.numbers(values, "a knot")?;
    let counts = entity.items(multiplicities, "the multiplicities of knots")?;
    if counts.len() != values.len() {
        let expected = format!("{} multiplicities, one for each knot", values.len());
        return Err(entity.wrong(multiplicities, &expected));
    }
    let needed = count + degree + 1;
    let mut knots = Vec::with_capacity(needed);
    for (value, item) in values.iter().zip(counts) {
        let left = needed - knots.len();
        let multiplicity = entity.count(item, left, "the multiplicity of a knot")?;
        knots.extend(std::iter::repeat_n(*value, multiplicity));
    }
    if knots.len() != needed {
        let expected = format!(
            "multiplicities of {needed} knots in all, for {count} control points of degree {degree}"
        );
        return Err(entity.wrong(multiplicities, &expected));
    }
    crate::io::brep::merge_close(&mut knots);
    Ok(knots)
}

fn degree(entity: &Entity, kind: &str, k: usize) -> Told<usize> {
    let item = entity.attribute(kind, k, "a degree")?;
    let degree = entity.count(item, MAX_DEGREE, "a degree")?;
    if degree == 0 {
        return Err(entity.wrong(item, &format!("a degree from 1 to {MAX_DEGREE}")));
    }
    Ok(degree)
}

/// Control points in rows, with the knots between them.
struct Net {
    degree: usize,
    knots: Vec<f64>,
    rows: Vec<Vec<[f64; 4]>>,
}

impl Net {
    /// Takes one of `degree + 1` equal knots out where the rows on both sides of it are the same, so that the spline is in
    /// one piece.
    fn mend(&mut self) {
        let far = |p: &[f64; 4]| p[..3].iter().fold(0f64, |m, x| m.max((x / p[3]).abs()));
        let size = self.rows.iter().flatten().map(far).fold(0.0, f64::max);
        let same = |a: &[f64; 4], b: &[f64; 4]| {
            (a[3] - b[3]).abs() <= TORN * a[3].abs()
                && (0..3).all(|k| (a[k] / a[3] - b[k] / b[3]).abs() <= TORN * size)
        };
        let mut i = self.degree + 1;
        while i < self.rows.len() {
            let knot = self.knots[i];
            let m = self.knots[i..].iter().take_while(|&&t| t == knot).count();
            let inside = knot > self.knots[self.degree] && knot < self.knots[self.rows.len()];
            let equal = || {
                let (a, b) = (&self.rows[i - 1], &self.rows[i]);
                a.iter().zip(b).all(|(a, b)| same(a, b))
            };
            if inside && m == self.degree + 1 && equal() {
                self.rows.remove(i);
                self.knots.remove(i);
                i += m - 1;
            } else {
                i += m;
            }
        }
    }

    /// Ranges of rows that hang together: knots repeated more often than the degree part them.
    fn pieces(&self) -> Vec<Range<usize>> {
        crate::io::brep::pieces(self.degree, &self.knots, self.rows.len())
    }
}

fn homogeneous<const D: usize>(x: nalgebra::SVector<f64, D>, w: f64) -> [f64; 4] {
    let mut p = [0.0, 0.0, 0.0, w];
    for (p, x) in p.iter_mut().zip(x.iter()) {
        *p = x * w;
    }
    p
}

/// The curves of a B_SPLINE_CURVE: one, or several where its knots part it.
pub fn spline_curve<const D: usize>(scope: &Scope, entity: &Entity) -> Told<Vec<Kind<D>>> {
    let kind = "B_SPLINE_CURVE";
    let degree = degree(entity, kind, 0)?;
    let list = entity.targets(kind, 1, "a control point")?;
    if list.len() <= degree {
        let item = entity.attribute(kind, 1, "control points")?;
        return Err(entity.wrong(item, &format!("more than {degree} control points")));
    }
    scope.budget.take(list.len())?;
    let weights = match entity.is("RATIONAL_B_SPLINE_CURVE") {
        true => {
            let item = entity.attribute("RATIONAL_B_SPLINE_CURVE", 0, "weights")?;
            let weights = entity.numbers(item, "a weight")?;
            if weights.len() != list.len() {
                return Err(entity.wrong(item, &format!("{} weights", list.len())));
            }
            Some(weights)
        }
        false => None,
    };
    let with = "B_SPLINE_CURVE_WITH_KNOTS";
    let knots = match entity.is(with) {
        true => {
            let pair = [0, 1].map(|k| entity.attribute(with, k, "knots"));
            let [multiplicities, values] = pair;
            expanded(entity, [multiplicities?, values?], degree, list.len())?
        }
        false => implied(entity, "CURVE", degree, list.len())?,
    };
    let mut rows = Vec::with_capacity(list.len());
    for (k, index) in list.into_iter().enumerate() {
        let w = weights.as_ref().map_or(1.0, |w| w[k]);
        rows.push(vec![homogeneous(point::<D>(scope.exchange, index)?, w)]);
    }
    let mut net = Net {
        degree,
        knots,
        rows,
    };
    net.mend();
    let curve = |part: Range<usize>| {
        let knots = net.knots[part.start..part.end + degree + 1].to_vec();
        let basis = Basis::new(degree, knots, part.len()).map_err(|e| e.to_string())?;
        let points = net.rows[part].iter().map(|row| row[0]).collect();
        NurbsCurve::from_homogeneous(basis, points).map_err(|e| e.to_string())
    };
    let told = |e: String| format!("{}: {e}", entity.describe());
    let curves = net
        .pieces()
        .into_iter()
        .map(|part| curve(part).map(Kind::Spline));
    curves.map(|c| c.map_err(told)).collect()
}

/// The patch of a B_SPLINE_SURFACE.
pub fn spline_surface(scope: &Scope, entity: &Entity) -> Told<NurbsPatch> {
    let kind = "B_SPLINE_SURFACE";
    let degrees = [degree(entity, kind, 0)?, degree(entity, kind, 1)?];
    let item = entity.attribute(kind, 2, "control points")?;
    let columns = entity.items(item, "control points")?;
    // In the file the second direction runs fastest.
    let lists = columns.iter().map(|c| entity.items(c, "control points"));
    let lists = lists.collect::<Told<Vec<_>>>()?;
    let counts = [lists.len(), lists.first().map_or(0, |l| l.len())];
    if let Some(k) = lists.iter().position(|l| l.len() != counts[1]) {
        let expected = format!("{} control points, as in the first list", counts[1]);
        return Err(entity.wrong(&columns[k], &expected));
    }
    if (0..2).any(|d| counts[d] <= degrees[d]) {
        let expected = format!("control points of degree {} x {}", degrees[0], degrees[1]);
        return Err(entity.wrong(item, &expected));
    }
    scope.budget.take(counts[0] * counts[1])?;
    let with = "B_SPLINE_SURFACE_WITH_KNOTS";
    let knots = |d: usize| match entity.is(with) {
        true => {
            let pair = [d, d + 2].map(|k| entity.attribute(with, k, "knots"));
            let [multiplicities, values] = pair;
            expanded(entity, [multiplicities?, values?], degrees[d], counts[d])
        }
        false => implied(entity, "SURFACE", degrees[d], counts[d]),
    };
    let knots = [knots(0)?, knots(1)?];
    let rational = "RATIONAL_B_SPLINE_SURFACE";
    let weights = match entity.is(rational) {
        true => {
            let item = entity.attribute(rational, 0, "weights")?;
            let rows = entity.items(item, "weights")?;
            let rows = rows.iter().map(|r| entity.numbers(r, "a weight"));
            let weights = rows.collect::<Told<Vec<_>>>()?;
            if weights.len() != counts[0] || weights.iter().any(|r| r.len() != counts[1]) {
                let expected = format!("{} x {} weights", counts[0], counts[1]);
                return Err(entity.wrong(item, &expected));
            }
            Some(weights)
        }
        false => None,
    };
    let mut rows = Vec::with_capacity(counts[0]);
    for (i, list) in lists.iter().enumerate() {
        let mut row = Vec::with_capacity(counts[1]);
        for (j, item) in list.iter().enumerate() {
            let x: Vec3 = point(scope.exchange, entity.target(item, "a control point")?)?;
            row.push(homogeneous(x, weights.as_ref().map_or(1.0, |w| w[i][j])));
        }
        rows.push(row);
    }
    let [first, second] = knots;
    let along = |degree: usize, knots: Vec<f64>, rows| {
        let mut net = Net {
            degree,
            knots,
            rows,
        };
        net.mend();
        net
    };
    let first = along(degrees[0], first, rows);
    let turned = transposed(&first.rows);
    let second = along(degrees[1], second, turned);
    let basis = |net: &Net| Basis::new(net.degree, net.knots.clone(), net.rows.len());
    let told = |d: usize, e: crate::basis::KnotError| {
        format!("{}: direction {}: {e}", entity.describe(), d + 1)
    };
    let columns = Net {
        degree: first.degree,
        knots: first.knots,
        rows: transposed(&second.rows),
    };
    let bases = [
        basis(&columns).map_err(|e| told(0, e))?,
        basis(&second).map_err(|e| told(1, e))?,
    ];
    // Rows of the second net run along the first direction.
    let points = second.rows.concat();
    NurbsPatch::from_homogeneous(bases, points).map_err(|e| format!("{}: {e}", entity.describe()))
}

fn transposed(rows: &[Vec<[f64; 4]>]) -> Vec<Vec<[f64; 4]>> {
    let n = rows.first().map_or(0, Vec::len);
    (0..n)
        .map(|j| rows.iter().map(|row| row[j]).collect())
        .collect()
}
