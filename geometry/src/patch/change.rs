//! Patches made from a patch: part of the domain, moved, reversed, swapped.

use nalgebra::Isometry3;

use super::{NurbsPatch, PatchError, knot_error};
use crate::basis::Basis;
use crate::surface::Vec3;
use crate::trim::{Trim, TrimCurve, TrimLoop};

impl NurbsPatch {
    /// The same surface on a part of its domain: `[direction][start, end]` inside the knots' own domain
    /// `[knots[degree], knots[count]]` (ends that miss it by 1e-9 of its length are moved onto it). Control points
    /// and parameters stay as they are, and so does a trim, whose loops may now reach out of the domain.
    pub fn with_domain(&self, domain: [[f64; 2]; 2]) -> Result<Self, PatchError> {
        let [b1, b2] = &self.basis;
        let basis = [
            b1.with_domain(domain[0]).map_err(knot_error(0))?,
            b2.with_domain(domain[1]).map_err(knot_error(1))?,
        ];
        let mut patch = Self::from_homogeneous(basis, self.points.clone())?;
        patch.trim = self.trim.clone();
        Ok(patch)
    }

    /// The patch with every control point mapped, weights kept: the mapped surface where the map is affine, and only
    /// there. The curves of a trim in space are mapped likewise.
    ///
    /// # Errors
    /// A mapped point that is not finite.
    pub fn transformed(&self, map: &dyn Fn(Vec3) -> Vec3) -> Result<Self, PatchError> {
        let map = |[x, y, z, w]: [f64; 4]| {
            let y = map(Vec3::new(x / w, y / w, z / w));
            [y.x * w, y.y * w, y.z * w, w]
        };
        let points = self.points.iter().map(|&p| map(p)).collect();
        let patch = Self::from_homogeneous(self.basis.clone(), points)?;
        patch.trimmed_as(self, |p| p, map)
    }

    /// The patch scaled about the origin and then moved: `x -> motion(scale x)`.
    pub fn moved(&self, motion: &Isometry3<f64>, scale: f64) -> Result<Self, PatchError> {
        self.transformed(&|x| motion.rotation * (x * scale) + motion.translation.vector)
    }

    /// The patch with direction `dir` running backwards on the same domain, `xi -> start + end - xi`; turns
    /// `rho_1 x rho_2` over. The parameter curves of a trim are mirrored.
    ///
    /// # Errors
    /// Knots that coincide once they are mirrored and rounded.
    pub fn reversed(&self, dir: usize) -> Result<Self, PatchError> {
        let dir = dir.min(1);
        let mut basis = self.basis.clone();
        basis[dir] = reversed(&self.basis[dir]).map_err(knot_error(dir))?;
        let columns = self.basis[0].count();
        let mut points = self.points.clone();
        if dir == 0 {
            points.chunks_exact_mut(columns).for_each(<[_]>::reverse);
        } else {
            points = self
                .points
                .chunks_exact(columns)
                .rev()
                .flatten()
                .copied()
                .collect();
        }
        let [a, b] = self.basis[dir].domain();
        let mirror = |mut p: [f64; 4]| {
            p[dir] = (a + b) * p[3] - p[dir];
            p
        };
        Self::from_homogeneous(basis, points)?.trimmed_as(self, mirror, |p| p)
    }

    /// The patch with xi1 and xi2 exchanged; turns `rho_1 x rho_2` over. So are the coordinates of a trim's parameter
    /// curves.
    ///
    /// # Errors
    /// A trim that is not valid.
    pub fn swapped(&self) -> Result<Self, PatchError> {
        let [b1, b2] = self.basis.clone();
        let [columns, rows] = self.counts();
        let points = (0..columns)
            .flat_map(|i| (0..rows).map(move |j| i + columns * j))
            .map(|k| self.points[k])
            .collect();
        let patch = Self::from_homogeneous([b2, b1], points)?;
        patch.trimmed_as(self, |[x, y, z, w]| [y, x, z, w], |p| p)
    }

    /// With the trim of `other`, whose homogeneous control points are mapped in the parameter plane and in space.
    fn trimmed_as(
        self,
        other: &Self,
        parameter: impl Fn([f64; 4]) -> [f64; 4],
        space: impl Fn([f64; 4]) -> [f64; 4],
    ) -> Result<Self, PatchError> {
        let Some(trim) = other.trim() else {
            return Ok(self);
        };
        let curve = |curve: &TrimCurve| {
            let mapped = curve.space.as_ref().map(|c| c.mapped(&space));
            Ok::<_, PatchError>(TrimCurve {
                parameter: curve.parameter.mapped(&parameter)?,
                space: mapped.transpose()?,
                entity: curve.entity,
            })
        };
        let loops = trim.loops().iter().map(|one| {
            let curves = one.curves.iter().map(curve);
            Ok::<_, PatchError>(TrimLoop {
                curves: curves.collect::<Result<_, _>>()?,
            })
        });
        let loops = loops.collect::<Result<_, _>>()?;
        // The loops were closed before.
        let trim = Trim::new(loops, self.domain(), f64::INFINITY)?;
        Ok(self.with_trim(Some(trim)))
    }
}

/// Mirrors knots about the middle of the domain. The domain's ends are mapped exactly, and rounding cannot put a knot
/// on the other side of them.
fn reversed(basis: &Basis) -> Result<Basis, crate::basis::KnotError> {
    let [a, b] = basis.domain();
    let mirror = |t: f64| {
        let x = a + (b - t);
        if t > b {
            x.min(a)
        } else if t == b {
            a
        } else if t == a {
            b
        } else if t < a {
            x.max(b)
        } else {
            x.clamp(a, b)
        }
    };
    let knots = basis.knots().iter().rev().map(|&t| mirror(t)).collect();
    Basis::new(basis.degree(), knots, basis.count())?.with_domain([a, b])
}
