//! Ruled surfaces (118).

use super::super::curve::{JoinedCurve, Stop};
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::basis::Basis;
use crate::curve::fit::{FitError, fit};
use crate::curve::join::inner_knots;
use crate::curve::{CurveError, CurveJet};
use crate::io::brep::{Grant, ParameterMap, Reparametrise};
use crate::{NurbsCurve, NurbsPatch, Vec3};

/// Largest deviation of a rail that must be given a new parameter, as a share of the surface's size.
const TOLERANCE: f64 = 1e-9;

/// A 118: straight lines between points of two curves, S(u, v) = (1 - v) C1 + v C2, u and v from 0 to 1. Form 1 joins
/// points of equal relative parameter, form 0 points of equal relative length; with DIRFLG = 1 the second curve runs
/// backwards.
///
/// Exact where both curves' NURBS forms run alike with the relative parameter (lines, splines, arcs of the same shares of
/// their angle) and with the same weights, and for form 0 where both also have constant speed (lines and circular arcs). Else the curves are fitted
/// by splines of the relative parameter or length, to 1e-9 of the surface's size.
pub fn read(mut reader: SurfaceReader) -> Found {
    let mut rails = [
        reader.rail(1, "the first curve of a ruled surface (118)")?,
        reader.rail(2, "the second curve of a ruled surface (118)")?,
    ];
    let direction = reader.params.integer(3, "the direction flag DIRFLG")?;
    if !(0..=1).contains(&direction) {
        return Err(reader
            .params
            .fail(3, "0 or 1 for the direction flag DIRFLG")
            .into());
    }
    if direction == 1 {
        let own = rails[1].curve.domain();
        rails[1].curve = rails[1].curve.reversed()?;
        rails[1].map = rails[1]
            .map
            .with_file_range([0.0, 1.0], true)
            .with_own_range(own);
    }
    // From here on both curves and both parameters run from 0 to 1.
    let unit = [0.0, 1.0];
    for rail in &mut rails {
        rail.curve = rail.curve.with_parameters(unit)?;
        rail.map = rail.map.with_file_range(unit, false).with_own_range(unit);
    }
    // A point is the same at every parameter, and with any weights.
    for k in 0..2 {
        let net = rails[k].curve.homogeneous();
        let [x, y, z, w] = net[0];
        if net.iter().all(|h| *h == net[0]) {
            let other = &rails[1 - k];
            let weights = other.curve.homogeneous().iter().map(|h| h[3]);
            let points = weights.map(|v| [x, y, z, w].map(|c| c * v / w)).collect();
            let curve = NurbsCurve::from_homogeneous(other.curve.basis().clone(), points)?;
            let map = other.map.clone();
            rails[k].curve = curve;
            rails[k].map = map;
        }
    }
    let by_length = reader.entry.form == 0 && !rails.iter().all(uniform);
    let alike = rails[0].map.same_shape(&rails[1].map) && same_weights(&rails)?;
    let mut deviation = rails[0].deviation.max(rails[1].deviation);
    let mut map = rails[0].map.clone();
    if by_length || !alike {
        let size = extent(&rails);
        for rail in &mut rails {
            if !by_length && rail.map.as_affine().is_some() && !is_rational(&rail.curve) {
                continue;
            }
            let grant = &reader.model.grant;
            let fitted = if by_length {
                by_relative_length(&rail.curve, TOLERANCE * size, grant)
            } else {
                by_file_parameter(rail, TOLERANCE * size)
            };
            let (curve, off) = fitted.map_err(|e| match grant.is_spent() {
                true => "its rails by length take more work than a file of this length is granted"
                    .to_owned(),
                false => e.to_string(),
            })?;
            rail.curve = curve;
            deviation = deviation.max(off);
        }
        map = ParameterMap::identity(unit);
    }
    let [first, second] = common([&rails[0].curve, &rails[1].curve])?;
    let points = first.homogeneous().iter().chain(second.homogeneous());
    let points = points.copied().collect();
    let across = Basis::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).map_err(|e| e.to_string())?;
    let patch = NurbsPatch::from_homogeneous([first.basis().clone(), across], points)?;
    let base = BasePatch {
        patch: patch.transformed(&|x| reader.place(x))?,
        parameters: Reparametrise {
            directions: [map, ParameterMap::identity(unit)],
        },
        deviation: deviation / reader.model.global.scale,
    };
    Ok((BaseSurface::Patches(vec![base]), 5))
}

