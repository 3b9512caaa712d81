//! A contact point whose rigid master moves as unknowns say: rows and tangent of translation and spin.
//!
//! What a rigid master does to a slave point depends on where the point lies as seen from the master, and on nothing
//! else (with friction also on what lies behind, in the master's coordinates). With the residual `r` and the tangent `k` in space of the master at rest ([`super::rigid::Touch`]), the
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
//!                  K_ux = -k    K_wx = -B k + [r]x = -K_wu
//! ```
//!
//! The terms with `r` are what the exponential map adds in second order. Without friction `k` is symmetric, and the last
//! line repeats the others. That all of it follows from the first 3 x 3
//! block is special to rigid masters; [`super::point`] is what a deforming one needs.
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
    /// Tangent between the spin (rows) and the slave point (columns), the transpose of the former where `k` is symmetric;
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

/// Rows and tangent from residual `r` and tangent `k` of the point on the master at rest, and its arm `b` from the
/// centre (length).
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
    Carried {
        spin: r.cross(b),
        point_spin: k * arm - cross_matrix(r),
        spin_point: cross_matrix(r) - arm * k,
        spin_spin,
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

    /// Force on the point in the coordinates of the body, as friction gives it: the gradient of nothing.
    fn force(z: &Vector3<H>) -> Vector3<H> {
        let (x, y, z) = (z.x, z.y, z.z);
        Vector3::new(
            x * y * 1.7 + z,
            z * z * 0.8 - x * 2.3 + H::from(0.4),
            y * x * x + z * 1.1,
        )
    }

    /// The virtual work of a force without potential: `R_j = f . dz/dv_j`.
    #[test]
    fn rows_and_columns_differ_where_the_force_has_no_potential() {
        let x = Vector3::new(1.1, 0.4, -0.6);
        let center = Vector3::new(0.3, -0.2, 0.5);
        let b = x - center;
        let seen = |i: usize, j: usize| {
            let mut v: [H; 9] = std::array::from_fn(|k| H::from(if k < 3 { x[k] } else { 0.0 }));
            v[i].eps1 = 1.0;
            v[j].eps2 = 1.0;
            let part = |p: usize| Vector3::new(v[p], v[p + 1], v[p + 2]);
            turned(&-part(6), &(part(0) - center.map(H::from) - part(3)))
        };
        // Residual on unknown i, and its derivative with respect to unknown j.
        let row = |i: usize, j: usize| {
            let z = seen(i, j);
            let f = force(&z);
            let residual: f64 = (0..3).map(|c| f[c].re * z[c].eps1).sum();
            let slope: f64 = (0..3)
                .map(|c| f[c].eps2 * z[c].eps1 + f[c].re * z[c].eps1eps2)
                .sum();
            (residual, slope)
        };
        let r = Vector3::from_fn(|i, _| row(i, i).0);
        let k = Matrix3::from_fn(|i, j| row(i, j).1);
        assert!((k - k.transpose()).norm() > 1.0);
        let c = carried(&r, &k, &b);
        for i in 0..3 {
            assert!((row(6 + i, 0).0 - c.spin[i]).abs() < 1e-12);
            for j in 0..3 {
                let pairs = [
                    (row(i, 3 + j), -k[(i, j)]),
                    (row(3 + i, j), -k[(i, j)]),
                    (row(3 + i, 3 + j), k[(i, j)]),
                    (row(i, 6 + j), c.point_spin[(i, j)]),
                    (row(3 + i, 6 + j), -c.point_spin[(i, j)]),
                    (row(6 + i, j), c.spin_point[(i, j)]),
                    (row(6 + i, 3 + j), -c.spin_point[(i, j)]),
                    (row(6 + i, 6 + j), c.spin_spin[(i, j)]),
                ];
                for (block, ((_, exact), ours)) in pairs.into_iter().enumerate() {
                    let error = (exact - ours).abs();
                    assert!(error < 1e-11, "block {block} ({i}, {j}): {exact} {ours}");
                }
            }
        }
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
}
