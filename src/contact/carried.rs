//! A contact point whose rigid master moves as unknowns say: rows and tangent of translation and spin.
//!
//! The contact energy of a rigid master depends on where the slave point lies as seen from the master, and on nothing
//! else. With the residual `r` and the tangent `k` in space of the master at rest ([`super::rigid::Touch`]), the
//! displacement `u` of the master's centre `c`, its spin `w` (a turn by `exp(w)` on top of the present one) and the arm
//! `b = x - c`, the point moves relative to the master by
//!
//! ```text
//! z - b = (dx - du) - w x b + 1/2 w x (w x b) - w x (dx - du) + ...
//! ```
//!
//! whose first and second order give, exactly and for faces, edges, vertices and poles alike (`B = [b]x`, `b x`):
//!
//! ```text
//! R_x = r          K_xx =  k    K_xw =   k B - [r]x
//! R_u = -r         K_xu = -k    K_uw = -(k B - [r]x)
//! R_w = r x b      K_uu =  k    K_ww = B^T k B + 1/2 (r b^T + b r^T) - (r.b) 1
//! ```
//!
//! The terms with `r` are what the exponential map adds in second order. That all of it follows from the first 3 x 3
//! block is special to rigid masters; [`super::point`] is what a deforming one needs.
//!
//! Friction has no energy, and its `k` no symmetry. The force still depends on nothing but the position as seen from the
//! master, and follows its turns; with the same rows the derivatives by `x`, `u` and `w` are as above, where the rows of
//! the spin read
//!
//! ```text
//! K_wx = B^T k + [r]x      K_wu = -(B^T k + [r]x)      K_ww = B^T k B + r b^T - (r.b) 1
//! ```
//!
//! (the last differs by half of `[m]x` of the moment `m = b x r`, the difference between the derivative of a moment and
//! that of its coordinates in the exponential map; [`carried`] keeps to the latter).
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// Rows and tangent of a point for unit area, slave point `x`, translation `u` and spin `w` of the master.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carried<D = f64> {
    /// Generalised force on the spin, `r x b` (force / length); that on the translation is `-r`.
    pub spin: Vector3<D>,
    /// Tangent between the slave point (rows) and the spin (columns); that of the translation and the spin is its
    /// negative, that of the slave point and the translation is `-k`.
    pub point_spin: Matrix3<D>,
    /// Tangent between the spin (rows) and the slave point (columns), the transpose of `point_spin` where `k` is symmetric;
    /// that of the spin and the translation is its negative.
    pub spin_point: Matrix3<D>,
    /// Tangent of the spin, symmetric where `k` is.
    pub spin_spin: Matrix3<D>,
}

/// `[v]x`, so that `[v]x w = v x w`.
pub fn cross_matrix<D: DualNum<f64> + Copy>(v: &Vector3<D>) -> Matrix3<D> {
    let z = D::zero();
    Matrix3::new(z, -v.z, v.y, v.z, z, -v.x, -v.y, v.x, z)
}

/// Rows and tangent from residual `r` and tangent `k`, symmetric, of the point on the master at rest, and its arm `b` from
/// the centre (length).
#[inline]
pub fn carried<D: DualNum<f64> + Copy>(
    r: &Vector3<D>,
    k: &Matrix3<D>,
    b: &Vector3<D>,
) -> Carried<D> {
    let arm = cross_matrix(b);
    let half = r * b.transpose() * D::from(0.5);
    let mut spin_spin = arm.transpose() * k * arm + half + half.transpose();
    let along = r.dot(b);
    for c in 0..3 {
        spin_spin[(c, c)] -= along;
    }
    let point_spin = k * arm - cross_matrix(r);
    Carried {
        spin: r.cross(b),
        point_spin,
        spin_point: point_spin.transpose(),
        spin_spin,
    }
}

