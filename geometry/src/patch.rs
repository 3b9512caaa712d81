//! NURBS patches.
//!
//! Tensor-product surfaces `rho(xi) = sum_k w_k P_k N_k(xi) / sum_k w_k N_k(xi)` with any knot vectors of degree 1 to
//! [`MAX_DEGREE`](crate::basis::MAX_DEGREE): clamped or not, uniform or not, with repeated knots. Control points are
//! numbered with **xi1 fastest**: point `(i, j)` is entry `i + counts[0] * j`.

mod change;
mod eval;
mod extent;
mod kernel;
mod refine;
mod shape;
mod surface;
#[cfg(feature = "truck")]
mod truck;

pub use shape::PatchShape;

use crate::basis::{Basis, KnotError};
use crate::surface::Vec3;
use crate::trim::Trim;
use kernel::Kernel;
use std::sync::Arc;

/// Why a patch could not be made. Directions and indices count from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatchError {
    /// Degree, knots or domain of one direction.
    #[error("direction {direction}: {reason}")]
    Knots {
        /// 0 for xi1, 1 for xi2.
        direction: usize,
        /// What is wrong with it.
        reason: KnotError,
    },
    /// Not `counts[0] * counts[1]` control points.
    #[error("{found} control points where {expected} are needed")]
    PointCount {
        /// Points needed.
        expected: usize,
        /// Points found.
        found: usize,
    },
    /// Not as many weights as control points.
    #[error("{found} weights for {expected} control points")]
    WeightCount {
        /// Weights needed.
        expected: usize,
        /// Weights found.
        found: usize,
    },
    /// A coordinate of a control point, or its product with the weight, is infinite or not a number.
    #[error("control point ({}, {}) is not finite", index[0], index[1])]
    Point {
        /// Place of the point in the control net.
        index: [usize; 2],
    },
    /// A weight is not a positive finite number.
    #[error("the weight {value} of control point ({}, {}) is not a positive number", index[0], index[1])]
    Weight {
        /// Place of the point in the control net.
        index: [usize; 2],
        /// The weight.
        value: f64,
    },
    /// A trimmed patch cannot be split: its loops would have to be cut. Take [`NurbsPatch::with_domain`] instead, which
    /// leaves the loops whole.
    #[error("a trimmed patch cannot be split")]
    SplitTrimmed,
    /// A knot without which the surface would be another one.
    #[error(
        "direction {direction}: without knot {value} the surface would change by {change:e} of its control points' size"
    )]
    KnotNeeded {
        /// 0 for xi1, 1 for xi2.
        direction: usize,
        /// The knot.
        value: f64,
        /// Largest change of a homogeneous control point, as a share of the largest.
        change: f64,
    },
    /// A trim whose curves cannot follow a change of the patch.
    #[error("the trim cannot follow: {0}")]
    Trim(#[from] crate::trim::TrimError),
    /// A curve of a trim that cannot follow a change of the patch.
    #[error("a trim curve cannot follow: {0}")]
    TrimCurve(#[from] crate::curve::CurveError),
    /// A surface of the truck family whose control net is not a full rectangle.
    #[error("row {row} of the control net has {found} points where the first row has {expected}")]
    RaggedNet {
        /// Row of the control net.
        row: usize,
        /// Points in the first row.
        expected: usize,
        /// Points in this row.
        found: usize,
    },
}

/// A NURBS surface patch.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsPatch {
    basis: [Basis; 2],
    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest.
    points: Vec<[f64; 4]>,
    rational: bool,
    trim: Option<Arc<Trim>>,
    kernel: Kernel,
}

fn knot_error(direction: usize) -> impl Fn(KnotError) -> PatchError {
    move |reason| PatchError::Knots { direction, reason }
}

