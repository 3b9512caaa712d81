//! Steps of the iteration for a closest point.
use super::Local;

/// The Newton step, where there is one and it is more than what rounding leaves.
#[inline]
pub(super) fn step_to_make(s: &Local) -> Option<[f64; 2]> {
    let step = undamped_step(s)?;
    let domain = s.region.domain;
    let tiny = |k: usize| step[k].abs() <= 1e-14 * (domain[k][1] - domain[k][0]);
    (!(tiny(0) && tiny(1))).then_some(step)
}

#[inline]
pub(super) fn moved(s: &Local, step: [f64; 2], factor: f64) -> [f64; 2] {
    [s.xi[0] + factor * step[0], s.xi[1] + factor * step[1]]
}

/// Step where the Hessian is not positive definite: with the absolute values of its curvatures (saddles and maxima push
/// away as minima attract), else Gauss-Newton.
#[cold]
pub(super) fn damped_step(s: &Local) -> [f64; 2] {
    absolute(s)
        .and_then(|f| s.downhill().solve(&f))
        .or_else(|| s.downhill().solve(&s.metric))
        .unwrap_or_else(|| s.downhill().diagonal_step())
}

/// The Hessian with the absolute values of its eigenvalues over the metric, none smaller than 1e-9 of the largest; `None`
/// where it has none.
#[cold]
pub(super) fn absolute(s: &Local) -> Option<[f64; 3]> {
    let (f, a) = (&s.hessian, &s.metric);
    // Orthonormal parameters: rho_1 / l1, then the rest of rho_2.
    let l1 = a[0].sqrt();
    let shear = a[1] / l1;
    let l2 = (a[2] - shear * shear).sqrt();
    let spanned = l1 > 0.0 && l2 > 1e-8 * a[2].sqrt();
    if !spanned {
        return None;
    }
    let h11 = f[0] / a[0];
    let h12 = (f[1] / l1 - h11 * shear) / l2;
    let h22 = (f[2] - 2.0 * shear * f[1] / l1 + h11 * shear * shear) / (l2 * l2);
    let (mean, half) = (0.5 * (h11 + h22), 0.5 * (h11 - h22));
    let radius = half.hypot(h12);
    let largest = mean.abs() + radius;
    if largest <= 0.0 || largest.is_nan() {
        return None;
    }
    let [e1, e2] = [mean + radius, mean - radius].map(|e| e.abs().max(1e-9 * largest));
    // |H| has the same eigenvectors: mean' + (H - mean) radius' / radius.
    let (new_mean, new_radius) = (0.5 * (e1 + e2), 0.5 * (e1 - e2));
    let ratio = if radius > 0.0 {
        new_radius / radius
    } else {
        0.0
    };
    let (g11, g12, g22) = (
        new_mean + half * ratio,
        h12 * ratio,
        new_mean - half * ratio,
    );
    let f12 = (g12 * l2 + g11 * shear) * l1;
    let f22 = g22 * l2 * l2 + 2.0 * shear * g12 * l2 + g11 * shear * shear;
    Some([g11 * a[0], f12, f22])
}

/// Newton step, or `None` where the Hessian is not positive definite.
#[inline]
pub(super) fn undamped_step(s: &Local) -> Option<[f64; 2]> {
    s.downhill().solve(&s.hessian)
}

/// Shortens a step to the bounds: a direction that would leave stops there and the other is solved for again.
#[inline]
pub(super) fn bounded(s: &Local, step: [f64; 2]) -> [f64; 2] {
    let clamp = |k: usize, x: f64| {
        let [low, high] = s.region.domain[k].map(|bound| bound - s.xi[k]);
        // False where the place is not a number, because squares of weights overflow: it stays.
        if low <= high { x.clamp(low, high) } else { 0.0 }
    };
    let cut = [clamp(0, step[0]), clamp(1, step[1])];
    let mut out = cut;
    for k in 0..2 {
        let other = 1 - k;
        let f = s.hessian[2 * other];
        if cut[k] != step[k] && cut[other] == step[other] && !s.active[other] && f > 0.0 {
            out[other] = clamp(other, -(s.gradient[other] + s.hessian[1] * cut[k]) / f);
        }
    }
    out
}
