//! Closest point within a rectangle of one facet: safeguarded Newton iteration with active bounds.

use super::net::jet;
use crate::project::downhill::Downhill;
use crate::surface::{Jet, Vec3};

/// The whole facet.
pub(super) const ALL: [[f64; 2]; 2] = [[-1.0, 1.0]; 2];

/// Relative residual of a finished foot.
const FINE: f64 = 1e-12;
const ITERATIONS: usize = 60;
/// Halvings of a step before it is given up.
const HALVINGS: usize = 12;
/// Share of the predicted decrease that a step must reach (Armijo).
const ARMIJO: f64 = 1e-4;

/// A point of a rectangle of parameters as the iteration sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    pub xi: [f64; 2],
    pub jet: Jet,
    /// `q - rho`, and its square.
    pub d: Vec3,
    pub d2: f64,
    /// Gradient `-rho_i . d` of half the squared distance.
    pub gradient: [f64; 2],
    /// Hessian `a_ij - rho_ij . d`: 11, 12, 22.
    pub hessian: [f64; 3],
    /// Metric a_11, a_12, a_22.
    pub metric: [f64; 3],
    /// -1 on the lower bound, +1 on the upper bound, else 0.
    pub at: [i8; 2],
    /// Whether the bound holds the point: the distance would fall across it.
    pub active: [bool; 2],
    pub converged: bool,
    /// Whether the rectangle was the whole facet.
    pub whole: bool,
}

/// What the iteration works on: a facet's net, the query, the rectangle, and the length that tolerances are relative to.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub net: &'a [[f64; 4]],
    pub q: &'a Vec3,
    pub range: [[f64; 2]; 2],
    pub size: f64,
    /// Whether the net has weights.
    pub rational: bool,
}

