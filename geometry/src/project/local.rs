//! Closest point within a smooth region of one patch: safeguarded Newton iteration with active bounds.

mod steps;

use super::PatchSet;
use super::downhill::Downhill;
use super::search::ROUGH;
use crate::surface::{Jet, Surface, Vec3};
use steps::{bounded, damped_step, moved, step_to_make, undamped_step};

/// Part of a patch between knot lines in which the surface is smooth (or simply one piece of it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Region {
    pub patch: u32,
    /// Span numbers, first and one past the last, of each direction.
    pub spans: [[usize; 2]; 2],
    /// Parameters, `[direction][start, end]`; start and end may be equal (a search along an edge).
    pub domain: [[f64; 2]; 2],
}

/// State of the iteration at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    pub region: Region,
    pub xi: [f64; 2],
    pub span: [usize; 2],
    pub jet: Jet,
    /// Squared distance.
    pub d2: f64,
    /// Gradient `-rho_i . d` of half the squared distance, `d = q - rho`.
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
    /// Where on the trim the point lies, if on its border.
    pub trim: Option<TrimPlace>,
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

    /// Nowhere yet.
    #[inline]
    fn in_region(region: &Region) -> Local {
        let zero = Vec3::new(0.0, 0.0, 0.0);
        Local {
            region: *region,
            xi: [0.0; 2],
            span: [0; 2],
            jet: Jet {
                rho: zero,
                rho_i: [zero; 2],
                rho_ij: [zero; 3],
            },
            d2: f64::INFINITY,
            gradient: [0.0; 2],
            hessian: [0.0; 3],
            metric: [0.0; 3],
            at: [0; 2],
            active: [false; 2],
            converged: false,
            trim: None,
        }
    }
}

/// A point of a trim curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TrimPlace {
    /// Number of the curve among all curves of the patch's trim, loop after loop.
    pub curve: u32,
    /// Parameter of the curve.
    pub t: f64,
    /// -1 at the start of the curve, +1 at its end, else 0.
    pub end: i8,
    /// Whether the distance hardly changes along the curve near the point.
    pub focal: bool,
}

const ITERATIONS: usize = 40;
/// Halvings of a step before it is given up: enough for weights that change the surface within a millionth of its domain.
const HALVINGS: usize = 30;
/// Share of the predicted decrease that a step must reach (Armijo).
const ARMIJO: f64 = 1e-4;

impl<S: Surface> PatchSet<S> {
    /// Evaluates at `xi`, which is moved into the region; `span` is where to look for the span first.
    #[inline]
    pub(super) fn state(&self, q: &Vec3, region: &Region, xi: [f64; 2], span: [usize; 2]) -> Local {
        let mut s = Local::in_region(region);
        self.evaluate(q, xi, span, &mut s);
        s
    }

    /// [`state`](Self::state) in place, within the region of `s`.
    fn evaluate(&self, q: &Vec3, xi: [f64; 2], mut span: [usize; 2], s: &mut Local) {
        let region = &s.region;
        let grid = &self.grids[region.patch as usize];
        let mut x = xi;
        let mut at = [0; 2];
        for k in 0..2 {
            let [low, high] = region.domain[k];
            if x[k] <= low {
                (x[k], at[k]) = (low, -1);
            } else if x[k] >= high {
                (x[k], at[k]) = (high, 1);
            }
            let [first, end] = region.spans[k];
            let breaks = &grid.breaks[k];
            span[k] = span[k].clamp(first, end - 1);
            while span[k] + 1 < end && x[k] >= breaks[span[k] + 1] {
                span[k] += 1;
            }
            while span[k] > first && x[k] < breaks[span[k]] {
                span[k] -= 1;
            }
        }
        s.jet = self.patches[region.patch as usize].jet_in_span(span, x);
        let d = q - s.jet.rho;
        let [r1, r2] = &s.jet.rho_i;
        let gradient = [-r1.dot(&d), -r2.dot(&d)];
        let metric = [r1.dot(r1), r1.dot(r2), r2.dot(r2)];
        s.hessian = [0, 1, 2].map(|k| metric[k] - s.jet.rho_ij[k].dot(&d));
        let held = |k: usize| {
            let [low, high] = s.region.domain[k];
            at[k] != 0
                && (low == high || at[k] < 0 && gradient[k] > 0.0 || at[k] > 0 && gradient[k] < 0.0)
        };
        s.active = [held(0), held(1)];
        s.xi = x;
        s.span = span;
        s.d2 = d.norm_squared();
        s.gradient = gradient;
        s.metric = metric;
        s.at = at;
        s.converged = false;
        s.trim = None;
    }

