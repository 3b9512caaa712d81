//! Curves with the parameters that ISO 10303-42 gives them, and their parts as NURBS.

use crate::NurbsCurve;
use crate::curve::CurveError;
use crate::curve::conic::{elliptic_arc, hyperbolic_arc, parabolic_arc};
use nalgebra::SVector;
use std::f64::consts::TAU;
use std::rc::Rc;

type Point<const D: usize> = SVector<f64, D>;

/// A curve without ends, or with those that its definition gives it. Angles are in radians.
#[derive(Debug, Clone)]
pub enum Kind<const D: usize> {
    /// origin + t along
    Line {
        origin: Point<D>,
        along: Point<D>,
    },
    /// center + e1 cos t + e2 sin t
    Ellipse {
        center: Point<D>,
        e1: Point<D>,
        e2: Point<D>,
    },
    /// center + e1 cosh t + e2 sinh t
    Hyperbola {
        center: Point<D>,
        e1: Point<D>,
        e2: Point<D>,
    },
    /// center + e1 t + e2 t^2
    Parabola {
        center: Point<D>,
        e1: Point<D>,
        e2: Point<D>,
    },
    Spline(NurbsCurve<D>),
}

/// A part of a curve, run through from one parameter to another; backwards where the second is the lower one. On an ellipse
/// they may lie outside of 0 to 2 pi.
#[derive(Debug, Clone)]
pub struct Run<const D: usize> {
    pub kind: Rc<Kind<D>>,
    pub from: f64,
    pub to: f64,
    /// Number of the curve in the file.
    pub entity: u32,
}

/// A curve entity.
#[derive(Debug, Clone)]
pub enum Course<const D: usize> {
    /// A line, a conic or a spline as it is.
    Whole(Rc<Kind<D>>, u32),
    /// Parts one after the other, never none: trimmed and composite curves, and polylines.
    Runs(Vec<Run<D>>),
}

impl<const D: usize> Kind<D> {
    pub fn point(&self, t: f64) -> Point<D> {
        match self {
            Self::Line { origin, along } => origin + along * t,
            Self::Ellipse { center, e1, e2 } => center + e1 * t.cos() + e2 * t.sin(),
            Self::Hyperbola { center, e1, e2 } => center + e1 * t.cosh() + e2 * t.sinh(),
            Self::Parabola { center, e1, e2 } => center + e1 * t + e2 * (t * t),
            Self::Spline(curve) => curve.point(t),
        }
    }

    /// The parameter of the point of the curve nearest to `x` (on an ellipse from -pi to pi, and that of the same angle where
    /// `x` is not on it).
    pub fn parameter(&self, x: &Point<D>) -> f64 {
        let share = |d: Point<D>, e: &Point<D>| d.dot(e) / e.norm_squared();
        match self {
            Self::Line { origin, along } => share(x - origin, along),
            Self::Ellipse { center, e1, e2 } => {
                let d = x - center;
                share(d, e2).atan2(share(d, e1))
            }
            Self::Hyperbola { center, e2, .. } => share(x - center, e2).asinh(),
            Self::Parabola { center, e1, .. } => share(x - center, e1),
            Self::Spline(curve) => nearest(curve, x),
        }
    }

    /// The parameters between which the curve lies, where it has ends or comes back to its start.
    pub fn range(&self) -> Option<[f64; 2]> {
        match self {
            Self::Ellipse { .. } => Some([0.0, TAU]),
            Self::Spline(curve) => Some(curve.domain()),
            _ => None,
        }
    }