impl Problem<'_> {
    /// Evaluates at `xi`, moved into the rectangle.
    #[inline]
    pub fn at<const M: usize>(&self, xi: [f64; 2]) -> Local {
        let mut x = xi;
        let mut at = [0; 2];
        for k in 0..2 {
            let [low, high] = self.range[k];
            if x[k] <= low {
                (x[k], at[k]) = (low, -1);
            } else if x[k] >= high {
                (x[k], at[k]) = (high, 1);
            }
        }
        let jet = jet::<M>(self.net, x, self.rational);
        let d = self.q - jet.rho;
        let [r1, r2] = &jet.rho_i;
        let gradient = [-r1.dot(&d), -r2.dot(&d)];
        let metric = [r1.dot(r1), r1.dot(r2), r2.dot(r2)];
        let hessian = [0, 1, 2].map(|k| metric[k] - jet.rho_ij[k].dot(&d));
        let held = |k: usize| {
            let [low, high] = self.range[k];
            low == high || at[k] < 0 && gradient[k] > 0.0 || at[k] > 0 && gradient[k] < 0.0
        };
        let active = [held(0), held(1)];
        Local {
            xi: x,
            d2: d.norm_squared(),
            jet,
            d,
            gradient,
            hessian,
            metric,
            at,
            active,
            converged: false,
            whole: self.range == ALL,
        }
    }

    /// Iterates from `xi` to a point where the distance is stationary within the rectangle, then takes undamped steps as far
    /// as they help.
    pub fn solve<const M: usize>(&self, xi: [f64; 2]) -> Local {
        let mut s = self.at::<M>(xi);
        for _ in 0..ITERATIONS {
            if self.stationary(&s, FINE) {
                s.converged = true;
                break;
            }
            let newton = undamped_step(&s);
            let mut step = self.bounded(&s, newton.unwrap_or_else(|| damped_step(&s)));
            let mut slope = s.gradient[0] * step[0] + s.gradient[1] * step[1];
            if slope >= 0.0 || !slope.is_finite() {
                step = self.bounded(&s, s.downhill().diagonal_step());
                slope = s.gradient[0] * step[0] + s.gradient[1] * step[1];
            }
            // Below the noise the distances that are compared differ by rounding only.
            let accepted = |next: &Local, factor: f64| {
                next.d2 <= s.d2 + 2.0 * ARMIJO * factor * slope
                    || next.d2 <= s.d2 + 1e-14 * (s.d2 + self.size * self.size)
                        && next.residual2() <= s.residual2()
            };
            let mut factor = 1.0;
            let mut next = self.at::<M>(moved(&s, step, 1.0));
            let mut tries = 0;
            while !accepted(&next, factor) {
                tries += 1;
                if tries > HALVINGS {
                    // Nothing to gain that the distance could show.
                    s.converged = self.stationary(&s, 1e3 * FINE);
                    return s;
                }
                factor *= 0.5;
                next = self.at::<M>(moved(&s, step, factor));
            }
            if next.xi == s.xi {
                s.converged = self.stationary(&s, 1e3 * FINE);
                return s;
            }
            s = next;
        }
        s
    }

    /// Undamped Newton steps as far as they help.
    pub fn refine<const M: usize>(&self, s: &mut Local) {
        for _ in 0..2 {
            let Some(step) = undamped_step(s) else {
                return;
            };
            // What the last step left is rounding.
            if step.iter().all(|x| x.abs() <= 1e-14) {
                return;
            }
            let next = self.at::<M>(moved(s, step, 1.0));
            if next.active != s.active || next.residual2() >= s.residual2() {
                return;
            }
            *s = Local {
                converged: s.converged,
                ..next
            };
        }
    }

    /// Whether `|rho_i . d| <= tolerance |rho_i| max(|d|, size)` in every direction that is free.
    #[inline]
    fn stationary(&self, s: &Local, tolerance: f64) -> bool {
        s.residual2() <= tolerance * tolerance * s.d2.max(self.size * self.size)
    }

    /// Shortens a step to the bounds: a direction that would leave stops there and the other is solved for again.
    #[inline]
    fn bounded(&self, s: &Local, step: [f64; 2]) -> [f64; 2] {
        let clamp = |k: usize, x: f64| {
            let [low, high] = self.range[k];
            (s.xi[k] + x).clamp(low, high) - s.xi[k]
        };
        let cut = [clamp(0, step[0]), clamp(1, step[1])];
        // Not by the lengths: a start within rounding of a bound leaves a step along it rounded just as much.
        let stopped = |k: usize| {
            let [low, high] = self.range[k];
            s.xi[k] + step[k] < low || s.xi[k] + step[k] > high
        };
        let mut out = cut;
        for (k, cut) in cut.into_iter().enumerate() {
            let other = 1 - k;
            let f = s.hessian[2 * other];
            if stopped(k) && !stopped(other) && !s.active[other] && f > 0.0 {
                out[other] = clamp(other, -(s.gradient[other] + s.hessian[1] * cut) / f);
            }
        }
        out
    }
}

impl Local {
    /// What a Newton step is made from.
    #[inline]
    fn downhill(&self) -> Downhill<'_> {
        Downhill {
            gradient: &self.gradient,
            metric: &self.metric,
            active: self.active,
        }
    }

    /// Largest `(rho_i . d / |rho_i|)^2` of the free directions.
    #[inline]
    fn residual2(&self) -> f64 {
        let one = |k: usize| {
            let length2 = self.metric[2 * k];
            // A direction of no length says nothing.
            if self.active[k] || length2 <= f64::MIN_POSITIVE {
                0.0
            } else {
                self.gradient[k] * self.gradient[k] / length2
            }
        };
        let (a, b) = (one(0), one(1));
        // Numbers that are not stay visible.
        if a.is_nan() || a > b { a } else { b }
    }

    /// Whether the Hessian over the metric has an eigenvalue of (nearly) zero, or below it, in the free directions:
    /// `1 - xi3 kappa` of one of the principal curvatures.
    pub fn focal(&self) -> bool {
        let (f, a) = (&self.hessian, &self.metric);
        let flat = |value: f64, largest: f64| value <= 1e-7 * largest.max(1.0);
        match self.active {
            [true, true] => false,
            [false, true] => a[0] > 0.0 && flat(f[0] / a[0], 0.0),
            [true, false] => a[2] > 0.0 && flat(f[2] / a[2], 0.0),
            [false, false] => match spectrum(f, a) {
                Some((mean, radius)) => flat(mean - radius, mean + radius),
                None => false,
            },
        }
    }
}

