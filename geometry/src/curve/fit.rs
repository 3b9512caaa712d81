//! Curves known point by point, as splines within a tolerance.

use nalgebra::SVector;

use super::{CurveError, CurveJet, NurbsCurve};

/// Why a curve could not be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// More spans than allowed are needed, or spans shorter than rounding.
    #[error("{spans} spans do not reach the tolerance {tolerance:.1e}; {deviation:.1e} is left")]
    Tolerance {
        /// Spans allowed.
        spans: usize,
        /// Tolerance asked for.
        tolerance: f64,
        /// Largest deviation left.
        deviation: f64,
    },
    /// The curve has no finite point or derivative at a parameter.
    #[error("the curve has no finite point or derivative at parameter {0}")]
    NotFinite(f64),
    /// The spline is no curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

/// Most spans of a fitted curve.
pub const MAX_SPANS: usize = 4096;

/// Bezier points of the quintic with the value and two derivatives of `f` at both ends.
fn hermite<const D: usize>(a: &CurveJet<D>, b: &CurveJet<D>, h: f64) -> [SVector<f64, D>; 6] {
    [
        a.point,
        a.point + a.d1 * (h / 5.0),
        a.point + a.d1 * (2.0 * h / 5.0) + a.d2 * (h * h / 20.0),
        b.point - b.d1 * (2.0 * h / 5.0) + b.d2 * (h * h / 20.0),
        b.point - b.d1 * (h / 5.0),
        b.point,
    ]
}

/// Value of the polar form of a quintic on [0, 1].
fn blossom<const D: usize>(points: &[SVector<f64, D>; 6], arguments: [f64; 5]) -> SVector<f64, D> {
    let mut d = *points;
    for (level, s) in arguments.into_iter().enumerate() {
        for j in 0..5 - level {
            d[j] = d[j] + (d[j + 1] - d[j]) * s;
        }
    }
    d[0]
}

struct Span<const D: usize> {
    range: [f64; 2],
    points: [SVector<f64, D>; 6],
}

/// A quintic spline with the parameter, the points and the first two derivatives of `f` at its knots, whose points lie
/// within `tolerance` of those of `f` at the same parameters, as checked at seven parameters of each span. `breaks` are
/// two or more ascending parameters, ends included; between them `f` should be smooth, at them the spline is continuous.
/// `f` takes the number of the interval between breaks beside the parameter, for one-sided derivatives. The error falls
/// with the sixth power of the span where `f` is smooth. Also returns the largest deviation found.
///
/// # Errors
/// A tolerance that [`MAX_SPANS`] spans do not reach, values that are not finite.
pub fn fit<const D: usize>(
    f: &dyn Fn(usize, f64) -> CurveJet<D>,
    breaks: &[f64],
    tolerance: f64,
) -> Result<(NurbsCurve<D>, f64), FitError> {
    let mut spans: Vec<Span<D>> = Vec::new();
    // Multiplicity of the knot before each span.
    let mut joints: Vec<usize> = Vec::new();
    let mut largest = 0.0f64;
    for (interval, ends) in breaks.windows(2).enumerate() {
        let mut open = vec![[ends[0], ends[1]]];
        let mut first = true;
        while let Some(range) = open.pop() {
            let (points, deviation) = span(f, interval, range)?;
            let middle = 0.5 * (range[0] + range[1]);
            let splittable = range[0] < middle && middle < range[1];
            if deviation > tolerance {
                if spans.len() + open.len() >= MAX_SPANS || !splittable {
                    return Err(FitError::Tolerance {
                        spans: MAX_SPANS,
                        tolerance,
                        deviation,
                    });
                }
                open.push([middle, range[1]]);
                open.push([range[0], middle]);
                continue;
            }
            largest = largest.max(deviation);
            joints.push(if first { 5 } else { 3 });
            first = false;
            spans.push(Span { range, points });
        }
    }
    Ok((spline(&spans, &joints)?, largest))
}

fn span<const D: usize>(
    f: &dyn Fn(usize, f64) -> CurveJet<D>,
    interval: usize,
    range: [f64; 2],
) -> Result<([SVector<f64, D>; 6], f64), FitError> {
    let h = range[1] - range[0];
    let jets = range.map(|t| f(interval, t));
    for (jet, t) in jets.iter().zip(range) {
        let finite = |v: &SVector<f64, D>| v.iter().all(|x| x.is_finite());
        if !(finite(&jet.point) && finite(&jet.d1) && finite(&jet.d2)) {
            return Err(FitError::NotFinite(t));
        }
    }
    let points = hermite(&jets[0], &jets[1], h);
    let mut deviation = 0.0f64;
    for k in 1..8 {
        let s = f64::from(k) / 8.0;
        let t = range[0] + h * s;
        let d = (blossom(&points, [s; 5]) - f(interval, t).point).norm();
        if !d.is_finite() {
            return Err(FitError::NotFinite(t));
        }
        deviation = deviation.max(d);
    }
    Ok((points, deviation))
}

