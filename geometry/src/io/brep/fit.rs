//! Curves in the parameter plane that follow a given path there: straight lines where it is one, else cubic Hermite pieces,
//! halved until they keep to it.

use super::host::{Host, Xi};
use crate::NurbsCurve;
use crate::basis::{Basis, MAX_DEGREE};
use crate::curve::CurveError;

/// A path in the parameter plane: its point at `t`, as near to the second argument as periods allow.
pub type Path<'p> = dyn FnMut(f64, Xi) -> Result<Xi, String> + 'p;

/// A curve, and how far it leaves the path (a length in space).
pub struct Fitted {
    pub curve: NurbsCurve<2>,
    pub error: f64,
}

/// Points per smooth piece at which the path is followed before anything is fitted.
const SAMPLES: usize = 16;
/// Halvings of one of these steps.
const DEPTH: usize = 14;

/// Cubic Bezier pieces one after the other.
struct Pieces {
    breaks: Vec<f64>,
    /// Three more than three times the pieces: inner ends are shared.
    points: Vec<Xi>,
    straight: bool,
    error: f64,
}

/// Fits a path over the smooth pieces between `breaks` within `tolerance`, a length in space.
pub fn fit(
    host: &Host,
    breaks: &[f64],
    path: &mut Path,
    start: Xi,
    tolerance: f64,
) -> Result<Fitted, String> {
    let mut out = Pieces {
        breaks: vec![breaks[0]],
        points: Vec::new(),
        straight: true,
        error: 0.0,
    };
    let mut near = start;
    for pair in breaks.windows(2) {
        near = smooth(host, [pair[0], pair[1]], path, near, tolerance, &mut out)?;
    }
    let error = out.error;
    let curve = out.curve().map_err(|e| e.to_string())?;
    Ok(Fitted { curve, error })
}

/// One smooth piece; returns where it ends.
fn smooth(
    host: &Host,
    [a, b]: [f64; 2],
    path: &mut Path,
    near: Xi,
    tolerance: f64,
    out: &mut Pieces,
) -> Result<Xi, String> {
    let mut nodes = Vec::with_capacity(SAMPLES + 1);
    let mut last = near;
    for k in 0..=SAMPLES {
        let t = match k {
            SAMPLES => b,
            _ => a + (b - a) * (k as f64 / SAMPLES as f64),
        };
        last = path(t, last)?;
        nodes.push((t, last));
    }
    if let Some((ends, error)) = line(host, &nodes, tolerance) {
        out.push(
            b,
            ends[0],
            ends[0].lerp(&ends[1], 1.0 / 3.0),
            ends[0].lerp(&ends[1], 2.0 / 3.0),
            ends[1],
        );
        out.error = out.error.max(error);
        return Ok(ends[1]);
    }
    out.straight = false;
    for pair in nodes.windows(2) {
        halve(host, [pair[0], pair[1]], path, tolerance, 0, out)?;
    }
    Ok(last)
}

/// The path as a straight line along a constant parameter, if it is one: its ends, and how far it leaves the path.
fn line(host: &Host, nodes: &[(f64, Xi)], tolerance: f64) -> Option<([Xi; 2], f64)> {
    (0..2).find_map(|d| {
        let mut value = nodes.iter().map(|n| n.1[d]).sum::<f64>() / nodes.len() as f64;
        let error = |value: f64| {
            let moved = nodes.iter().map(|&(_, xi)| {
                let mut on = xi;
                on[d] = value;
                (host.point(xi) - host.point(on)).norm()
            });
            moved.fold(0.0, f64::max)
        };
        let along: Vec<f64> = nodes.iter().map(|n| n.1[1 - d]).collect();
        let (up, down) = (
            along.windows(2).all(|w| w[1] >= w[0]),
            along.windows(2).all(|w| w[1] <= w[0]),
        );
        // Parameters of one line do not spread over the domain, even where that costs nothing (at a pole).
        let spread = nodes
            .iter()
            .map(|n| (n.1[d] - value).abs())
            .fold(0.0, f64::max);
        if !(up || down) || spread > 1e-3 * host.extent(d) || error(value) > tolerance {
            return None;
        }
        // The border exactly, where that is as good.
        for border in host.domain[d] {
            let border = match host.closed[d] {
                true => border + host.extent(d) * ((value - border) / host.extent(d)).round(),
                false => border,
            };
            if (value - border).abs() < 1e-6 * host.extent(d) && error(border) <= tolerance {
                value = border;
            }
        }
        let mut ends = [nodes[0].1, nodes[nodes.len() - 1].1];
        for end in &mut ends {
            end[d] = value;
        }
        Some((ends, error(value)))
    })
}