fn moved(s: &Local, step: [f64; 2], factor: f64) -> [f64; 2] {
    [s.xi[0] + factor * step[0], s.xi[1] + factor * step[1]]
}

/// Mean and half difference of the eigenvalues of `f` over the metric; `None` where the tangents span no plane.
fn spectrum(f: &[f64; 3], a: &[f64; 3]) -> Option<(f64, f64)> {
    let det = a[0] * a[2] - a[1] * a[1];
    if det.is_nan() || det <= 1e-20 * a[0] * a[2] {
        return None;
    }
    let mean = 0.5 * (f[0] * a[2] - 2.0 * f[1] * a[1] + f[2] * a[0]) / det;
    let product = (f[0] * f[2] - f[1] * f[1]) / det;
    Some((mean, (mean * mean - product).max(0.0).sqrt()))
}

/// Newton step, or `None` where the Hessian is not positive definite.
#[inline]
fn undamped_step(s: &Local) -> Option<[f64; 2]> {
    s.downhill().solve(&s.hessian)
}

/// Step where the Hessian is not positive definite: shifted by so much of the metric that it is.
#[cold]
fn damped_step(s: &Local) -> [f64; 2] {
    let shifted = |lowest: f64, size: f64| {
        let shift = 0.1 * size.max(1.0) - lowest;
        [0, 1, 2].map(|k| s.hessian[k] + shift * s.metric[k])
    };
    let form = match s.active {
        [false, false] => {
            spectrum(&s.hessian, &s.metric).map(|(mean, r)| shifted(mean - r, mean.abs() + r))
        }
        _ => None,
    };
    form.and_then(|form| s.downhill().solve(&form))
        .or_else(|| s.downhill().solve(&s.metric))
        .unwrap_or_else(|| s.downhill().diagonal_step())
}

#[cfg(test)]
mod tests {
    use crate::moving::{MovingFacets, MovingPlace};
    use crate::project::{Hint, Status};
    use crate::surface::Vec3;

    /// A point beyond the border of a slightly warped facet, from the last number within the border.
    #[test]
    fn a_start_within_rounding_of_a_border_ends_on_it() {
        let facets: [(&[u32], [u8; 2]); 1] = [(&[0, 1, 2, 3], [2, 2])];
        let mut set = MovingFacets::new(&facets).unwrap();
        let corners = [
            Vec3::new(7.859805786579753, -0.002153071489213154, 3.858225415623029),
            Vec3::new(9.003854949097022, -0.0031804268722559225, 3.861012482092053),
            Vec3::new(7.85995460970505, 1.3325916594609295, 3.8572376065089706),
            Vec3::new(9.00393699329664, 1.3324213599901187, 3.8596992211937984),
        ];
        set.update(|k| corners[k as usize]);
        let q = Vec3::new(8.754040211874983, -0.005077594553957267, 3.8702171102286487);
        let hint = Hint {
            patch: 0,
            xi: [0.5633248393647138, -1.0 + f64::EPSILON],
        };
        let far = set.project(&q, None, 1.0, |_| true).unwrap();
        let near = set.project(&q, Some(hint), 1.0, |_| true).unwrap();
        for foot in [&far, &near] {
            assert_eq!(foot.status, Status::Unique);
            assert!(matches!(foot.place, MovingPlace::Edge { .. }));
            assert_eq!(foot.xi[1], -1.0);
            assert!((foot.xi[0] - far.xi[0]).abs() < 1e-13);
        }
    }
}
