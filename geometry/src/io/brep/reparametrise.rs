//! Surface parameters of the file against those of the NURBS patch, direction by direction.

use nalgebra::Vector2;

use super::parameter_map::ParameterMap;
use crate::NurbsCurve;
use crate::curve::CurveJet;
use crate::curve::fit::{FitError, fit};

/// How the parameters that trims of a surface refer to lie on its NURBS patch: each direction by itself, in the same
/// order, no direction exchanged.
#[derive(Debug, Clone, PartialEq)]
pub struct Reparametrise {
    /// File's parameter to patch's, for xi1 and xi2.
    pub directions: [ParameterMap; 2],
}

impl Reparametrise {
    /// Both parameters are those of the file.
    pub(super) fn identity(domain: [[f64; 2]; 2]) -> Self {
        Self {
            directions: domain.map(ParameterMap::identity),
        }
    }

    /// Whether the patch has the file's parameters.
    pub fn is_identity(&self) -> bool {
        self.directions.iter().all(ParameterMap::is_identity)
    }

    /// Patch parameters of the point with the file's parameters `xi`.
    pub fn to_patch(&self, xi: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.directions[d].to_own(xi[d]))
    }

    /// The file's parameters of the point with the patch's parameters `xi`.
    pub fn to_file(&self, xi: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.directions[d].to_file(xi[d]))
    }

    /// The same for a file that gives the angles of directions in `which` in radians where this expects degrees.
    pub fn in_radians(&self, which: [bool; 2]) -> Self {
        let mut directions = self.directions.clone();
        for (map, _) in directions.iter_mut().zip(which).filter(|(_, w)| *w) {
            let [a, b] = map.file_range();
            *map = map.with_file_range([a.to_radians(), b.to_radians()], false);
        }
        Self { directions }
    }

    /// Whole turns (0 for what is no angle) to be added to file parameters that span the box `bounds`
    /// (`[direction][low, high]`), so that they lie on the patch; the same for all curves of a loop.
    pub fn turns(&self, bounds: [[f64; 2]; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.directions[d].turns(bounds[d]))
    }

    /// A curve of file parameters, moved by `shift`, as a curve of patch parameters, with its largest deviation from the
    /// mapped points (a share of the patch's domain; 0 where the result is exact). Exact where both directions are
    /// affine, and for a straight line along one parameter, whose image is straight; else fitted by
    /// [`fit`](crate::curve::fit::fit) with the curve's parameter and at most `tolerance`.
    ///
    /// # Errors
    /// See [`FitError`].
    pub fn curve(
        &self,
        curve: &NurbsCurve<2>,
        shift: [f64; 2],
        tolerance: f64,
    ) -> Result<(NurbsCurve<2>, f64), FitError> {
        let shift = Vector2::from(shift);
        let affine = [0, 1].map(|d| self.directions[d].as_affine());
        if let [Some([f0, s0]), Some([f1, s1])] = affine {
            let factor = Vector2::new(f0, f1);
            let offset = Vector2::new(s0, s1);
            if self.is_identity() && shift == Vector2::zeros() {
                return Ok((curve.clone(), 0.0));
            }
            let mapped = curve.transformed(&|x| (x + shift).component_mul(&factor) + offset)?;
            return Ok((mapped, 0.0));
        }
        let to = |x: Vector2<f64>| Vector2::from(self.to_patch((x + shift).into()));
        if let Some(line) = self.straight(curve, &to)? {
            return Ok((line, 0.0));
        }
        let domains = self.directions.each_ref().map(ParameterMap::own_range);
        let extent = Vector2::from(domains.map(|[a, b]| (b - a).abs()));
        let mapped = |piece: usize, t: f64| {
            let jet = curve.jet_in_span(piece, t);
            let maps = [0, 1].map(|d| self.directions[d].jet(jet.point[d] + shift[d]));
            // In shares of the domain, so that one tolerance does for both directions.
            let scaled = |v: [f64; 2]| Vector2::from(v).component_div(&extent);
            CurveJet {
                point: scaled([0, 1].map(|d| maps[d][0])),
                d1: scaled([0, 1].map(|d| maps[d][1] * jet.d1[d])),
                d2: scaled(
                    [0, 1].map(|d| maps[d][2] * jet.d1[d] * jet.d1[d] + maps[d][1] * jet.d2[d]),
                ),
            }
        };
        let mut breaks: Vec<f64> = (0..curve.basis().span_count())
            .map(|span| curve.basis().span_range(span)[0])
            .collect();
        breaks.push(curve.domain()[1]);
        let (fitted, deviation) = fit(&mapped, &breaks, tolerance)?;
        let fitted = fitted.transformed(&|x| x.component_mul(&extent))?;
        Ok((fitted, deviation))
    }

    /// The image of a straight line along a direction, or along any one where that direction's map is affine and the
    /// other coordinate does not change.
    fn straight(
        &self,
        curve: &NurbsCurve<2>,
        to: &dyn Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> Result<Option<NurbsCurve<2>>, FitError> {
        let [a, b] = curve.ends();
        let size = |d: usize| {
            let [low, high] = self.directions[d].file_range();
            1e-12 * (high - low)
        };
        let points = curve.homogeneous().iter();
        let points: Vec<[f64; 2]> = points.map(|p| [p[0] / p[3], p[1] / p[3]]).collect();
        for d in 0..2 {
            let constant = points.iter().all(|p| (p[d] - a[d]).abs() <= size(d));
            let forward = (b[1 - d] - a[1 - d]).signum();
            let monotone = points
                .windows(2)
                .all(|p| (p[1][1 - d] - p[0][1 - d]) * forward >= 0.0);
            if constant && monotone && a != b {
                let line = NurbsCurve::line(to(a), to(b))?;
                return Ok(Some(line.with_parameters(curve.domain())?));
            }
        }
        Ok(None)
    }
}
