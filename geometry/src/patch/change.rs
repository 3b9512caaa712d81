//! Patches made from a patch: part of the domain, moved, reversed, swapped.

use nalgebra::Isometry3;

use super::{NurbsPatch, PatchError, knot_error};
use crate::basis::Basis;
use crate::surface::Vec3;

impl NurbsPatch {
    /// The same surface on a part of its domain: `[direction][start, end]` inside the knots' own domain
    /// `[knots[degree], knots[count]]` (ends that miss it by 1e-9 of its length are moved onto it). Control points
    /// and parameters stay as they are.
    pub fn with_domain(&self, domain: [[f64; 2]; 2]) -> Result<Self, PatchError> {
        let [b1, b2] = &self.basis;
        let basis = [
            b1.with_domain(domain[0]).map_err(knot_error(0))?,
            b2.with_domain(domain[1]).map_err(knot_error(1))?,
        ];
        Ok(Self {
            basis,
            points: self.points.clone(),
            rational: self.rational,
            trim: None,
        })
    }

    /// The patch with every control point mapped, weights kept: the mapped surface where the map is affine, and only
    /// there. Errors where a mapped point is not finite.
    pub fn transformed(&self, map: &dyn Fn(Vec3) -> Vec3) -> Result<Self, PatchError> {
        let map = |&[x, y, z, w]: &[f64; 4]| {
            let y = map(Vec3::new(x / w, y / w, z / w));
            [y.x * w, y.y * w, y.z * w, w]
        };
        let points = self.points.iter().map(map).collect();
        Self::from_homogeneous(self.basis.clone(), points)
    }

    /// The patch scaled about the origin and then moved: `x -> motion(scale x)`.
    pub fn moved(&self, motion: &Isometry3<f64>, scale: f64) -> Result<Self, PatchError> {
        self.transformed(&|x| motion.rotation * (x * scale) + motion.translation.vector)
    }

    /// The patch with direction `dir` running backwards on the same domain, `xi -> start + end - xi`; turns
    /// `rho_1 x rho_2` over.
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
        Ok(Self {
            basis,
            points,
            rational: self.rational,
            trim: None,
        })
    }

    /// The patch with xi1 and xi2 exchanged; turns `rho_1 x rho_2` over.
    pub fn swapped(&self) -> Self {
        let [b1, b2] = self.basis.clone();
        let [columns, rows] = self.counts();
        let points = (0..columns)
            .flat_map(|i| (0..rows).map(move |j| i + columns * j))
            .map(|k| self.points[k])
            .collect();
        Self {
            basis: [b2, b1],
            points,
            rational: self.rational,
            trim: None,
        }
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
