//! What a surface gives: jets (a point with its parametric derivatives) and its exact Bezier pieces.

use num_dual::DualNum;

use crate::bezier::BezierPiece;
use crate::trim::Trim;

/// A point or vector of three-dimensional space.
pub type Vec3<D = f64> = nalgebra::Vector3<D>;

/// Surface point with first and second parametric derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<D = f64> {
    /// Surface point rho.
    pub rho: Vec3<D>,
    /// Tangents rho_1, rho_2.
    pub rho_i: [Vec3<D>; 2],
    /// Second derivatives in the order 11, 12, 22.
    pub rho_ij: [Vec3<D>; 3],
}

/// A [`Jet`] with third derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet3<D = f64> {
    /// The point with its first and second derivatives.
    pub jet: Jet<D>,
    /// Third derivatives in the order 111, 112, 122, 222.
    pub rho_ijk: [Vec3<D>; 4],
}

/// One surface patch over a rectangle of parameters, as contact and projection see it: a NURBS patch, a bilinear or a
/// biquadratic facet. Whatever stands above asks for nothing else, so what holds for one holds for all.
///
/// Every surface is piecewise (rational) polynomial. *Spans* are the rectangles of its pieces, numbered from zero in
/// each direction; a facet has one.
pub trait Surface: Clone + Send + Sync + std::fmt::Debug {
    /// The rectangle of parameters that belongs to the surface: `[direction][start, end]`.
    fn domain(&self) -> [[f64; 2]; 2];

    /// Parameter ranges of the spans of direction `dir` (0 or 1), in order.
    fn spans(&self, dir: usize) -> Vec<[f64; 2]>;

    /// Numbers of the spans that hold `xi`; at the border of two, the one to the right.
    fn find_span(&self, xi: [f64; 2]) -> [usize; 2];

    /// Jet of the piece of span `span` at `xi`, inside of the span or not: choosing the span gives one-sided
    /// derivatives where the surface has a kink.
    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet;

    /// Surface point with first and second derivatives.
    fn jet(&self, xi: [f64; 2]) -> Jet {
        self.jet_in_span(self.find_span(xi), xi)
    }

    /// Surface point.
    fn point(&self, xi: [f64; 2]) -> Vec3 {
        self.jet(xi).rho
    }

    /// The same surface with the same parameters in Bezier form: one piece per pair of spans, those of xi1 fastest.
    fn bezier_pieces(&self) -> Vec<BezierPiece>;

    /// The one of the [`bezier_pieces`](Self::bezier_pieces) that belongs to a pair of spans, to the last bit. Sets of patches
    /// ask for one at a time: surfaces of many spans should not make all of them for it, as this does unless overridden.
    ///
    /// # Panics
    /// May panic if there is no such span.
    fn bezier_piece(&self, span: [usize; 2]) -> BezierPiece {
        let number = span[0] + self.spans(0).len() * span[1];
        self.bezier_pieces().swap_remove(number)
    }

    /// Parameters inside the domain of direction `dir` at which the tangents may jump.
    fn crease_knots(&self, _dir: usize) -> Vec<f64> {
        Vec::new()
    }

    /// The [`crease_knots`](Self::crease_knots) across which the normal turns by more than `angle` (radians).
    fn sharp_knots(&self, _dir: usize, _angle: f64) -> Vec<f64> {
        Vec::new()
    }

    /// The part of the domain that belongs to the surface, where that is not all of it.
    fn trim(&self) -> Option<&Trim> {
        None
    }

    /// Whether a search for closest points may continue. The search asks this for each piece, and each part of a piece, that it
    /// examines. If the answer is `false`, it returns the best point found so far as not converged. Joining patches asks it for
    /// each pair of edges that come near each other, and does not join those for which it is `false`. Override this to bound the
    /// work of both; the default costs nothing.
    #[inline]
    fn may_go_on(&self) -> bool {
        true
    }

    /// Whether the polyline by which an edge is compared with others may have another point where the edge turns. Override this
    /// to bound the memory for joining patches; the default costs nothing.
    #[inline]
    fn may_sample(&self) -> bool {
        true
    }
}

/// Derivatives of `numerator / weight` from those of both, in the order 0 | 1, 2 | 11, 12, 22: the quotient rule solved
/// for the highest derivative (Piegl and Tiller 1997, eq. 4.20).
#[inline]
pub(crate) fn quotient<D: DualNum<f64> + Copy>(a: &[Vec3<D>; 6], w: &[D; 6]) -> Jet<D> {
    let inv = w[0].recip();
    let rho = a[0] * inv;
    let rho_1 = (a[1] - rho * w[1]) * inv;
    let rho_2 = (a[2] - rho * w[2]) * inv;
    let two = D::from(2.0);
    Jet {
        rho,
        rho_i: [rho_1, rho_2],
        rho_ij: [
            (a[3] - rho_1 * (w[1] * two) - rho * w[3]) * inv,
            (a[4] - rho_1 * w[2] - rho_2 * w[1] - rho * w[4]) * inv,
            (a[5] - rho_2 * (w[2] * two) - rho * w[5]) * inv,
        ],
    }
}

/// [`quotient`] to third order; the last four entries are 111, 112, 122, 222.
pub(crate) fn quotient3<D: DualNum<f64> + Copy>(a: &[Vec3<D>; 10], w: &[D; 10]) -> Jet3<D> {
    let jet = quotient(
        &[a[0], a[1], a[2], a[3], a[4], a[5]],
        &[w[0], w[1], w[2], w[3], w[4], w[5]],
    );
    let Jet {
        rho,
        rho_i: [r1, r2],
        rho_ij: [r11, r12, r22],
    } = jet;
    let inv = w[0].recip();
    let (two, three) = (D::from(2.0), D::from(3.0));
    let r111 = (a[6] - (r11 * w[1] + r1 * w[3]) * three - rho * w[6]) * inv;
    let r112 = (a[7] - (r12 * w[1] + r1 * w[4]) * two - r11 * w[2] - r2 * w[3] - rho * w[7]) * inv;
    let r122 = (a[8] - (r12 * w[2] + r2 * w[4]) * two - r22 * w[1] - r1 * w[5] - rho * w[8]) * inv;
    let r222 = (a[9] - (r22 * w[2] + r2 * w[5]) * three - rho * w[9]) * inv;
    Jet3 {
        jet,
        rho_ijk: [r111, r112, r122, r222],
    }
}
