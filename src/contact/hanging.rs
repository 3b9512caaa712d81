//! Points that hang over a free border of a body: the same rounding as that of `overhang`, on a master that
//! deforms.
//!
//! The facet at the border is continued by its own polynomial, on which the point has the coordinates `xi3`, `xi^i`. With the widths
//! `w_i` of the undeformed facet per parameter, it is past the border by
//!
//! ```text
//! s = |e|,  e_i = w_i (|xi^i| - 1) where positive        a = xi3 + R     b = max(s - s0, 0)
//! gap = |(a, b)| - R
//! ```
//!
//! a function `G(xi3, xi^i)` of coordinates that no rigid motion changes, so that the forces of its energy balance in force and
//! moment, at the slave point and through the facet's shape functions past the border:
//!
//! ```text
//! R = N (G,3 g3 + G,i X^i)
//! K = N' dG x dG + N (G,33 g3 x g3 + G,3i (g3 x X^i + X^i x g3) + G,ij X^i x X^j + G,3 D dxi3)
//! ```
//!
//! Left out of the tangent, which is symmetric, is `N G,i D dxi^i`, smaller than the rest by the penetration over the facet's width.
use super::kernel::{self, Normal, SlotMatrix, Slots};
use super::overhang::Overhang;
use covact_geometry::Frame;
use nalgebra::{Matrix3, Vector3};

/// The gap of a point over the rounding of a border, as a function of its coordinates over the continued facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hanging {
    /// Normal coordinate over the rounding (length).
    pub gap: f64,
    /// How far the point is past where the rounding begins, as a part of its radius.
    pub past: f64,
    /// Derivatives by `xi3`, `xi^1`, `xi^2`.
    d: Vector3<f64>,
    dd: Matrix3<f64>,
}

impl Hanging {
    /// Of a point with coordinates `xi3` and `xi` over a facet of these widths, where the sides at the ends of the marked parameters
    /// are free; none where it lies below all of the rounding.
    pub(super) fn new(
        overhang: &Overhang,
        xi3: f64,
        xi: [f64; 2],
        width: [f64; 2],
        free: [bool; 2],
    ) -> Option<Hanging> {
        let radius = overhang.rounding;
        let past = |i: usize| match free[i] {
            true => width[i] * (xi[i].abs() - 1.0).max(0.0),
            false => 0.0,
        };
        let e = [past(0), past(1)];
        let s = e[0].hypot(e[1]);
        let (a, b) = (xi3 + radius, overhang.past(s));
        if a <= 0.0 {
            return None;
        }
        if b == 0.0 {
            return Some(Hanging {
                gap: xi3,
                past: 0.0,
                d: Vector3::x(),
                dd: Matrix3::zeros(),
            });
        }
        let long = a.hypot(b);
        let [by_a, by_b] = [a / long, b / long];
        let cube = long.powi(3);
        let [by_aa, by_ab, by_bb] = [b * b / cube, -a * b / cube, a * a / cube];
        // Derivatives of s.
        let turn = |i: usize| width[i] * xi[i].signum();
        let c = [0, 1].map(|i| turn(i) * e[i] / s);
        let bent = |i: usize, j: usize| {
            let same = if i == j && e[i] > 0.0 { 1.0 } else { 0.0 };
            turn(i) * turn(j) * (same - e[i] * e[j] / (s * s)) / s
        };
        let both = |i: usize, j: usize| by_bb * c[i] * c[j] + by_b * bent(i, j);
        let (m, n) = (by_ab * c[0], by_ab * c[1]);
        Some(Hanging {
            gap: long - radius,
            past: b / radius,
            d: Vector3::new(by_a, by_b * c[0], by_b * c[1]),
            dd: Matrix3::new(
                by_aa,
                m,
                n,
                m,
                both(0, 0),
                both(0, 1),
                n,
                both(0, 1),
                both(1, 1),
            ),
        })
    }

    /// The part of the traction along the facet's normal, under the traction of the law.
    pub(super) fn along_normal(&self, normal: &Normal) -> Normal {
        Normal {
            n: normal.n * self.d[0],
            dn: self.product(normal, 0, 0),
        }
    }

    /// The derivative of that part by the coordinates along the facet, in the slots.
    pub(super) fn normal_along(&self, frame: &Frame, xi3: f64, normal: &Normal) -> Slots {
        let x = kernel::rows(frame, xi3).x;
        x[0] * self.product(normal, 0, 1) + x[1] * self.product(normal, 0, 2)
    }

    /// Adds the part of the traction along the facet to the residual and tangent of [`Self::along_normal`].
    pub(super) fn add_along_facet(
        &self,
        (frame, xi3): (&Frame, f64),
        normal: &Normal,
        residual: &mut Slots,
        tangent: &mut SlotMatrix,
    ) {
        let kernel::Rows { g3, x, .. } = kernel::rows(frame, xi3);
        for (i, row) in x.iter().enumerate() {
            *residual += row * (normal.n * self.d[i + 1]);
            let cross = self.product(normal, 0, i + 1);
            *tangent += (g3 * row.transpose() + row * g3.transpose()) * cross;
            for (j, other) in x.iter().enumerate() {
                *tangent += row * other.transpose() * self.product(normal, i + 1, j + 1);
            }
        }
    }

    /// `N' G,i G,j + N G,ij`.
    fn product(&self, normal: &Normal, i: usize, j: usize) -> f64 {
        normal.dn * self.d[i] * self.d[j] + normal.n * self.dd[(i, j)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivatives of the gap by central differences, past one side and past a corner.
    #[test]
    fn derivatives_are_those_of_the_gap() {
        let overhang = Overhang {
            rounding: 0.25,
            closed: true,
        };
        for (at, free) in [
            ([-0.06, 1.2, 0.3], [true, false]),
            ([-0.06, -1.15, 1.4], [true, true]),
            ([-0.15, 0.2, -1.5], [false, true]),
        ] {
            let of = |v: [f64; 3]| {
                Hanging::new(&overhang, v[0], [v[1], v[2]], [0.7, 0.4], free).unwrap()
            };
            let here = of(at);
            assert!(here.gap > at[0] && here.d.iter().filter(|d| d.abs() > 0.05).count() > 1);
            for i in 0..3 {
                let [mut low, mut high] = [at; 2];
                (low[i], high[i]) = (at[i] - 1e-6, at[i] + 1e-6);
                let [low, high] = [of(low), of(high)];
                assert!(((high.gap - low.gap) / 2e-6 - here.d[i]).abs() < 1e-8);
                let slope = (high.d - low.d) / 2e-6;
                assert!((slope - here.dd.column(i)).norm() < 1e-7, "{at:?} {i}");
            }
        }
    }
}