    /// Whether `|rho_i . d| <= tolerance |rho_i| max(|d|, size)` in every direction that is free, or below the rounding
    /// of `rho_i` (near poles it is a difference of large terms).
    #[inline]
    fn stationary(&self, s: &Local, tolerance: f64) -> bool {
        let floor = 2e-15 / tolerance;
        let tolerance = if tolerance < 5e-12 {
            self.attainable(s).clamp(tolerance, 5e-12)
        } else {
            tolerance
        };
        let limit = tolerance * tolerance * s.d2.max(self.size * self.size);
        let scale = &self.grids[s.region.patch as usize].scale;
        let mut short = false;
        for (k, scale) in scale.iter().enumerate() {
            let (length2, least) = (s.metric[2 * k], floor * floor * scale * scale);
            let ends = s.gradient[k] * s.gradient[k] <= limit * length2.max(least);
            if !s.active[k] && !ends {
                return false;
            }
            short |= !s.active[k] && length2 < least;
        }
        !short || self.is_lost_in_rounding(s, floor, limit)
    }

    /// Whether the slope at a point with a short tangent is below rounding also by the bounds of the cell that it lies in:
    /// where weights spread over orders of magnitude, tangents differ as much without any pole.
    #[cold]
    #[inline(never)]
    fn is_lost_in_rounding(&self, s: &Local, floor: f64, limit: f64) -> bool {
        let patch = s.region.patch;
        let piece = self.piece(self.piece_number(patch, s.span, s.xi));
        (0..2).all(|k| {
            let [a, b] = piece.domain[k];
            // Rounding comes from the neighbourhood, which is a little larger than the cell.
            let scale = (8.0 * piece.scale[k] / (b - a)).min(self.grids[patch as usize].scale[k]);
            let length2 = s.metric[2 * k].max(floor * floor * scale * scale);
            s.active[k] || s.gradient[k] * s.gradient[k] <= limit * length2
        })
    }

    /// Whether a search may stop at a point from which the full step with this slope would gain less than 1e-12 of the
    /// size in distance, a tenth of what its proofs leave out. Only next to a stationary point, where the step tells.
    #[inline]
    fn nothing_to_gain(&self, s: &Local, slope: f64) -> bool {
        // A full step lowers half of the squared distance by half of the slope.
        let gain = 2e-12 * self.size;
        slope <= 0.0
            && slope * slope <= gain * gain * s.d2
            && self.residual2(s, 2e-3) <= 1e-12 * s.d2.max(self.size * self.size)
    }

    /// Tolerance that can be hoped for: next to a pole the turning parameter drowns in rounding, and with it some digits
    /// of the residual, more the shorter its tangent is.
    #[inline]
    fn attainable(&self, s: &Local) -> f64 {
        let scale = &self.grids[s.region.patch as usize].scale;
        let one = |k: usize| s.metric[2 * k] / (scale[k] * scale[k]);
        1e-15 / one(0).min(one(1)).sqrt()
    }

    /// Largest `(rho_i . d / |rho_i|)^2` of the free directions, `|rho_i|` no less than `floor` times its bound.
    #[inline]
    fn residual2(&self, s: &Local, floor: f64) -> f64 {
        let scale = &self.grids[s.region.patch as usize].scale;
        let one = |k: usize| {
            let length2 = s.metric[2 * k].max(floor * floor * scale[k] * scale[k]);
            if s.active[k] {
                0.0
            } else {
                s.gradient[k] * s.gradient[k] / length2
            }
        };
        one(0).max(one(1))
    }

