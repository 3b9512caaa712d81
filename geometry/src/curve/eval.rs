//! Evaluation of curves and their exact Bezier pieces.

use nalgebra::SVector;

use super::{CurveJet, NurbsCurve};
use crate::basis::WIDTH;

/// One (rational) polynomial piece of a curve in Bezier form.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePiece {
    /// Its part of the curve's domain.
    pub domain: [f64; 2],
    /// Homogeneous control points (w x, w y, w z, w), `degree + 1` of them.
    pub points: Vec<[f64; 4]>,
}

impl<const D: usize> NurbsCurve<D> {
    /// Point with first and second derivatives; at an inner knot those of the span to the right. Parameters outside of
    /// the domain continue the nearest polynomial.
    pub fn jet(&self, t: f64) -> CurveJet<D> {
        let t = self.basis.snap(t);
        self.jet_in_span(self.basis.find_span(t), t)
    }

    /// [`jet`](Self::jet) of the polynomial piece of span `span`, wherever `t` lies: at a knot this chooses the side.
    pub fn jet_in_span(&self, span: usize, t: f64) -> CurveJet<D> {
        let mut n = [[0.0; WIDTH]; 3];
        self.basis.evaluate(span, t, &mut n);
        let first = self.basis.first_function(span);
        let mut h = [[0.0; 4]; 3];
        for (h, n) in h.iter_mut().zip(&n) {
            for (p, f) in self.points[first..].iter().zip(&n[..=self.degree()]) {
                for (h, x) in h.iter_mut().zip(p) {
                    *h += f * x;
                }
            }
        }
        let at = |k: usize| SVector::<f64, D>::from_fn(|i, _| h[k][i]);
        let [w, w1, w2] = [h[0][3], h[1][3], h[2][3]];
        let point = at(0) / w;
        let d1 = (at(1) - point * w1) / w;
        let d2 = (at(2) - d1 * (2.0 * w1) - point * w2) / w;
        CurveJet { point, d1, d2 }
    }

    /// Point of the curve.
    pub fn point(&self, t: f64) -> SVector<f64, D> {
        let t = self.basis.snap(t);
        let span = self.basis.find_span(t);
        let mut n = [[0.0; WIDTH]];
        self.basis.evaluate(span, t, &mut n);
        let first = self.basis.first_function(span);
        let mut h = [0.0; 4];
        for (p, f) in self.points[first..].iter().zip(&n[0][..=self.degree()]) {
            for (h, x) in h.iter_mut().zip(p) {
                *h += f * x;
            }
        }
        SVector::from_fn(|i, _| h[i] / h[3])
    }

    /// The exact Bezier pieces, one per non-empty span of the domain.
    pub fn bezier_pieces(&self) -> Vec<CurvePiece> {
        let p = self.degree();
        (0..self.basis.span_count())
            .map(|span| {
                let domain = self.basis.span_range(span);
                let mut c = [[0.0; WIDTH]; WIDTH];
                self.basis.bezier_coefficients(span, domain, &mut c);
                let first = self.basis.first_function(span);
                let points = c[..=p]
                    .iter()
                    .map(|c| {
                        let mut sum = [0.0; 4];
                        for (c, point) in c[..=p].iter().zip(&self.points[first..]) {
                            for (sum, x) in sum.iter_mut().zip(point) {
                                *sum += c * x;
                            }
                        }
                        sum
                    })
                    .collect();
                CurvePiece { domain, points }
            })
            .collect()
    }
}
