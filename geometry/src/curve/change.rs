//! Curves made from a curve.

use super::{CurveError, NurbsCurve};

impl<const D: usize> NurbsCurve<D> {
    /// The curve with every homogeneous control point (w x, w y, w z, w) mapped, same knots and domain. Where `map` is
    /// linear in the four numbers this is the mapped curve at the same parameters: an affine map `x -> A x + b` of the
    /// points is `(w x, w) -> (A (w x) + b w, w)`. In the plane w z has to stay zero.
    ///
    /// # Errors
    /// A mapped point that is not finite or whose weight is not positive.
    pub fn mapped(&self, map: impl Fn([f64; 4]) -> [f64; 4]) -> Result<Self, CurveError> {
        let points = self.points.iter().map(|&p| map(p)).collect();
        Self::from_homogeneous(self.basis.clone(), points)
    }
}
