//! Evaluation: point and derivatives.

use num_dual::DualNum;

use super::{NurbsPatch, PatchError};
use crate::basis::{Short, WIDTH};
use crate::surface::{Jet, Jet3, Vec3, quotient, quotient3};

impl NurbsPatch {
    /// Surface point with first and second derivatives.
    ///
    /// At an inner knot the span to its right counts, so at a crease this is the jet of the side with larger
    /// parameters. Parameters outside of the domain by rounding (1e-12 of its length) are moved onto it; farther out
    /// the polynomials of the nearest span are continued. Not-a-number in gives not-a-number out.
    #[inline]
    pub fn jet(&self, xi: [f64; 2]) -> Jet {
        let xi = self.snap(xi);
        self.jet_in_span(self.find_span(xi), xi)
    }

    /// [`jet`](Self::jet) with, at inner knots, the span to the left in both directions.
    pub fn jet_left(&self, xi: [f64; 2]) -> Jet {
        let xi = self.snap(xi);
        self.jet_in_span(self.find_span_left(xi), xi)
    }

    /// [`jet`](Self::jet) with third derivatives.
    pub fn jet3(&self, xi: [f64; 2]) -> Jet3 {
        let xi = self.snap(xi);
        self.jet3_in_span(self.find_span(xi), xi)
    }

    /// Surface point.
    pub fn point(&self, xi: [f64; 2]) -> Vec3 {
        let xi = self.snap(xi);
        let mut sum = [[0.0; 4]];
        self.derivatives::<1, 1>(self.find_span(xi), xi, &mut sum);
        let [[x, y, z, w]] = sum;
        Vec3::new(x, y, z) / w
    }

    /// Numbers of the non-empty spans (places in [`spans`](Self::spans)) that hold `xi`, at an inner knot the one to
    /// the right.
    #[inline]
    pub fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        [
            self.basis[0].find_span(xi[0]),
            self.basis[1].find_span(xi[1]),
        ]
    }

    /// As [`find_span`](Self::find_span), at an inner knot the one to the left.
    pub fn find_span_left(&self, xi: [f64; 2]) -> [usize; 2] {
        [
            self.basis[0].find_span_left(xi[0]),
            self.basis[1].find_span_left(xi[1]),
        ]
    }

    /// Jet of the polynomial piece of span `span` at `xi`, inside of the span or not. Choosing the span gives
    /// one-sided derivatives at knots. Numbers past the last span mean the last span.
    #[inline]
    pub fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        match self.fast_jet(span, xi) {
            Some(jet) => jet,
            None => self.general_jet(span, xi),
        }
    }

    /// The jet for any degree.
    fn general_jet(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        let mut d = [[0.0; 4]; 6];
        self.derivatives::<3, 6>(span, xi, &mut d);
        let a = |k: usize| Vec3::new(d[k][0], d[k][1], d[k][2]);
        if self.rational {
            let w = [d[0][3], d[1][3], d[2][3], d[3][3], d[4][3], d[5][3]];
            quotient(&[a(0), a(1), a(2), a(3), a(4), a(5)], &w)
        } else {
            let inv = 1.0 / self.points[0][3];
            Jet {
                rho: a(0) * inv,
                rho_i: [a(1) * inv, a(2) * inv],
                rho_ij: [a(3) * inv, a(4) * inv, a(5) * inv],
            }
        }
    }

    /// [`jet_in_span`](Self::jet_in_span) with third derivatives.
    pub fn jet3_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet3 {
        let mut d = [[0.0; 4]; 10];
        self.derivatives::<4, 10>(span, xi, &mut d);
        quotient3(&d.map(|p| Vec3::new(p[0], p[1], p[2])), &d.map(|p| p[3]))
    }

    /// Jet of a surface with other control points: `points` (unweighted, xi1 fastest) in place of the patch's own,
    /// with its knots and weights. Both may be dual numbers, so that derivatives with respect to control points and
    /// parameters can be checked. The span is found from the real part of `xi` unless it is given. Written for
    /// checks, not for speed.
    ///
    /// # Errors
    /// [`PatchError::PointCount`] where the number of points is not the patch's own.
    pub fn jet_generic<D: DualNum<f64> + Copy>(
        &self,
        points: &[Vec3<D>],
        xi: [D; 2],
        span: Option<[usize; 2]>,
    ) -> Result<Jet3<D>, PatchError> {
        if points.len() != self.points.len() {
            let expected = self.points.len();
            return Err(PatchError::PointCount {
                expected,
                found: points.len(),
            });
        }
        let span = span.unwrap_or_else(|| self.find_span(xi.map(|x| x.re())));
        let mut n = [[[D::from(0.0); WIDTH]; 4]; 2];
        for (dir, n) in n.iter_mut().enumerate() {
            self.basis[dir].evaluate(span[dir], xi[dir], n);
        }
        let mut a = [Vec3::from_element(D::from(0.0)); 10];
        let mut w = [D::from(0.0); 10];
        self.for_each_active(span, |r, s, k| {
            let weight = self.points[k][3];
            for (slot, (m1, m2)) in orders(4).enumerate() {
                let f = n[0][m1][r] * n[1][m2][s] * weight;
                a[slot] += points[k] * f;
                w[slot] += f;
            }
        });
        Ok(quotient3(&a, &w))
    }

    /// Moves parameters that miss the domain by rounding onto it.
    #[inline]
    pub(super) fn snap(&self, xi: [f64; 2]) -> [f64; 2] {
        [self.basis[0].snap(xi[0]), self.basis[1].snap(xi[1])]
    }

    /// Calls `f(r, s, k)` for the control points `k` that are active in a span, `(r, s)` their place among them,
    /// xi1 fastest.
    #[inline]
    pub(super) fn for_each_active(&self, span: [usize; 2], mut f: impl FnMut(usize, usize, usize)) {
        let columns = self.basis[0].count();
        let first = [
            self.basis[0].first_function(span[0]),
            self.basis[1].first_function(span[1]),
        ];
        for s in 0..=self.basis[1].degree() {
            for r in 0..=self.basis[0].degree() {
                f(r, s, first[0] + r + columns * (first[1] + s));
            }
        }
    }

    /// Adds to `sum` the derivatives of the homogeneous surface below order `K`, in the order 0 | 1, 2 | 11, 12, 22 |
    /// 111, ...; `M = K (K + 1) / 2` of them.
    #[inline]
    fn derivatives<const K: usize, const M: usize>(
        &self,
        span: [usize; 2],
        xi: [f64; 2],
        sum: &mut [[f64; 4]; M],
    ) {
        let [b1, b2] = &self.basis;
        let (p, q) = (b1.degree(), b2.degree());
        let first = b1.first_function(span[0]) + b1.count() * b2.first_function(span[1]);
        let net = Net {
            points: &self.points[first..],
            stride: b1.count(),
            rows: q + 1,
        };
        if p <= 5 && q <= 5 {
            let (mut n1, mut n2): (Short<K>, Short<K>) = ([[0.0; 6]; K], [[0.0; 6]; K]);
            b1.evaluate_short(span[0], xi[0], &mut n1);
            b2.evaluate_short(span[1], xi[1], &mut n2);
            match p {
                1 => net.contract(2, &n1, &n2, sum),
                2 => net.contract(3, &n1, &n2, sum),
                3 => net.contract(4, &n1, &n2, sum),
                4 => net.contract(5, &n1, &n2, sum),
                _ => net.contract(6, &n1, &n2, sum),
            }
        } else {
            net.contract_wide::<K, M>(self, span, xi, sum);
        }
    }
}

