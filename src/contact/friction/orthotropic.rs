//! Friction with two coefficients, along a direction of the master and across it.
use super::law::{FrictionLaw, Slip};
use nalgebra::{Matrix3, Unit, Vector3};
use num_dual::DualNum;

/// Sine of the angle between the direction and the normal below which the two coefficients approach each other.
const STEEP: f64 = 0.1;
/// Newton steps for the multiplier; the iteration is monotone and converges in five or six.
const STEPS: usize = 40;

/// Coulomb's law with the ellipse `(T . a)^2 / mu_1^2 + (T . b)^2 / mu_2^2 <= p^2` in place of the circle: `a` is the
/// projection of a direction on the tangent plane, `b = n x a` (Michalowski & Mroz, Archives of Mechanics 30 (1978), with the
/// associated rule of sliding).
///
/// The return is to the *closest point* of the ellipse in the metric of the penalty, which is isotropic: with the
/// friction tensor `M = mu_1^2 a x a + mu_2^2 b x b`
///
/// ```text
/// T = M (M + gamma I)^-1 T_tr        |M^1/2 (M + gamma I)^-1 T_tr| = p
/// ```
///
/// so that slip follows the normal of the ellipse and as much as possible is dissipated; a radial return would not do that,
/// and would jump where a coefficient is zero. Equal coefficients give Coulomb's law.
///
/// Where the direction comes near to the normal it loses its meaning on the surface, and no choice of directions around
/// such a point is continuous. There (sine of the angle `s` below 0.1) the difference of the squared coefficients is reduced
/// by `q (2 - q)`, `q = (s / 0.1)^2`: `M` is once differentiable everywhere, and isotropic where direction and normal agree.
///
/// On a master that deforms the direction is the one of [`Heading`](super::heading::Heading), fixed to the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    /// Coefficients of friction along and across the direction.
    pub mu: [f64; 2],
    /// Unit vector in the coordinates of the master, undeformed.
    direction: Unit<Vector3<f64>>,
}

/// The friction tensor in its principal axes.
struct Axes<D> {
    a: [Vector3<D>; 2],
    /// Squared coefficients along the axes.
    m: [D; 2],
    /// Cotangent of the angle between direction and normal: how the axes turn in the plane.
    cot: D,
    /// Derivative of the first squared coefficient with respect to `a . dn`; that of the second is its negative.
    dm: D,
    /// The reciprocal of the sine of that angle: how the axes turn with the direction; zero where any axes will do.
    over: D,
    /// Derivative of the first squared coefficient with respect to `a . de`, where the direction changes by `de`.
    dm_along: D,
}

impl Orthotropic {
    /// Coefficients along and across `direction`, in the coordinates of the master.
    pub fn new(mu: [f64; 2], direction: Unit<Vector3<f64>>) -> Self {
        Orthotropic { mu, direction }
    }

    /// Whether the direction is so near to this unit normal (coordinates of the master) that the coefficients are brought
    /// nearer to each other.
    pub fn blurs(&self, normal: &Vector3<f64>) -> bool {
        normal.cross(&self.direction).norm() < STEEP
    }