/// The spans in one curve, twice differentiable where the multiplicity of a joint is 3.
fn spline<const D: usize>(
    spans: &[Span<D>],
    joints: &[usize],
) -> Result<NurbsCurve<D>, CurveError> {
    let mut knots = Vec::new();
    let mut owner = Vec::new();
    for (k, (span, joint)) in spans.iter().zip(joints).enumerate() {
        let multiplicity = if k == 0 { 6 } else { *joint };
        knots.extend(std::iter::repeat_n(span.range[0], multiplicity));
        owner.extend(std::iter::repeat_n(k, multiplicity));
    }
    if let Some(last) = spans.last() {
        knots.extend([last.range[1]; 6]);
        owner.extend([spans.len() - 1; 6]);
    }
    let count = knots.len().saturating_sub(6);
    let points: Vec<SVector<f64, D>> = (0..count)
        .map(|i| {
            // A span under the function, near its middle.
            let end = knots[i + 6];
            let j = (i..=i + 3).rev().find(|&j| knots[j] < end).unwrap_or(i);
            let span = &spans[owner[j]];
            let [a, b] = span.range;
            let at = |k: usize| (knots[i + k] - a) / (b - a);
            blossom(&span.points, [at(1), at(2), at(3), at(4), at(5)])
        })
        .collect();
    NurbsCurve::new(5, knots, &points, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn circle(_: usize, t: f64) -> CurveJet<2> {
        let (s, c) = t.sin_cos();
        CurveJet {
            point: Vector2::new(c, s),
            d1: Vector2::new(-s, c),
            d2: Vector2::new(-c, -s),
        }
    }

    /// The unit circle by its angle: within the tolerance between the points that were checked, and with as many spans
    /// as the remainder asks for.
    #[test]
    fn circle_by_angle() {
        let mut counts = Vec::new();
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let (curve, deviation) = fit(&circle, &[0.0, 3.0], tolerance).unwrap();
            assert!(deviation <= tolerance);
            let mut found = 0.0f64;
            for k in 0..=1000 {
                let t = 0.003 * f64::from(k);
                found = found.max((curve.point(t) - circle(0, t).point).norm());
            }
            assert!(found <= 1.05 * tolerance, "{found:.2e} {tolerance:.0e}");
            let joint = curve.basis().span_range(0)[1];
            if curve.basis().span_count() > 1 {
                let (left, right) = (curve.jet(joint - 1e-9), curve.jet(joint + 1e-9));
                assert!((left.d2 - right.d2).norm() < 1e-6, "twice differentiable");
            }
            // Remainder of Hermite's interpolation: (h / 2)^6 / 6! times the sixth derivative, which is 1.
            let enough = (0..).map(|k| 1 << k).find(|&n| {
                let h: f64 = 3.0 / f64::from(n);
                (0.5 * h).powi(6) / 720.0 <= tolerance
            });
            counts.push(curve.basis().span_count());
            assert_eq!(counts.last().copied(), enough.map(|n| n as usize));
        }
        assert!(counts.windows(2).all(|c| c[1] == 2 * c[0]), "{counts:?}");
    }

    #[test]
    fn kinks_at_breaks_and_failures() {
        let kink = |interval: usize, t: f64| CurveJet {
            point: Vector2::new(t, (t - 1.0).abs()),
            d1: Vector2::new(1.0, if interval == 0 { -1.0 } else { 1.0 }),
            d2: Vector2::zeros(),
        };
        let (curve, deviation) = fit(&kink, &[0.0, 1.0, 3.0], 1e-12).unwrap();
        assert!(deviation < 1e-15 && curve.basis().span_count() == 2);
        assert!((curve.point(2.5) - Vector2::new(2.5, 1.5)).norm() < 1e-15);
        let step = |_: usize, t: f64| CurveJet {
            point: Vector2::new(t, if t < 1.0 / 3.0 { 0.0 } else { 1.0 }),
            d1: Vector2::new(1.0, 0.0),
            d2: Vector2::zeros(),
        };
        assert!(matches!(
            fit(&step, &[0.0, 1.0], 1e-3),
            Err(FitError::Tolerance { .. })
        ));
        let pole = |_: usize, t: f64| CurveJet {
            point: Vector2::new(1.0 / t, 0.0),
            d1: Vector2::zeros(),
            d2: Vector2::zeros(),
        };
        assert!(matches!(
            fit(&pole, &[0.0, 1.0], 1e-3),
            Err(FitError::NotFinite(_))
        ));
    }
}