/// Pairs of derivative orders `(m1, m2)` with `m1 + m2 < k`: 00 | 10, 01 | 20, 11, 02 | ...
pub(super) fn orders(k: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..k).flat_map(|m| (0..=m).map(move |m2| (m - m2, m2)))
}

/// The active part of a control net: `rows` rows, each `stride` points after the one before.
struct Net<'a> {
    points: &'a [[f64; 4]],
    stride: usize,
    rows: usize,
}

impl Net<'_> {
    /// Sums over the rows and the first `width` points of each.
    #[inline(always)]
    fn contract<const N: usize, const K: usize, const M: usize>(
        &self,
        width: usize,
        n1: &[[f64; N]; K],
        n2: &[[f64; N]; K],
        sum: &mut [[f64; 4]; M],
    ) {
        for (s, row) in self.points.chunks(self.stride).take(self.rows).enumerate() {
            let row = &row[..width];
            let mut part = [[0.0; 4]; K];
            for (r, point) in row.iter().enumerate() {
                for (m, part) in part.iter_mut().enumerate() {
                    add(part, point, n1[m][r]);
                }
            }
            let mut slot = 0;
            for m in 0..K {
                for m2 in 0..=m {
                    add(&mut sum[slot], &part[m - m2], n2[m2][s]);
                    slot += 1;
                }
            }
        }
    }

    /// [`contract`](Self::contract) for the degrees that the short buffers do not hold.
    #[inline(never)]
    fn contract_wide<const K: usize, const M: usize>(
        &self,
        patch: &NurbsPatch,
        span: [usize; 2],
        xi: [f64; 2],
        sum: &mut [[f64; 4]; M],
    ) {
        let mut n = [[[0.0; WIDTH]; K]; 2];
        for (dir, n) in n.iter_mut().enumerate() {
            patch.basis[dir].evaluate(span[dir], xi[dir], n);
        }
        self.contract(patch.basis[0].degree() + 1, &n[0], &n[1], sum);
    }
}

/// `sum += f * point`.
#[inline(always)]
fn add(sum: &mut [f64; 4], point: &[f64; 4], f: f64) {
    for (sum, x) in sum.iter_mut().zip(point) {
        *sum += f * x;
    }
}
