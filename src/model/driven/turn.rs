//! Rotation vectors: what their increments are as spins, to second order.
//!
//! A surface that forces turn has the rotation `q = exp(theta)`. Named components of `theta` are unknowns, the others
//! stay zero, so that the rotation depends on where the iterations end and not on how they got there (spins added up
//! component by component would not do: two turns do not commute). An increment `delta` of `theta` is the spin
//!
//! ```text
//! w = T delta,   T = 1 + a [theta]x + b [theta]x^2,   a = (1 - cos t) / t^2,   b = (t - sin t) / t^3,   t = |theta|
//! ```
//!
//! (left Jacobian of SO(3), e.g. A. Ibrahimbegovic, F. Frey, I. Kozar, Int. J. Numer. Meth. Engng 38 (1995)). It is
//! regular up to a full turn; about one axis alone any angle will do.
use crate::contact::carried::cross_matrix;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// `a`, `b` and their derivatives by `t` over `t`.
fn factors(t: f64) -> [f64; 4] {
    // Below, the series are exact to rounding, above the closed forms lose at most six digits of the derivatives' tail.
    if t < 0.3 {
        let s = t * t;
        let a = 0.5 - s / 24.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0)));
        let b = (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))) / 6.0;
        let da = -(1.0
            - s / 15.0 * (1.0 - s * 3.0 / 112.0 * (1.0 - s * 2.0 / 135.0 * (1.0 - s / 105.6))))
            / 12.0;
        let db = -(1.0 - s / 21.0 * (1.0 - s / 48.0 * (1.0 - s / 82.5 * (1.0 - s / 124.8)))) / 60.0;
        return [a, b, da, db];
    }
    let (sin, cos) = t.sin_cos();
    let a = (1.0 - cos) / (t * t);
    let b = (t - sin) / (t * t * t);
    let da = (sin / t - 2.0 * a) / (t * t);
    let db = (a - 3.0 * b) / (t * t);
    [a, b, da, db]
}

/// `T(theta)`: increments of the rotation vector to spins.
pub fn spin_of(theta: &Vec3) -> Matrix3<f64> {
    let [a, b, ..] = factors(theta.norm());
    let k = cross_matrix(theta);
    Matrix3::identity() + k * a + k * k * b
}

/// Derivative of `T(theta)^T m` with respect to `theta` for a constant moment `m`.
pub fn moment_slope(theta: &Vec3, m: &Vec3) -> Matrix3<f64> {
    let [a, b, da, db] = factors(theta.norm());
    let once = theta.cross(m);
    let twice = theta.cross(&once);
    let sym = theta * m.transpose() - m * theta.transpose() * 2.0;
    cross_matrix(m) * a - once * theta.transpose() * da
        + (Matrix3::identity() * theta.dot(m) + sym) * b
        + twice * theta.transpose() * db
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    const ANGLES: [f64; 7] = [1e-9, 1e-3, 0.1, 0.29, 0.31, 1.2, 3.0];

    #[test]
    fn an_increment_is_the_spin_it_says() {
        let m = Vec3::new(0.3, -1.1, 0.7);
        for t in ANGLES {
            let theta = Vec3::new(0.6, -0.48, 0.64) * t;
            let tangent = spin_of(&theta);
            let slope = moment_slope(&theta, &m);
            let h = 1e-5;
            for c in 0..3 {
                let mut step = Vec3::zeros();
                step[c] = h;
                let q = |v: Vec3| UnitQuaternion::from_scaled_axis(v);
                let spin = (q(theta + step) * q(theta - step).inverse()).scaled_axis() / (2.0 * h);
                let error = (spin - tangent.column(c)).norm();
                assert!(error < 1e-9, "t = {t}, column {c}: {error:e}");
                let difference = (spin_of(&(theta + step)).tr_mul(&m)
                    - spin_of(&(theta - step)).tr_mul(&m))
                    / (2.0 * h);
                let error = (difference - slope.column(c)).norm();
                assert!(error < 1e-9, "t = {t}, slope {c}: {error:e}");
            }
        }
    }

    #[test]
    fn series_and_closed_forms_meet() {
        for (below, above) in factors(0.3 - 1e-9).into_iter().zip(factors(0.3 + 1e-9)) {
            assert!(
                (below - above).abs() < 1e-9 * below.abs() + 1e-12,
                "{below} {above}"
            );
        }
    }
}