    fn axes<D: DualNum<f64> + Copy>(&self, n: &Vector3<D>, e: &Vector3<D>) -> Axes<D> {
        let up = n.dot(e);
        let plane = e - n * up;
        let square = plane.dot(&plane);
        let [m1, m2] = self.mu.map(|mu| mu * mu);
        let (mean, half) = (0.5 * (m1 + m2), 0.5 * (m1 - m2));
        // Any axes will do where the coefficients differ by less than rounding.
        if square.re() < 1e-24 {
            let k = n.map(|x| x.re()).iamin();
            let other = Vector3::from_fn(|i, _| D::from(f64::from(u8::from(i == k))));
            let plane = other - n * n.dot(&other);
            let a = plane * plane.dot(&plane).sqrt().recip();
            return Axes {
                a: [a, n.cross(&a)],
                m: [D::from(mean); 2],
                cot: D::zero(),
                dm: D::zero(),
                over: D::zero(),
                dm_along: D::zero(),
            };
        }
        let sine = square.sqrt();
        let over = sine.recip();
        let a = plane * over;
        let q = square * (STEEP * STEEP).recip();
        let (share, slope, slope_along) = match q.re() < 1.0 {
            // d(sine^2) = -2 up sine a . dn + 2 sine a . de
            true => (
                q * (-q + 2.0),
                (-q + 1.0) * up * sine * (-4.0 / (STEEP * STEEP)),
                (-q + 1.0) * sine * (4.0 / (STEEP * STEEP)),
            ),
            false => (D::one(), D::zero(), D::zero()),
        };
        Axes {
            a: [a, n.cross(&a)],
            m: match q.re() < 1.0 {
                true => [share * half + mean, -share * half + mean],
                false => [D::from(m1), D::from(m2)],
            },
            cot: up / sine,
            dm: slope * half,
            over,
            dm_along: slope_along * half,
        }
    }
}

/// Root of `|M^1/2 (M + gamma I)^-1 t| = p` by Newton's method on the reciprocal, which is concave in `gamma`, so that the
/// iteration from zero grows monotonically; the last two steps in the scalar of the arguments carry their derivatives.
fn multiplier<D: DualNum<f64> + Copy>(t: &[D; 2], m: &[D; 2], p: D) -> D {
    let (ts, ms, ps) = (t.map(|x| x.re()), m.map(|x| x.re()), p.re());
    let mut gamma = 0.0;
    for _ in 0..STEPS {
        let (mut norm, mut slope) = (0.0f64, 0.0);
        for i in 0..2 {
            if ms[i] > 0.0 {
                let part = ts[i] * ms[i].sqrt() / (ms[i] + gamma);
                norm = norm.hypot(part);
                slope += part * part / (ms[i] + gamma);
            }
        }
        let step = (norm - ps) / ps * (norm * norm / slope);
        if !step.is_finite() {
            break;
        }
        gamma = f64::max(gamma + step, 0.0);
        if step.abs() <= 1e-15 * gamma {
            break;
        }
    }
    let mut gamma = D::from(gamma);
    for _ in 0..2 {
        let (mut square, mut slope) = (D::zero(), D::zero());
        for i in 0..2 {
            if ms[i] > 0.0 {
                let inverse = (m[i] + gamma).recip();
                let part = t[i] * t[i] * m[i] * inverse * inverse;
                square += part;
                slope += part * inverse;
            }
        }
        gamma += (square.sqrt() / p - 1.0) * square / slope;
    }
    gamma
}

impl FrictionLaw for Orthotropic {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D> {
        let direction = self.direction.map(D::from);
        self.slip_by::<D, false>(trial, normal, pressure, &direction)
            .0
    }

    #[inline]
    fn direction(&self) -> Option<&Vector3<f64>> {
        Some(&self.direction)
    }

    #[inline]
    fn slip_along<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
        direction: &Vector3<D>,
    ) -> (Slip<D>, Matrix3<D>) {
        self.slip_by::<D, true>(trial, normal, pressure, direction)
    }
}