    /// The part from `a` up to `b` as a NURBS curve: of the same parameter but for ellipses and hyperbolas, where it agrees at
    /// the ends (and knots) only.
    pub fn part(&self, [a, b]: [f64; 2]) -> Result<NurbsCurve<D>, CurveError> {
        match self {
            Self::Line { .. } => {
                let ends = [self.point(a), self.point(b)];
                NurbsCurve::new(1, vec![a, a, b, b], &ends, None)
            }
            Self::Ellipse { center, e1, e2 } => elliptic_arc(*center, *e1, *e2, a, b),
            Self::Hyperbola { center, e1, e2 } => {
                // cosh t = sec(angle), sinh t = tan(angle).
                let angles = [a, b].map(|t| t.sinh().atan());
                let arc = hyperbolic_arc(*center, *e1, *e2, angles[0], angles[1])?;
                arc.with_parameters([a, b])
            }
            Self::Parabola { center, e1, e2 } => parabolic_arc(*center, *e1, *e2, a, b),
            Self::Spline(curve) if curve.domain() == [a, b] => Ok(curve.clone()),
            Self::Spline(curve) => curve.with_domain([a, b])?.refined(0, &[]),
        }
    }
}

/// Parameter of a spline's point nearest to `x`: Newton's method from the nearest of samples.
fn nearest<const D: usize>(curve: &NurbsCurve<D>, x: &Point<D>) -> f64 {
    let basis = curve.basis();
    let n = 2 * (basis.degree() + 1);
    let [a, b] = basis.domain();
    let samples = (0..basis.span_count()).flat_map(|span| {
        let [s, e] = basis.span_range(span);
        (0..n).map(move |k| s + (e - s) * (k as f64 / n as f64))
    });
    let distance = |t: f64| (curve.point(t) - x).norm_squared();
    let mut best = samples
        .chain([b])
        .map(|t| (distance(t), t))
        .min_by(|p, q| p.0.total_cmp(&q.0))
        .unwrap_or((0.0, a));
    let mut t = best.1;
    for _ in 0..30 {
        let jet = curve.jet(t);
        let d = jet.point - x;
        let full = jet.d1.norm_squared() + jet.d2.dot(&d);
        let bend = if full > 0.0 {
            full
        } else {
            jet.d1.norm_squared()
        };
        let next = (t - jet.d1.dot(&d) / bend).clamp(a, b);
        if !next.is_finite() || (next - t).abs() <= 1e-15 * (b - a) {
            break;
        }
        t = next;
        let here = (distance(t), t);
        if here.0 < best.0 {
            best = here;
        }
    }
    best.1
}

impl<const D: usize> Run<D> {
    pub fn ends(&self) -> [Point<D>; 2] {
        [self.kind.point(self.from), self.kind.point(self.to)]
    }

    pub fn reversed(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            ..self.clone()
        }
    }

    /// The part as a NURBS curve in its direction.
    pub fn curve(&self) -> Result<NurbsCurve<D>, CurveError> {
        if self.from <= self.to {
            self.kind.part([self.from, self.to])
        } else {
            self.kind.part([self.to, self.from])?.reversed()
        }
    }
}

impl<const D: usize> Course<D> {
    /// Its parts, where it has ends of its own or comes back to its start.
    pub fn runs(&self) -> Result<Vec<Run<D>>, String> {
        match self {
            Self::Runs(runs) => Ok(runs.clone()),
            Self::Whole(kind, entity) => match kind.range() {
                Some([from, to]) => Ok(vec![Run {
                    kind: Rc::clone(kind),
                    from,
                    to,
                    entity: *entity,
                }]),
                None => Err("it has no ends".to_owned()),
            },
        }
    }
}

/// The parts in the opposite direction.
pub fn backwards<const D: usize>(runs: &[Run<D>]) -> Vec<Run<D>> {
    runs.iter().rev().map(Run::reversed).collect()
}