    /// Iterates from `xi` to a point where the distance is stationary within `region`.
    #[inline]
    pub(super) fn descend(
        &self,
        q: &Vec3,
        region: &Region,
        xi: [f64; 2],
        span: [usize; 2],
        tolerance: f64,
    ) -> Local {
        let mut s = Local::in_region(region);
        self.evaluate(q, xi, span, &mut s);
        self.iterate(q, &mut s, tolerance);
        s
    }

    /// Iterates from a point, in place.
    #[inline]
    fn iterate(&self, q: &Vec3, s: &mut Local, tolerance: f64) {
        let mut other = Local::in_region(&s.region);
        if self.iterate_between(q, [s, &mut other], tolerance) {
            *s = other;
        }
    }

    /// Iterates from the first of two points, with room for the next one in the second; whether that is the last one.
    fn iterate_between(&self, q: &Vec3, [first, second]: [&mut Local; 2], tolerance: f64) -> bool {
        let mut now = false;
        let mut escapes = 0;
        let rough = tolerance >= ROUGH;
        for _ in 0..ITERATIONS {
            let (s, next) = match now {
                false => (&mut *first, &mut *second),
                true => (&mut *second, &mut *first),
            };
            if self.stationary(s, tolerance) {
                s.converged = true;
                if escapes < 2
                    && (s.active[0] || s.active[1])
                    && let Some(out) = self.escape_pole(q, s, tolerance)
                {
                    escapes += 1;
                    *s = out;
                } else {
                    return now;
                }
            }
            let newton = undamped_step(s);
            let mut step = bounded(s, newton.unwrap_or_else(|| damped_step(s)));
            let mut slope = s.gradient[0] * step[0] + s.gradient[1] * step[1];
            if rough && newton.is_some() && self.nothing_to_gain(s, slope) {
                s.converged = true;
                return now;
            }
            if slope >= 0.0 || !slope.is_finite() {
                step = bounded(s, s.downhill().diagonal_step());
                slope = s.gradient[0] * step[0] + s.gradient[1] * step[1];
            }
            self.evaluate(q, moved(s, step, 1.0), s.span, next);
            let mut factor = 1.0;
            let mut tries = 0;
            // Below the noise the distances that are compared differ by rounding only.
            let accepted = |next: &Local, factor: f64| {
                next.d2 <= s.d2 + 2.0 * ARMIJO * factor * slope
                    || next.d2 <= s.d2 + 1e-14 * (s.d2 + s.jet.rho.norm_squared())
                        && self.residual2(next, 2e-3) <= self.residual2(s, 2e-3)
            };
            while !accepted(next, factor) {
                tries += 1;
                if tries > HALVINGS {
                    return now;
                }
                factor *= 0.5;
                self.evaluate(q, moved(s, step, factor), s.span, next);
            }
            if next.xi == s.xi {
                // No representable progress.
                s.converged = self.stationary(s, tolerance.max(1e-9));
                return now;
            }
            now = !now;
        }
        now
    }

    /// Whether the slopes of the distance are below 1e-12 of the size in both directions, those that bounds hold included.
    /// Never next to a pole, where rounding hides the slope of the direction that turns about it.
    pub(super) fn flat(&self, s: &Local) -> bool {
        let scale = &self.grids[s.region.patch as usize].scale;
        let limit = 1e-12 * self.size;
        (0..2).all(|k| {
            s.metric[2 * k] > 1e-12 * scale[k] * scale[k]
                && s.gradient[k] * s.gradient[k] <= limit * limit * s.metric[2 * k]
        })
    }

    /// Whether a point lies on a pole or within about 1e-8 of the patch's width of it, and in which direction the parameter
    /// turns about it.
    #[inline]
    pub(super) fn near_pole(&self, s: &Local) -> Option<usize> {
        let scale = &self.grids[s.region.patch as usize].scale;
        (0..2).find(|&k| s.metric[2 * k] <= 1e-16 * scale[k] * scale[k])
    }

