//! Logarithmic (Hencky) strain `H = ln(C)/2` from `C = G + 2E`, and stresses and tangents of laws written in it.
//!
//! `ln C` is the integral of `(C - G) (G + s (C - G))^-1` over s from 0 to 1, taken by Gauss's rule of ten points, which
//! is the [10/10] Padé approximant of the logarithm. It needs inverses of 3 x 3 matrices only: no eigenvalues, hence no
//! branches where they coincide, and dual numbers pass through. Its error is 3e-10 at stretches 2 and 1/2 and 7e-5
//! at 4. A law stays exactly hyperelastic, because stress and tangent are the derivatives of the approximated
//! strain. With n points the error at a stretch l is about `q^2n`, `q = |l - 1| / (l + 1)`: at small strains fewer points leave as
//! little as rounding does, and most of the time of a law is theirs.
//!
//! Source of the formulation: C. Miehe, N. Apel and M. Lambrecht, *Computer Methods in Applied Mechanics and
//! Engineering* 191 (2002) 5383-5425; here with the rational approximation and in convected components.
use super::tensor::{cauchy_green, invariants, inverse, mixed};
use super::{Collapsed, Metric};
use crate::shell::VOIGT;
use num_dual::DualNum;

/// Points of the rules on [0, 1], and the norm of the strain up to which those with fewer points err by less than 1e-13.
const POINTS: usize = 10;
const FEW: usize = 3;
const SOME: usize = 5;
const TINY: f64 = 0.013;
const SMALL: f64 = 0.09;

/// `(s, w)` of Gauss's rule of N points on [0, 1], from the points on [-1, 1] that are not negative, the smallest first.
const fn rule<const N: usize>(half: &[(f64, f64)]) -> [(f64, f64); N] {
    let mut rule = [(0.0, 0.0); N];
    let mut i = 0;
    while i < half.len() {
        let (x, w) = half[i];
        rule[(N - 1) / 2 - i] = (0.5 * (1.0 - x), 0.5 * w);
        rule[N / 2 + i] = (0.5 * (1.0 + x), 0.5 * w);
        i += 1;
    }
    rule
}

static RULE: [(f64, f64); POINTS] = rule(&[
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
]);
static RULE_OF_SOME: [(f64, f64); SOME] = rule(&[
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
]);
static RULE_OF_FEW: [(f64, f64); FEW] =
    rule(&[(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)]);

/// The rule that a strain needs, from its first two invariants.
fn rule_for(i1: f64, i2: f64) -> &'static [(f64, f64)] {
    let norm = (i1 * i1 - 2.0 * i2).max(0.0).sqrt();
    if norm < TINY {
        &RULE_OF_FEW
    } else if norm < SMALL {
        &RULE_OF_SOME
    } else {
        &RULE
    }
}

/// The logarithmic strain at one point, with what its derivatives are made of.
pub(super) struct Logarithm<D> {
    /// Mixed components `G^ik H_kj`, row i, column j.
    pub mixed: [[D; 3]; 3],
    rule: &'static [(f64, f64)],
    /// `R_q = (G + s_q (C - G))^-1`, contravariant, at the points of the rule.
    inverses: [[D; 6]; POINTS],
}

