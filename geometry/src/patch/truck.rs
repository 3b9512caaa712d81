//! Exchange with truck-geometry, whose knot and degree operations work on CAD data.

use truck_geometry::prelude::{BSplineSurface, KnotVec, NurbsSurface, Vector4};

use super::{NurbsPatch, PatchError, knot_error};
use crate::basis::{Basis, KnotError};

impl NurbsPatch {
    /// The patch as a surface of truck: same knots and control points. A domain that was narrowed with
    /// [`with_domain`](Self::with_domain) is not part of truck's surface and is lost.
    pub fn to_truck(&self) -> NurbsSurface<Vector4> {
        let [columns, rows] = self.counts();
        let point = |i: usize, j: usize| {
            let [x, y, z, w] = self.points[i + columns * j];
            Vector4::new(x, y, z, w)
        };
        let net = (0..columns)
            .map(|i| (0..rows).map(|j| point(i, j)).collect())
            .collect();
        let knots = |dir: usize| KnotVec::from(self.knots(dir).to_vec());
        // Knots and control points satisfy truck's conditions since they satisfy ours.
        NurbsSurface::new(BSplineSurface::new_unchecked((knots(0), knots(1)), net))
    }

    /// A surface of truck as a patch. Degrees follow from the numbers of knots and control points. After truck's degree
    /// elevation call its `optimize` first: elevation leaves inner knots of multiplicity `degree + 1`, which are refused.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and a control net that is not a full rectangle.
    pub fn from_truck(surface: &NurbsSurface<Vector4>) -> Result<Self, PatchError> {
        let net = surface.control_points();
        let columns = net.len();
        let rows = net.first().map_or(0, Vec::len);
        if let Some((row, line)) = net.iter().enumerate().find(|(_, line)| line.len() != rows) {
            return Err(PatchError::RaggedNet {
                row,
                expected: rows,
                found: line.len(),
            });
        }
        let basis = |dir: usize, knots: &KnotVec, count: usize| {
            let knots: Vec<f64> = knots.iter().copied().collect();
            let degree = knots.len().checked_sub(count + 1).ok_or(KnotError::Length {
                expected: count + 2,
                found: knots.len(),
            });
            degree
                .and_then(|degree| Basis::new(degree, knots, count))
                .map_err(knot_error(dir))
        };
        let (knots1, knots2) = surface.knot_vecs();
        let basis = [basis(0, knots1, columns)?, basis(1, knots2, rows)?];
        let points = (0..rows)
            .flat_map(|j| net.iter().map(move |line| line[j]))
            .map(|p| [p.x, p.y, p.z, p.w])
            .collect();
        Self::from_homogeneous(basis, points)
    }
}