impl Orthotropic {
    /// The slip for a direction, with the derivative of the traction with respect to that where `ALONG`, else zero.
    fn slip_by<D: DualNum<f64> + Copy, const ALONG: bool>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
        direction: &Vector3<D>,
    ) -> (Slip<D>, Matrix3<D>) {
        let Axes {
            a,
            m,
            cot,
            dm,
            over: over_sine,
            dm_along,
        } = self.axes(normal, direction);
        let t = a.map(|a| a.dot(trial));
        let zero = D::zero();
        // Inside: |M^-1/2 t| <= p, and nothing along an axis without friction.
        let held = |i: usize| m[i].re() > 0.0;
        let over = |i: usize| match held(i) {
            true => t[i].re() / m[i].re().sqrt(),
            false => 0.0,
        };
        let outside = over(0).hypot(over(1)) > pressure.re();
        let loose = (0..2).any(|i| !held(i) && t[i].re() != 0.0);
        if !outside && !loose {
            return (Slip::stick(trial), Matrix3::from_element(zero));
        }
        // Along the axes: the traction, its derivatives by trial traction (symmetric: 11, 12, 22), pressure and m_1.
        let (mut s, mut j, mut d_pressure, mut d_m) = ([zero; 2], [zero; 3], [zero; 2], [zero; 2]);
        if !outside {
            for i in 0..2 {
                if held(i) {
                    s[i] = t[i];
                    j[2 * i] = D::one();
                }
            }
        } else {
            let largest = t[0].re().hypot(t[1].re()) * self.mu[0].max(self.mu[1]);
            let moved = [t[0] * m[0], t[1] * m[1]];
            let force = (moved[0] * t[0] + moved[1] * t[1]).sqrt();
            if pressure.re() <= 1e-12 * largest.max(f64::MIN_POSITIVE) {
                // The limit of no pressure, where the multiplier grows beyond all bounds.
                if force.re() > 0.0 {
                    d_pressure = moved.map(|x| x / force);
                    s = d_pressure.map(|x| x * pressure);
                }
            } else {
                let gamma = multiplier(&t, &m, pressure);
                let inverse = [0, 1].map(|i| (m[i] + gamma).recip());
                let b = [0, 1].map(|i| t[i] * m[i] * inverse[i] * inverse[i]);
                let slope = t[0] * b[0] * inverse[0] + t[1] * b[1] * inverse[1];
                let over = slope.recip();
                s = [0, 1].map(|i| t[i] * m[i] * inverse[i]);
                j = [
                    m[0] * inverse[0] - b[0] * b[0] * over,
                    -b[0] * b[1] * over,
                    m[1] * inverse[1] - b[1] * b[1] * over,
                ];
                d_pressure = b.map(|b| b * pressure * over);
                // With m_2 falling as m_1 grows.
                let by = [0, 1].map(|i| t[i] * inverse[i] * inverse[i]);
                let d_gamma = [0, 1]
                    .map(|i| t[i] * by[i] * inverse[i] * (gamma - m[i]))
                    .into_iter()
                    .zip([1.0, -1.0])
                    .fold(zero, |sum, (d, sign)| sum + d * sign)
                    * over
                    * 0.5;
                d_m = [
                    by[0] * gamma - b[0] * d_gamma,
                    -by[1] * gamma - b[1] * d_gamma,
                ];
            }
        }
        let plane = |v: [D; 2]| a[0] * v[0] + a[1] * v[1];
        let apply = |v: [D; 2]| [j[0] * v[0] + j[1] * v[1], j[1] * v[0] + j[2] * v[1]];
        let out = plane(s);
        let columns = [
            plane(apply([D::one(), zero])),
            plane(apply([zero, D::one()])),
        ];
        // The axes turn with the normal: da = -n (a . dn) - cot b (b . dn), db = -n (b . dn) + cot a (b . dn).
        let turned = apply([-t[1], t[0]]);
        let turning = plane([(turned[0] + s[1]) * cot, (turned[1] - s[0]) * cot]);
        let by_direction = match ALONG {
            // And with the direction: da = b (b . de) / sine, db = -a (b . de) / sine.
            true => {
                let turning = plane([-(turned[0] + s[1]), s[0] - turned[1]]) * over_sine;
                turning * a[1].transpose() + plane(d_m) * dm_along * a[0].transpose()
            }
            false => Matrix3::from_element(zero),
        };
        let slip = Slip {
            t: out,
            d_trial: columns[0] * a[0].transpose() + columns[1] * a[1].transpose(),
            d_pressure: plane(d_pressure),
            d_normal: turning * a[1].transpose() + plane(d_m) * dm * a[0].transpose()
                - normal * out.transpose(),
            slides: true,
        };
        (slip, by_direction)
    }
}

#[cfg(test)]
mod tests {
    use super::super::law::Coulomb;
    use super::*;
    use num_dual::Dual64;