/// The parts of a curve from the point `start` to the point `end`, along it where `forward`, else against it. `closed` says
/// that both are one point; points nearer than `near` are one as well. A spline that comes back to its start gives two parts
/// where its own start lies between.
pub fn between(
    course: &Course<3>,
    [start, end]: [Point<3>; 2],
    closed: bool,
    forward: bool,
    near: f64,
) -> Result<Vec<Run<3>>, String> {
    let (kind, entity) = match course {
        Course::Whole(kind, entity) => (Rc::clone(kind), *entity),
        Course::Runs(runs) => return along(runs, [start, end], closed, forward, near),
    };
    let run = |from: f64, to: f64| Run {
        kind: Rc::clone(&kind),
        from,
        to,
        entity,
    };
    let [t0, t1] = [start, end].map(|x| kind.parameter(&x));
    if let Some(x) = [t0, t1].iter().find(|t| !t.is_finite()) {
        return Err(format!("its end has the parameter {x}"));
    }
    let (a, b) = match (&*kind, kind.range()) {
        (Kind::Ellipse { e1, e2, .. }, _) => {
            let size = e1.norm().max(e2.norm());
            let whole = closed || (start - end).norm() <= 1e-9 * size;
            let (mut from, mut to) = (t0, if whole { t0 } else { t1 });
            if forward && to <= from {
                to += TAU;
            } else if !forward && to >= from {
                from += TAU;
            }
            return Ok(vec![run(from, to)]);
        }
        (_, Some([a, b])) => (a, b),
        (_, None) if t0 == t1 => return Err("it has no length".to_owned()),
        // Lines, parabolas and hyperbolas: the ends say all.
        (_, None) => return Ok(vec![run(t0, t1)]),
    };
    let ends = [kind.point(a), kind.point(b)];
    let round = (ends[0] - ends[1]).norm() <= near;
    // Ends of the curve count as such within what counts as one point.
    let snap = |t: f64, x: &Point<3>| {
        let at = [a, b].into_iter().zip(ends);
        let nearest = at
            .map(|(end, y)| ((y - x).norm(), end))
            .min_by(|p, q| p.0.total_cmp(&q.0));
        match nearest {
            Some((distance, end)) if distance <= near => end,
            _ => t,
        }
    };
    let (mut t0, mut t1) = (snap(t0, &start), snap(t1, &end));
    // Which of its two ends a point of a closed curve is.
    if round {
        let (low, high) = if forward {
            (&mut t0, &mut t1)
        } else {
            (&mut t1, &mut t0)
        };
        if *low == b {
            *low = a;
        }
        if *high == a {
            *high = b;
        }
    }
    if (t0 < t1) == forward && t0 != t1 {
        return Ok(vec![run(t0, t1)]);
    }
    if !round {
        return match t0 == t1 {
            true => Err("it has no length between its vertices".to_owned()),
            // The flag contradicts the vertices, which count.
            false => Ok(vec![run(t0, t1)]),
        };
    }
    let over = if forward {
        vec![run(t0, b), run(a, t1)]
    } else {
        vec![run(t0, a), run(b, t1)]
    };
    let long = |r: &Run<3>| (r.from - r.to).abs() > 1e-12 * (b - a);
    Ok(over.into_iter().filter(long).collect())
}

/// A trimmed or composite curve between its own ends, which must be the points given.
fn along(
    runs: &[Run<3>],
    [start, end]: [Point<3>; 2],
    closed: bool,
    forward: bool,
    near: f64,
) -> Result<Vec<Run<3>>, String> {
    let (Some(first), Some(last)) = (runs.first(), runs.last()) else {
        return Err("it has no parts".to_owned());
    };
    let own = [first.ends()[0], last.ends()[1]];
    let off = |[a, b]: [Point<3>; 2]| (a - start).norm().max((b - end).norm());
    let (ahead, back) = (off(own), off([own[1], own[0]]));
    if let [run] = runs
        && ahead.min(back) > near
    {
        // The vertices lie within it, or beyond its ends.
        let whole = Course::Whole(Rc::clone(&run.kind), run.entity);
        return between(
            &whole,
            [start, end],
            closed,
            forward == (run.from < run.to),
            near,
        );
    }
    let round = (own[0] - own[1]).norm() <= near;
    let same = if round { forward } else { ahead <= back };
    Ok(if same { runs.to_vec() } else { backwards(runs) })
}