    /// On a pole every value of the turning parameter is the same point, but the way out differs: takes the value
    /// (of nine in the region) from which the distance falls most, if it falls from any. An edge that is merely slow here,
    /// as weights over many orders of magnitude make it, is no pole: other values are other points.
    #[cold]
    #[inline(never)]
    fn escape_pole(&self, q: &Vec3, s: &Local, tolerance: f64) -> Option<Local> {
        let turn = self.near_pole(s)?;
        let out = 1 - turn;
        if !s.active[out] {
            return None;
        }
        let [a, b] = s.region.domain[turn];
        let same = (ROUGH * self.size) * (ROUGH * self.size);
        let mut best: Option<(f64, Local)> = None;
        for k in 0..9 {
            let mut xi = s.xi;
            xi[turn] = a + (b - a) * f64::from(k) / 8.0;
            let t = self.state(q, &s.region, xi, s.span);
            let slope = t.gradient[out].abs() / t.metric[2 * out].sqrt();
            if !t.active[out]
                && (t.jet.rho - s.jet.rho).norm_squared() <= same
                && slope > tolerance * t.d2.sqrt().max(self.size)
                && best.as_ref().is_none_or(|b| slope > b.0)
            {
                best = Some((slope, t));
            }
        }
        best.map(|b| b.1)
    }

    /// Brings a point to machine precision within its region: undamped Newton steps if it is converged roughly, and where
    /// it is not or they do not suffice, the safeguarded iteration before them. The result converges as `converged` says.
    /// On a trimmed patch a point stops at the trim.
    pub(super) fn polish(&self, q: &Vec3, mut s: Local) -> Local {
        self.polish_in_place(q, &mut s);
        s
    }

    /// See [`polish`](Self::polish).
    #[inline]
    pub(super) fn polish_in_place(&self, q: &Vec3, s: &mut Local) {
        let trimmed = self.patches[s.region.patch as usize].trim().is_some();
        if trimmed && s.trim.is_some() {
            *s = self.polish_on_trim(q, *s);
            return;
        }
        self.polish_face(q, s);
        if trimmed {
            *s = self.stopped_by_trim(q, *s);
        }
    }

    /// [`polish`](Self::polish) of a point that no trim holds, whatever the trim of its patch.
    pub(super) fn polish_face(&self, q: &Vec3, s: &mut Local) {
        if s.converged {
            let (xi, span) = (s.xi, s.span);
            self.refine(q, s);
            if self.stationary(s, 1e-12) {
                return;
            }
            *s = self.descend(q, &s.region, xi, span, 1e-12);
        } else {
            self.iterate(q, s, 1e-12);
        }
        self.refine(q, s);
        let tolerance = self.attainable(s).clamp(1e-12, 1e-9);
        s.converged = s.converged || self.stationary(s, tolerance);
    }

    /// Undamped Newton steps as far as they help.
    pub(super) fn refine(&self, q: &Vec3, s: &mut Local) {
        // Most points are as good as they can be.
        let Some(mut step) = step_to_make(s) else {
            return;
        };
        let domain = s.region.domain;
        let mut trial = *s;
        for _ in 0..3 {
            self.evaluate(q, moved(&trial, step, 1.0), trial.span, &mut trial);
            // Undamped does not mean blind: close to a pole rounding alone can lead away again. But there a first step in
            // the turning parameter may also cost what the second one gains.
            // And a Hessian that is nearly singular leads to stationary points elsewhere, which may be farther away.
            let more = ROUGH * self.size;
            let near = trial.d2 <= s.d2 + 2.0 * more * (s.d2.sqrt() + more);
            let better = near && self.residual2(&trial, 2e-3) <= self.residual2(s, 2e-3);
            if better || !s.converged && trial.d2 < s.d2 * (1.0 - 1e-14) {
                let converged = s.converged;
                *s = trial;
                s.converged = converged;
            }
            if better && (0..2).all(|k| step[k].abs() <= 1e-8 * (domain[k][1] - domain[k][0])) {
                break;
            }
            match step_to_make(&trial) {
                Some(next) => step = next,
                None => break,
            }
        }
    }
}