    fn law(mu: [f64; 2], direction: [f64; 3]) -> Orthotropic {
        Orthotropic::new(mu, Unit::new_normalize(Vector3::from(direction)))
    }

    #[test]
    fn equal_coefficients_are_coulombs_law() {
        let n = Vector3::new(0.2, -0.3, 0.9).normalize();
        let trial = Vector3::new(2.0, -1.0, 0.4);
        let trial = trial - n * n.dot(&trial);
        for direction in [[1.0, 0.2, 0.0], [n.x, n.y, n.z]] {
            for pressure in [0.0, 1e-14, 0.3, 5.0, 100.0] {
                let a = law([0.3; 2], direction).slip(&trial, &n, pressure);
                let b = Coulomb { mu: 0.3 }.slip(&trial, &n, pressure);
                assert_eq!(a.slides, b.slides, "{pressure}");
                assert!((a.t - b.t).norm() < 1e-15 * (1.0 + b.t.norm()));
                let p = Matrix3::identity() - n * n.transpose();
                let error = (a.d_trial - b.d_trial) * p;
                assert!(error.norm() < 1e-13, "{pressure}: {error}");
                assert!((a.d_pressure - b.d_pressure).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn the_return_is_to_the_closest_point_of_the_ellipse() {
        let n = Vector3::z();
        for mu in [[0.1, 0.4], [0.4, 0.1], [1e-6, 2.0], [0.3, 0.0]] {
            for k in 0..24 {
                let angle = 0.1 + k as f64 * std::f64::consts::TAU / 24.0;
                let trial = Vector3::new(angle.cos(), angle.sin(), 0.0) * 3.0;
                let pressure = 1.7;
                let slip = law(mu, [1.0, 0.0, 0.0]).slip(&trial, &n, pressure);
                assert!(slip.slides);
                let t = slip.t;
                if mu[1] == 0.0 {
                    // Nothing is held across, and along as much as the law holds.
                    let limit = mu[0] * pressure;
                    let expected = Vector3::new(trial.x.clamp(-limit, limit), 0.0, 0.0);
                    assert!((t - expected).norm() < 1e-12, "{mu:?}, {k}: {t}");
                    continue;
                }
                let on = (t.x / mu[0]).hypot(t.y / mu[1]);
                assert!((on - pressure).abs() < 1e-12, "{mu:?}, {k}: {on}");
                // What was taken off is normal to the ellipse, outward.
                let outward = Vector3::new(t.x / mu[0].powi(2), t.y / mu[1].powi(2), 0.0);
                let off = trial - t;
                let cross = off.cross(&outward).norm() / (off.norm() * outward.norm());
                assert!(
                    cross < 1e-9 && off.dot(&outward) > 0.0,
                    "{mu:?}, {k}: {cross:e}"
                );
            }
        }
    }

    #[test]
    fn little_pressure_leaves_the_limit_of_the_ellipse() {
        let n = Vector3::z();
        let law = law([0.1, 0.4], [1.0, 0.5, 0.0]);
        let trial = Vector3::new(1.0, 0.7, 0.0);
        let of = |p: f64| law.slip(&trial, &n, p).t / p;
        let limit = of(1e-14);
        assert!(limit.norm() > 0.1);
        for p in [1e-200, 1e-13, 1e-11, 1e-8] {
            assert!((of(p) - limit).norm() < 10.0 * p.max(1e-13), "{p:e}");
        }
        assert_eq!(law.slip(&trial, &n, 0.0).t, Vector3::zeros());
    }

    /// Derivatives against dual numbers, through the normal and the direction too.
    #[test]
    fn derivatives() {
        let e = Vector3::new(1.0, 0.3, -0.2).normalize();
        let (side, other) = (Vector3::new(0.0, 0.6, 0.9), Vector3::new(0.7, 0.1, 0.3));
        // Direction and normal far apart, and near to each other, down to equal.
        for (n, what) in [
            (Vector3::new(0.1, -0.4, 0.9), "far"),
            (e + side * 0.06, "near"),
            (e + side * 1e-3, "very near"),
            (-e - side * 0.05, "near the other pole"),
            (e, "equal"),
        ] {
            let n = n.normalize();
            let trial = Vector3::new(1.5, -0.8, 0.5);
            let trial = trial - n * n.dot(&trial);
            for mu in [[0.1, 0.4], [0.5, 0.2], [0.3, 0.0]] {
                let law = Orthotropic::new(mu, Unit::new_normalize(e));
                let pressure = 1.3;
                let (slip, by_direction) = law.slip_along(&trial, &n, pressure, &e);
                assert!(slip.slides, "{what}");
                assert_eq!(slip, law.slip(&trial, &n, pressure), "{what}");
                // Where all directions are alike, or none is left, it means nothing.
                let means = by_direction.norm() > 1e-3;
                assert_eq!(means, what != "equal", "{what}: {by_direction}");
                // A motion in which the normal turns and the trial traction stays in its plane.
                let mut compared = 0.0;
                for (turn, stretch, press, lean) in [
                    (side, other, 0.3, Vector3::zeros()),
                    (other, side, -0.7, side + other),
                    (side * 2.0 - other, Vector3::zeros(), 0.0, other * 0.5),
                    (Vector3::zeros(), Vector3::zeros(), 0.0, side - other),
                ] {
                    let dn = turn - n * n.dot(&turn);
                    let de = lean - e * e.dot(&lean);
                    let dt = stretch - n * n.dot(&stretch) - n * trial.dot(&dn);
                    let dual = |v: &Vector3<f64>, d: &Vector3<f64>| {
                        Vector3::from_fn(|i, _| Dual64::new(v[i], d[i]))
                    };
                    let (reference, _) = law.slip_along(
                        &dual(&trial, &dt),
                        &dual(&n, &dn),
                        Dual64::new(pressure, press),
                        &dual(&e, &de),
                    );
                    let reference = reference.t.map(|x| x.eps);
                    let given = slip.d_trial * dt
                        + slip.d_pressure * press
                        + slip.d_normal * dn
                        + by_direction * de;
                    // The axes are differences of relative size 1e-3, and turn by its reciprocal: so does rounding.
                    let limit = if what == "very near" { 1e-9 } else { 1e-11 };
                    if what == "equal" {
                        continue;
                    }
                    let error = (given - reference).norm() / reference.norm();
                    assert!(error < limit, "{what}, {mu:?}: {error:e}");
                    compared += reference.norm();
                }
                assert!(compared > 0.1 || what == "equal");
            }
        }
    }

    #[test]
    fn the_normal_may_pass_through_the_direction() {
        let e = Vector3::new(0.0, 0.0, 1.0);
        let law = Orthotropic::new([0.1, 0.5], Unit::new_normalize(e));
        let at = |angle: f64, round: f64| {
            let n = Vector3::new(
                angle.sin() * round.cos(),
                angle.sin() * round.sin(),
                angle.cos(),
            );
            let trial = Vector3::new(2.0, 1.0, 0.0);
            law.slip(&(trial - n * n.dot(&trial)), &n, 1.0)
        };
        let middle = at(0.0, 0.0).t;
        assert!(middle.norm() > 0.1);
        for k in 0..8 {
            for angle in [1e-13, 1e-9, 1e-6, 1e-4] {
                let slip = at(angle, k as f64);
                assert!((slip.t - middle).norm() < 10.0 * angle + 1e-12, "{angle:e}");
                assert!(slip.d_normal.iter().all(|x| x.is_finite()));
                assert!(slip.d_normal.norm() < 10.0, "{angle:e}: {}", slip.d_normal);
            }
        }
        // And all the way across the border of what is reduced.
        let border = 0.1f64.asin();
        for step in [-1e-9, 1e-9] {
            let (a, b) = (at(border, 0.4), at(border + step, 0.4));
            assert!((a.t - b.t).norm() < 1e-8);
            assert!((a.d_normal - b.d_normal).norm() < 1e-6);
        }
    }
}