impl<D: DualNum<f64> + Copy> Logarithm<D> {
    /// From the Green-Lagrange strain.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    pub fn new(metric: &Metric, e: &[D; 6]) -> Result<Self, Collapsed> {
        let all = invariants(&mixed(metric, e));
        cauchy_green(metric, e, all)?;
        let rule = rule_for(all.0.re(), all.1.re());
        let mut mean = [D::zero(); 6];
        let mut inverses = [[D::zero(); 6]; POINTS];
        for ((s, w), inverse_there) in rule.iter().copied().zip(&mut inverses) {
            let shear = |v: usize| e[v] * s + metric.lower[v];
            let normal = |v: usize| e[v] * (2.0 * s) + metric.lower[v];
            let between = [
                normal(0),
                normal(1),
                normal(2),
                shear(3),
                shear(4),
                shear(5),
            ];
            let (r, _) = inverse(&between);
            for (mean, r) in mean.iter_mut().zip(r) {
                *mean += r * w;
            }
            *inverse_there = r;
        }
        let (mean, strain) = (full(&mean, 1.0), full(e, 0.5));
        let product = |i: usize, j: usize| {
            mean[i][0] * strain[0][j] + mean[i][1] * strain[1][j] + mean[i][2] * strain[2][j]
        };
        Ok(Logarithm {
            rule,
            mixed: [0, 1, 2].map(|i| [0, 1, 2].map(|j| product(i, j))),
            inverses,
        })
    }

    /// Second Piola-Kirchhoff stress `S^ij` of the stress `T^ij` that is conjugate to H.
    pub fn stress(&self, metric: &Metric, t: &[D; 6]) -> [D; 6] {
        let lowered = sandwich(&metric.lower.map(D::from), t);
        let mut s = [D::zero(); 6];
        for (r, (_, w)) in self.inverses.iter().zip(self.rule.iter().copied()) {
            for (s, z) in s.iter_mut().zip(sandwich(r, &lowered)) {
                *s += z * w;
            }
        }
        s
    }
}

impl Logarithm<f64> {
    /// `dS^ij / dE_kl` from the stress T and its derivative by H, which is symmetric.
    pub fn tangent(&self, metric: &Metric, t: &[f64; 6], moduli: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
        let (first, turned, mut tangent) = self.parts(metric, t, moduli);
        for v in 0..6 {
            for c in v..6 {
                tangent[v][c] += (0..6).map(|k| first[k][v] * turned[k][c]).sum::<f64>();
                tangent[c][v] = tangent[v][c];
            }
        }
        tangent
    }

    /// The same where the derivative of T is not symmetric.
    pub fn unsymmetric_tangent(
        &self,
        metric: &Metric,
        t: &[f64; 6],
        moduli: &[[f64; 6]; 6],
    ) -> [[f64; 6]; 6] {
        let (first, turned, at_constant) = self.parts(metric, t, moduli);
        std::array::from_fn(|v| {
            std::array::from_fn(|c| {
                let change = at_constant[v.min(c)][v.max(c)];
                change + (0..6).map(|k| first[k][v] * turned[k][c]).sum::<f64>()
            })
        })
    }

    /// `dH / dE`, its product with the derivative of T, and the upper triangle of what the change of `dH / dE` makes of T.
    #[inline(always)]
    #[allow(clippy::type_complexity)]
    fn parts(
        &self,
        metric: &Metric,
        t: &[f64; 6],
        moduli: &[[f64; 6]; 6],
    ) -> ([[f64; 6]; 6], [[f64; 6]; 6], [[f64; 6]; 6]) {
        let lower = full(&metric.lower, 1.0);
        let lowered = sandwich(&metric.lower, t);
        // dH / dE, and the change of dH / dE at constant T.
        let mut first = [[0.0; 6]; 6];
        let mut tangent = [[0.0; 6]; 6];
        for (r, (s, w)) in self.inverses.iter().zip(self.rule.iter().copied()) {
            let z = full(&sandwich(r, &lowered), 1.0);
            let r = full(r, 1.0);
            // G_ak R^ki.
            let l =
                lower.map(|g| [0, 1, 2].map(|i| g[0] * r[0][i] + g[1] * r[1][i] + g[2] * r[2][i]));
            for (v, (a, b)) in VOIGT.into_iter().enumerate() {
                let factor = if a == b { 0.5 * w } else { w };
                for (c, (i, j)) in VOIGT.into_iter().enumerate() {
                    first[v][c] += factor * (l[a][i] * l[b][j] + l[a][j] * l[b][i]);
                }
                for (c, (i, j)) in VOIGT.into_iter().enumerate().skip(v) {
                    let change = r[a][i] * z[b][j]
                        + r[a][j] * z[b][i]
                        + z[a][i] * r[b][j]
                        + z[a][j] * r[b][i];
                    tangent[v][c] -= w * s * change;
                }
            }
        }
        let mut turned = [[0.0; 6]; 6];
        for (turned, moduli) in turned.iter_mut().zip(moduli) {
            for (moduli, first) in moduli.iter().zip(&first) {
                for (turned, first) in turned.iter_mut().zip(first) {
                    *turned += moduli * first;
                }
            }
        }
        (first, turned, tangent)
    }
}