impl SurfaceReader<'_, '_> {
    /// A curve, or a point (116) as a curve of no length: the tip of a cone.
    fn rail(&mut self, i: usize, what: &str) -> Result<JoinedCurve, Stop> {
        if self.pointer(i, what)?.type_number != 116 {
            return self.curve(i, what);
        }
        let x = self.location(i, what)?;
        Ok(JoinedCurve {
            curve: NurbsCurve::line(x, x)?,
            map: ParameterMap::identity([0.0, 1.0]),
            deviation: 0.0,
            gap: 0.0,
        })
    }
}

fn extent(rails: &[JoinedCurve; 2]) -> f64 {
    let points = rails.iter().flat_map(|r| r.curve.homogeneous());
    let mut low = Vec3::from_element(f64::INFINITY);
    let mut high = -low;
    for h in points {
        let x = Vec3::new(h[0], h[1], h[2]) / h[3];
        (low, high) = (low.inf(&x), high.sup(&x));
    }
    (high - low).norm()
}

fn is_rational(curve: &NurbsCurve<3>) -> bool {
    let net = curve.homogeneous();
    net.iter().any(|h| h[3] != net[0][3])
}

/// Whether the weights of both curves have one ratio all along: only then the points between two of the same parameter
/// lie where the shares 1 - v and v put them.
fn same_weights(rails: &[JoinedCurve; 2]) -> Result<bool, CurveError> {
    let [a, b] = common([&rails[0].curve, &rails[1].curve])?;
    let mut ratios = a.homogeneous().iter().zip(b.homogeneous());
    Ok(ratios.all(|(a, b)| (a[3] / b[3] - 1.0).abs() < 1e-13))
}

/// Whether the curve has the same speed everywhere in the file's parameter, to 1e-10.
fn uniform(rail: &JoinedCurve) -> bool {
    let basis = rail.curve.basis();
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for span in 0..basis.span_count() {
        let [a, b] = basis.span_range(span);
        for k in 0..=8 {
            // Inside of the span, where the map's piece is the span's own.
            let t = a + (b - a) * (1e-3 + (1.0 - 2e-3) * f64::from(k) / 8.0);
            let rise = rail.map.jet(rail.map.to_file(t))[1];
            let speed = rail.curve.jet_in_span(span, t).d1.norm() * rise;
            (low, high) = (low.min(speed), high.max(speed));
        }
    }
    high - low <= 1e-10 * high
}

/// The curve with the file's relative parameter as its own.
fn by_file_parameter(rail: &JoinedCurve, tolerance: f64) -> Result<(NurbsCurve<3>, f64), FitError> {
    let basis = rail.curve.basis();
    let mut breaks: Vec<f64> = (0..basis.span_count())
        .map(|span| rail.map.to_file(basis.span_range(span)[0]))
        .collect();
    breaks.push(1.0);
    breaks[0] = 0.0;
    let f = |span: usize, s: f64| {
        // Kept inside of the span, so that the map's own break at its start belongs to it.
        let [a, b] = [breaks[span], breaks[span + 1]];
        let map = rail.map.jet(s.clamp(a + 1e-12 * (b - a), b));
        let jet = rail.curve.jet_in_span(span, rail.map.to_own(s));
        CurveJet {
            point: jet.point,
            d1: jet.d1 * map[1],
            d2: jet.d2 * (map[1] * map[1]) + jet.d1 * map[2],
        }
    };
    fit(&f, &breaks, tolerance)
}

/// The curve with its relative length as parameter. The work is charged to the grant; without any left, the curve has no finite
/// points.
fn by_relative_length(
    curve: &NurbsCurve<3>,
    tolerance: f64,
    grant: &Grant,
) -> Result<(NurbsCurve<3>, f64), FitError> {
    let spans = curve.basis().span_count();
    let step = STEP * Grant::evaluation_of_curve(curve.degree());
    if !grant.spend((spans * PARTS) as u64 * step) {
        return Err(FitError::NotFinite(curve.domain()[0]));
    }
    let lengths = Lengths::new(curve, grant, step);
    let total = lengths.total();
    if total <= 0.0 {
        return Ok((curve.clone(), 0.0));
    }
    // Ends of spans in relative length; spans without length are left out.
    let mut breaks = vec![0.0];
    let mut used = Vec::new();
    for span in 0..spans {
        let end = if span + 1 == spans {
            1.0
        } else {
            lengths.start[(span + 1) * PARTS] / total
        };
        if end - breaks[breaks.len() - 1] > 1e-12 {
            breaks.push(end);
            used.push(span);
        }
    }
    let f = |k: usize, s: f64| {
        let span = used[k.min(used.len() - 1)];
        let t = lengths.parameter(span, s * total);
        let jet = curve.jet_in_span(span, t);
        let speed = jet.d1.norm();
        let along = jet.d1 / speed;
        let bend = (jet.d2 - along * along.dot(&jet.d2)) / (speed * speed);
        CurveJet {
            point: jet.point,
            d1: along * total,
            d2: bend * (total * total),
        }
    };
    fit(&f, &breaks, tolerance)
}

