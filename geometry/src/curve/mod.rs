//! NURBS curves of the plane and of space: trim curves, and the curves that CAD files build surfaces from.

mod change;
pub mod conic;
mod eval;
pub mod fit;
pub(crate) mod join;

pub use eval::CurvePiece;

use nalgebra::SVector;

use crate::basis::{Basis, KnotError};

/// Why a curve could not be made. Indices count from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// Degree, knots or domain.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// Not as many control points or weights as the knots ask for.
    #[error("{found} weights for {expected} control points")]
    WeightCount {
        /// Control points.
        expected: usize,
        /// Weights found.
        found: usize,
    },
    /// A coordinate of a control point, or its product with the weight, is infinite or not a number.
    #[error("control point {0} is not finite")]
    Point(usize),
    /// A weight is not a positive finite number.
    #[error("the weight {value} of control point {index} is not a positive number")]
    Weight {
        /// Number of the point.
        index: usize,
        /// The weight.
        value: f64,
    },
}

/// A NURBS curve `c(t) = sum_k w_k P_k N_k(t) / sum_k w_k N_k(t)` in `D` dimensions, 2 (the parameter plane of a patch) or
/// 3, of any knot vector of degree 1 to [`MAX_DEGREE`](crate::basis::MAX_DEGREE).
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsCurve<const D: usize> {
    basis: Basis,
    /// Homogeneous control points (w x, w y, w z, w); w z is zero in the plane.
    points: Vec<[f64; 4]>,
}

/// Point of a curve with first and second derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveJet<const D: usize> {
    /// The point c.
    pub point: SVector<f64, D>,
    /// The tangent dc/dt.
    pub d1: SVector<f64, D>,
    /// The second derivative.
    pub d2: SVector<f64, D>,
}

impl<const D: usize> NurbsCurve<D> {
    /// Makes a curve of a full knot vector (`points.len() + degree + 1` entries) and unweighted control points; `weights`
    /// are all one where `None`.
    ///
    /// # Errors
    /// As for a patch: see [`CurveError`].
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        points: &[SVector<f64, D>],
        weights: Option<&[f64]>,
    ) -> Result<Self, CurveError> {
        const { assert!(D == 2 || D == 3, "curves of the plane or of space") };
        let basis = Basis::new(degree, knots, points.len())?;
        if let Some(weights) = weights
            && weights.len() != points.len()
        {
            return Err(CurveError::WeightCount {
                expected: points.len(),
                found: weights.len(),
            });
        }
        let homogeneous = points.iter().enumerate().map(|(k, x)| {
            let w = weights.map_or(1.0, |w| w[k]);
            let mut p = [0.0, 0.0, 0.0, w];
            for (p, x) in p.iter_mut().zip(x.iter()) {
                *p = x * w;
            }
            p
        });
        Self::from_homogeneous(basis, homogeneous.collect())
    }

    /// Makes a curve of homogeneous control points (w x, w y, w z, w), w z being zero in the plane.
    ///
    /// # Errors
    /// Numbers that are not finite, weights that are not positive, or not `basis.count()` points.
    pub fn from_homogeneous(basis: Basis, points: Vec<[f64; 4]>) -> Result<Self, CurveError> {
        if points.len() != basis.count() {
            return Err(CurveError::WeightCount {
                expected: basis.count(),
                found: points.len(),
            });
        }
        for (index, p) in points.iter().enumerate() {
            if !(p[3].is_finite() && p[3] > 0.0) {
                return Err(CurveError::Weight { index, value: p[3] });
            }
            if !p.iter().all(|x| x.is_finite()) {
                return Err(CurveError::Point(index));
            }
        }
        Ok(Self { basis, points })
    }

    /// The straight line from `a` to `b`, parameter 0 to 1.
    ///
    /// # Errors
    /// Coordinates that are not finite.
    pub fn line(a: SVector<f64, D>, b: SVector<f64, D>) -> Result<Self, CurveError> {
        Self::new(1, vec![0.0, 0.0, 1.0, 1.0], &[a, b], None)
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.basis.degree()
    }

    /// The basis with its knots and domain.
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// The interval of parameters that belongs to the curve.
    pub fn domain(&self) -> [f64; 2] {
        self.basis.domain()
    }

    /// Homogeneous control points (w x, w y, w z, w).
    pub fn homogeneous(&self) -> &[[f64; 4]] {
        &self.points
    }

    /// The curve with its end points moved to `ends`, by moving the first and the last control point; `None` where these
    /// are not the end points (unclamped knots, a domain that is a part of the knots'). A curve changes only in the spans at
    /// its ends, and nowhere by more than its ends do.
    pub fn with_ends(&self, ends: [SVector<f64, D>; 2]) -> Option<Self> {
        let knots = self.basis.knots();
        let (p, n) = (self.degree(), self.basis.count());
        let [start, end] = self.domain();
        let clamped =
            knots[1] == start && knots[p] == start && knots[n] == end && knots[n + p - 1] == end;
        if !clamped || !ends.iter().all(|x| x.iter().all(|x| x.is_finite())) {
            return None;
        }
        let mut points = self.points.clone();
        for (k, x) in [(0, &ends[0]), (n - 1, &ends[1])] {
            for (c, x) in x.iter().enumerate() {
                points[k][c] = x * points[k][3];
            }
        }
        Some(Self {
            basis: self.basis.clone(),
            points,
        })
    }

    /// The same curve run through from its end to its start, on the same domain: `t -> start + end - t`.
    ///
    /// # Errors
    /// None for knots that a curve can have; rounding of the mirrored knots is checked again.
    pub fn reversed(&self) -> Result<Self, CurveError> {
        let [a, b] = self.domain();
        let mirror = |t: f64| {
            let x = a + (b - t);
            // The ends of the domain are mapped exactly, and no knot crosses them.
            match t {
                t if t == a => b,
                t if t == b => a,
                t if t > b => x.min(a),
                t if t < a => x.max(b),
                _ => x.clamp(a, b),
            }
        };
        let knots = self
            .basis
            .knots()
            .iter()
            .rev()
            .map(|&t| mirror(t))
            .collect();
        let basis = Basis::new(self.degree(), knots, self.basis.count())?.with_domain([a, b])?;
        Self::from_homogeneous(basis, self.points.iter().rev().copied().collect())
    }

    /// First and last point.
    pub fn ends(&self) -> [SVector<f64, D>; 2] {
        self.domain().map(|t| self.point(t))
    }
}