/// The matrix of a symmetric tensor, its shears taken times `shear`.
#[inline(always)]
fn full<D: DualNum<f64> + Copy>(v: &[D; 6], shear: f64) -> [[D; 3]; 3] {
    let (a, b, c) = (v[3] * shear, v[4] * shear, v[5] * shear);
    [[v[0], a, c], [a, v[1], b], [c, b, v[2]]]
}

/// `a b a` of symmetric matrices.
#[inline(always)]
pub(super) fn sandwich<D: DualNum<f64> + Copy>(a: &[D; 6], b: &[D; 6]) -> [D; 6] {
    let (a, b) = (full(a, 1.0), full(b, 1.0));
    let row = |x: &[D; 3]| [0, 1, 2].map(|j| x[0] * b[0][j] + x[1] * b[1][j] + x[2] * b[2][j]);
    let rows = [row(&a[0]), row(&a[1]), row(&a[2])];
    VOIGT.map(|(i, j)| rows[i][0] * a[j][0] + rows[i][1] * a[j][1] + rows[i][2] * a[j][2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_are_those_of_gauss() {
        for own in [&RULE_OF_FEW[..], &RULE_OF_SOME, &RULE] {
            let rule = crate::fem::quadrature::gauss(own.len()).unwrap();
            for ((s, w), (x, v)) in own.iter().zip(rule.iter()) {
                assert!((2.0 * s - 1.0 - x).abs() < 1e-15 && (2.0 * w - v).abs() < 1e-15);
            }
        }
    }

    /// Fewer points err by no more than rounding up to the strains that take them: stretches along one axis, whose strain has its own
    /// size as the norm.
    #[test]
    fn fewer_points_are_as_good_at_small_strains() {
        for (limit, points) in [(TINY, FEW), (SMALL, SOME)] {
            for sign in [1.0, -1.0] {
                let strain: f64 = sign * 0.999 * limit;
                assert_eq!(rule_for(strain, 0.0).len(), points);
                let e = [strain, 0.0, 0.0, 0.0, 0.0, 0.0];
                let found = Logarithm::new(&Metric::CARTESIAN, &e).unwrap().mixed[0][0];
                let exact = 0.5 * (2.0 * strain).ln_1p();
                assert!((found / exact - 1.0).abs() < 2e-13, "{found} {exact}");
            }
        }
    }

    /// The logarithm of stretches along the axes: errors as stated, digits kept at small strain.
    #[test]
    fn stretches_have_their_logarithms() {
        for (stretch, tolerance) in [
            (1.0f64 + 1e-9, 1e-15),
            (1.2, 1e-15),
            (1.5, 2e-14),
            (2.0, 5e-10),
            (0.5, 5e-10),
            (4.0, 8e-5),
        ] {
            let strain = 0.5 * (stretch - 1.0) * (stretch + 1.0);
            let e = [strain, 0.0, 0.0, 0.0, 0.0, 0.0];
            let found = Logarithm::new(&Metric::CARTESIAN, &e).unwrap().mixed;
            let exact = (stretch - 1.0).ln_1p();
            let error = (found[0][0] / exact - 1.0).abs();
            println!("{stretch}: {error:e}");
            assert!(error <= tolerance, "{stretch}: {error:e}");
            assert_eq!(found[1][1], 0.0);
        }
    }
}