impl NurbsPatch {
    /// Makes a patch of full knot vectors (`counts[d] + degree[d] + 1` entries each) and unweighted control points,
    /// xi1 fastest; `weights` are all one where `None`.
    ///
    /// # Errors
    /// Degree outside of 1 to 15, sizes that do not fit, numbers that are not finite, decreasing knots, an inner knot
    /// repeated more often than the degree (the surface would be in pieces; exactly `degree` times is a crease and
    /// allowed), an empty domain, a weight that is not positive.
    pub fn new(
        degree: [usize; 2],
        knots: [Vec<f64>; 2],
        counts: [usize; 2],
        points: &[Vec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, PatchError> {
        let [knots1, knots2] = knots;
        let basis = [
            Basis::new(degree[0], knots1, counts[0]).map_err(knot_error(0))?,
            Basis::new(degree[1], knots2, counts[1]).map_err(knot_error(1))?,
        ];
        let expected = counts[0].saturating_mul(counts[1]);
        if points.len() != expected {
            return Err(PatchError::PointCount {
                expected,
                found: points.len(),
            });
        }
        let homogeneous: Vec<[f64; 4]> = match weights {
            None => points.iter().map(|x| [x.x, x.y, x.z, 1.0]).collect(),
            Some(weights) => {
                if weights.len() != expected {
                    return Err(PatchError::WeightCount {
                        expected,
                        found: weights.len(),
                    });
                }
                points
                    .iter()
                    .zip(weights)
                    .map(|(x, &w)| [x.x * w, x.y * w, x.z * w, w])
                    .collect()
            }
        };
        Self::from_homogeneous(basis, homogeneous)
    }

    /// Makes a patch of homogeneous control points (w x, w y, w z, w), xi1 fastest. Errors as for
    /// [`new`](Self::new), except those of the bases, which are checked already.
    pub fn from_homogeneous(basis: [Basis; 2], points: Vec<[f64; 4]>) -> Result<Self, PatchError> {
        let columns = basis[0].count();
        let expected = columns.saturating_mul(basis[1].count());
        if points.len() != expected {
            return Err(PatchError::PointCount {
                expected,
                found: points.len(),
            });
        }
        for (k, &[x, y, z, w]) in points.iter().enumerate() {
            let index = [k % columns, k / columns];
            if !(w.is_finite() && w > 0.0) {
                return Err(PatchError::Weight { index, value: w });
            }
            if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                return Err(PatchError::Point { index });
            }
        }
        let rational = points.iter().any(|p| p[3] != points[0][3]);
        Ok(Self {
            kernel: Kernel::new(&basis),
            basis,
            points,
            rational,
            trim: None,
        })
    }

    /// The part of the domain that belongs to the surface, where that is not all of it.
    pub fn trim(&self) -> Option<&Trim> {
        self.trim.as_deref()
    }

    /// The patch with this trim, or without any.
    pub fn with_trim(mut self, trim: Option<Trim>) -> Self {
        self.trim = trim.map(Arc::new);
        self
    }

    /// The patch with its jets computed by the code for any processor, where otherwise AVX2 and FMA would be used: to
    /// compare both, and for the same bits on machines that have them and on those that have not. Patches made from it by
    /// operations use the fastest code again.
    pub fn with_portable_kernel(mut self) -> Self {
        self.kernel = self.kernel.portable();
        self
    }

    /// Whether the code for any processor computes the jets.
    pub fn has_portable_kernel(&self) -> bool {
        self.kernel.is_portable()
    }

    /// Polynomial degrees.
    pub fn degree(&self) -> [usize; 2] {
        [self.basis[0].degree(), self.basis[1].degree()]
    }

    /// Number of control points in each direction.
    pub fn counts(&self) -> [usize; 2] {
        [self.basis[0].count(), self.basis[1].count()]
    }

    /// The basis of direction `dir`: 0 is xi1, anything else xi2 (so also wherever else a `dir` is asked for).
    pub fn basis(&self, dir: usize) -> &Basis {
        &self.basis[dir.min(1)]
    }

    /// Full knot vector of direction `dir`.
    pub fn knots(&self, dir: usize) -> &[f64] {
        self.basis(dir).knots()
    }

    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest.
    pub fn homogeneous(&self) -> &[[f64; 4]] {
        &self.points
    }

    /// Control points, xi1 fastest.
    pub fn points(&self) -> Vec<Vec3> {
        self.points
            .iter()
            .map(|&[x, y, z, w]| Vec3::new(x / w, y / w, z / w))
            .collect()
    }

    /// Weights, xi1 fastest.
    pub fn weights(&self) -> Vec<f64> {
        self.points.iter().map(|p| p[3]).collect()
    }

    /// Whether the weights differ.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The rectangle of parameters that belongs to the patch: `[direction][start, end]`.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        [self.basis[0].domain(), self.basis[1].domain()]
    }

    /// Non-empty knot spans of direction `dir`, the first and last cut at the domain. Their places in this list are
    /// the span numbers that other functions take.
    pub fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        let basis = self.basis(dir);
        (0..basis.span_count())
            .map(|span| basis.span_range(span))
            .collect()
    }
}