/// A cubic that has the path's ends and tangents, or two for the halves.
fn halve(
    host: &Host,
    [(a, start), (b, end)]: [(f64, Xi); 2],
    path: &mut Path,
    tolerance: f64,
    depth: usize,
    out: &mut Pieces,
) -> Result<(), String> {
    let h = 2e-4 * (b - a);
    // Three-point formula from inside of the piece, for the path may have a kink at its ends.
    let mut third = |t: f64, x: Xi, h: f64| -> Result<Xi, String> {
        let x1 = path(t + h, x)?;
        let x2 = path(t + 2.0 * h, x1)?;
        Ok(x + (x1 * 4.0 - x2 - x * 3.0) * ((b - a) / (6.0 * h.abs())))
    };
    let p = [start, third(a, start, h)?, third(b, end, -h)?, end];
    let mut worst = 0.0f64;
    let mut middle = start;
    for k in 1..4 {
        let s = f64::from(k) / 4.0;
        let r = 1.0 - s;
        let x = p[0] * (r * r * r)
            + p[1] * (3.0 * r * r * s)
            + p[2] * (3.0 * r * s * s)
            + p[3] * (s * s * s);
        let on = path(a + (b - a) * s, start.lerp(&end, s))?;
        if k == 2 {
            middle = on;
        }
        let error = (host.point(x) - host.point(on)).norm();
        worst = if error.is_nan() {
            f64::INFINITY
        } else {
            worst.max(error)
        };
    }
    if worst <= tolerance || depth == DEPTH {
        // Said at the first piece: the others would each be halved as often.
        if worst > 100.0 * tolerance {
            return Err(format!(
                "a border curve cannot be followed on the surface: {worst:.1e} remain (allowed {tolerance:.1e})"
            ));
        }
        host.grant.piece()?;
        out.push(b, p[0], p[1], p[2], p[3]);
        out.error = out.error.max(worst);
        return Ok(());
    }
    let m = 0.5 * (a + b);
    halve(
        host,
        [(a, start), (m, middle)],
        path,
        tolerance,
        depth + 1,
        out,
    )?;
    halve(
        host,
        [(m, middle), (b, end)],
        path,
        tolerance,
        depth + 1,
        out,
    )
}

impl Pieces {
    fn push(&mut self, to: f64, p0: Xi, p1: Xi, p2: Xi, p3: Xi) {
        self.breaks.push(to);
        if self.points.is_empty() {
            self.points.push(p0);
        }
        self.points.extend([p1, p2, p3]);
    }

    fn curve(&self) -> Result<NurbsCurve<2>, CurveError> {
        let degree = if self.straight { 1 } else { 3 };
        let step = 3 / degree;
        let mut knots = vec![self.breaks[0]; degree + 1];
        for &t in &self.breaks[1..] {
            knots.extend(std::iter::repeat_n(t, degree));
        }
        knots.push(self.breaks[self.breaks.len() - 1]);
        let points: Vec<Xi> = self.points.iter().step_by(step).copied().collect();
        NurbsCurve::new(degree, knots, &points, None)
    }
}

/// The parameters between which a curve is smooth: its ends and the knots repeated `degree` times.
pub fn smooth_breaks(basis: &Basis) -> Vec<f64> {
    let [a, b] = basis.domain();
    let mut breaks = vec![a];
    breaks.extend(basis.crease_knots());
    breaks.push(b);
    debug_assert!(basis.degree() <= MAX_DEGREE);
    breaks
}