/// Parts of a span, each integrated by itself.
const PARTS: usize = 8;

/// Positive abscissae and weights of the 8-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun 1964, table 25.4).
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_3],
];

/// Lengths of a curve up to the parts of its spans.
struct Lengths<'a> {
    curve: &'a NurbsCurve<3>,
    /// At the start of each part, and at the end of the last.
    start: Vec<f64>,
    /// Pays for the work.
    grant: &'a Grant,
    /// Cost of a step towards a length.
    step: u64,
}

/// Evaluations of the curve in a step towards a length.
const STEP: u64 = 2 * GAUSS.len() as u64 + 1;

impl<'a> Lengths<'a> {
    fn new(curve: &'a NurbsCurve<3>, grant: &'a Grant, step: u64) -> Self {
        let mut start = vec![0.0];
        let mut sum = 0.0;
        for span in 0..curve.basis().span_count() {
            for part in 0..PARTS {
                let [a, b] = part_of(curve.basis().span_range(span), part);
                sum += length(curve, span, a, b);
                start.push(sum);
            }
        }
        Self {
            curve,
            start,
            grant,
            step,
        }
    }

    fn total(&self) -> f64 {
        self.start[self.start.len() - 1]
    }

    /// The parameter in span `span` up to which the curve has the length `s`.
    fn parameter(&self, span: usize, s: f64) -> f64 {
        let first = span * PARTS;
        let part = (0..PARTS - 1)
            .find(|k| s <= self.start[first + k + 1])
            .unwrap_or(PARTS - 1);
        let [a, b] = part_of(self.curve.basis().span_range(span), part);
        let (from, to) = (self.start[first + part], self.start[first + part + 1]);
        let mut t = if to > from {
            a + (b - a) * ((s - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            a
        };
        // The speed is near constant in a part: a few steps of Newton's method do.
        for _ in 0..8 {
            if !self.grant.spend(self.step) {
                return f64::NAN;
            }
            let rest = s - from - length(self.curve, span, a, t);
            let speed = self.curve.jet_in_span(span, t).d1.norm();
            let step = rest / speed;
            if !step.is_finite() {
                break;
            }
            t = (t + step).clamp(a, b);
            if step.abs() <= 1e-15 * (b - a) {
                break;
            }
        }
        t
    }
}

fn part_of([a, b]: [f64; 2], part: usize) -> [f64; 2] {
    let at = |k: usize| {
        if k == PARTS {
            b
        } else {
            a + (b - a) * (k as f64 / PARTS as f64)
        }
    };
    [at(part), at(part + 1)]
}

fn length(curve: &NurbsCurve<3>, span: usize, a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let speed = |t: f64| curve.jet_in_span(span, t).d1.norm();
    let terms = GAUSS.map(|[x, w]| w * (speed(middle - half * x) + speed(middle + half * x)));
    half * terms.iter().sum::<f64>()
}

/// Both curves with the same degree and knots; their domains are equal.
fn common(curves: [&NurbsCurve<3>; 2]) -> Result<[NurbsCurve<3>; 2], CurveError> {
    let degree = curves[0].degree().max(curves[1].degree());
    let mut raised = [
        curves[0].refined(degree, &[])?,
        curves[1].refined(degree, &[])?,
    ];
    // Knots that differ by rounding only are one and the same.
    let mut own = raised.each_ref().map(|c| inner_knots(c.basis()));
    let others = raised[0].basis().knots();
    let twin = |t: f64| {
        let first = others.partition_point(|&s| s < t - 1e-12);
        let found = others.get(first).filter(|&&s| s <= t + 1e-12);
        found.copied().unwrap_or(t)
    };
    for knot in &mut own[1] {
        knot.0 = twin(knot.0);
    }
    let knots: Vec<f64> = raised[1].basis().knots().iter().map(|&t| twin(t)).collect();
    let basis = Basis::new(degree, knots, raised[1].basis().count())?;
    raised[1] = NurbsCurve::from_homogeneous(basis, raised[1].homogeneous().to_vec())?;
    Ok([
        raised[0].refined(degree, &own[1])?,
        raised[1].refined(degree, &own[0])?,
    ])
}