/// [`carried`] for a tangent `k` without symmetry.
#[inline]
pub fn carried_with_friction<D: DualNum<f64> + Copy>(
    r: &Vector3<D>,
    k: &Matrix3<D>,
    b: &Vector3<D>,
) -> Carried<D> {
    Carried {
        spin_point: cross_matrix(b).transpose() * k + cross_matrix(r),
        ..carried(r, k, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::HyperDual64;

    type H = HyperDual64;

    /// `exp([w]x) v` to second order, which is all that derivatives at `w = 0` see.
    fn turned(w: &Vector3<H>, v: &Vector3<H>) -> Vector3<H> {
        v + w.cross(v) + w.cross(&w.cross(v)) * H::from(0.5)
    }

    /// Energy of a point at `x` under a penalty on an ellipsoidal (not a distance) function of its position as seen from
    /// a body with centre `c + u` turned by `w`: any function of that position has the structure of the formulas.
    fn energy(x: &Vector3<H>, u: &Vector3<H>, w: &Vector3<H>) -> H {
        let c = Vector3::new(0.3, -0.2, 0.5).map(H::from);
        let z = turned(&-w, &(x - c - u));
        let level = z.x * z.x * 0.7 + z.y * z.y * 1.3 + z.x * z.z * 0.4 + z.z * 0.9 - H::from(0.2);
        level * level * 2.5
    }

    #[test]
    fn rows_and_tangent_are_the_derivatives_of_the_energy() {
        let x = Vector3::new(1.1, 0.4, -0.6);
        let b = x - Vector3::new(0.3, -0.2, 0.5);
        // Derivative with respect to two of the nine unknowns: x, u, w.
        let second = |i: usize, j: usize| {
            let mut v: [H; 9] = std::array::from_fn(|k| H::from(if k < 3 { x[k] } else { 0.0 }));
            v[i].eps1 = 1.0;
            v[j].eps2 = 1.0;
            let part = |p: usize| Vector3::new(v[p], v[p + 1], v[p + 2]);
            energy(&part(0), &part(3), &part(6))
        };
        let r = Vector3::from_fn(|i, _| second(i, i).eps1);
        let k = Matrix3::from_fn(|i, j| second(i, j).eps1eps2);
        let c = carried(&r, &k, &b);
        for i in 0..3 {
            assert!((second(3 + i, 0).eps1 + r[i]).abs() < 1e-12);
            assert!(
                (second(6 + i, 0).eps1 - c.spin[i]).abs() < 1e-12,
                "spin {i}"
            );
        }
        let mut smallest = f64::INFINITY;
        for i in 0..3 {
            for j in 0..3 {
                let pairs = [
                    (second(i, 3 + j), -k[(i, j)]),
                    (second(3 + i, 3 + j), k[(i, j)]),
                    (second(i, 6 + j), c.point_spin[(i, j)]),
                    (second(3 + i, 6 + j), -c.point_spin[(i, j)]),
                    (second(6 + i, 6 + j), c.spin_spin[(i, j)]),
                ];
                for (block, (exact, ours)) in pairs.into_iter().enumerate() {
                    let exact = exact.eps1eps2;
                    assert!(
                        (exact - ours).abs() < 1e-11,
                        "block {block} ({i}, {j}): {exact} {ours}"
                    );
                    smallest = smallest.min(exact.abs());
                }
            }
        }
        assert!(
            smallest > 1e-3,
            "a compared value is as good as zero: {smallest:e}"
        );
    }

    /// A force without potential, as a body with centre `c + u` turned by `w` sees the point, on the point in space.
    fn force(x: &Vector3<H>, u: &Vector3<H>, w: &Vector3<H>) -> Vector3<H> {
        let c = Vector3::new(0.3, -0.2, 0.5).map(H::from);
        let z = turned(&-w, &(x - c - u));
        let f = Vector3::new(
            z.x * z.y * 0.7 + z.z * 1.3,
            z.z * z.z * 0.9 - z.x * 0.8 + z.y * 0.3,
            z.x * z.x * 1.1 + z.y * z.z * 0.6 - H::from(0.4),
        );
        turned(w, &f)
    }

    #[test]
    fn tangent_of_a_force_without_potential_is_the_derivative_of_force_and_moment() {
        let x = Vector3::new(1.1, 0.4, -0.6);
        let center = Vector3::new(0.3, -0.2, 0.5);
        // Force on the point, and moment of its opposite about the present centre, by one of the nine unknowns.
        let slope = |i: usize| {
            let mut v: [H; 9] = std::array::from_fn(|k| H::from(if k < 3 { x[k] } else { 0.0 }));
            v[i].eps1 = 1.0;
            let part = |p: usize| Vector3::new(v[p], v[p + 1], v[p + 2]);
            let f = force(&part(0), &part(3), &part(6));
            let arm = part(0) - center.map(H::from) - part(3);
            (f, f.cross(&arm))
        };
        let r = slope(0).0.map(|f| f.re);
        let k = Matrix3::from_fn(|i, j| slope(j).0[i].eps1);
        assert!((k - k.transpose()).norm() > 0.5);
        let c = carried_with_friction(&r, &k, &(x - center));
        assert!((slope(0).1.map(|m| m.re) - c.spin).norm() < 1e-14);
        // From the second derivative in the coordinates of the exponential map to that of the moment in space.
        let spin_spin = c.spin_spin - cross_matrix(&c.spin) * 0.5;
        let mut smallest = f64::INFINITY;
        for (first, force, moment) in [
            (0, k, c.spin_point),
            (3, -k, -c.spin_point),
            (6, c.point_spin, spin_spin),
        ] {
            for i in 0..3 {
                for j in 0..3 {
                    let (df, dm) = slope(first + j);
                    for (exact, ours) in [(df[i], force[(i, j)]), (dm[i], moment[(i, j)])] {
                        let exact = exact.eps1;
                        assert!(
                            (exact - ours).abs() < 1e-11,
                            "{first} ({i}, {j}): {exact} {ours}"
                        );
                        smallest = smallest.min(exact.abs());
                    }
                }
            }
        }
        assert!(
            smallest > 1e-3,
            "a compared value is as good as zero: {smallest:e}"
        );
    }
}
