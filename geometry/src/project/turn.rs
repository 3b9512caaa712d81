//! How normals turn where a patch alone does not say it: pseudo-normals along edges and creases, normals about poles.

use nalgebra::{Matrix2, Matrix3, Vector2};

use super::set::PatchSet;
use super::topology::{EdgeCurve, edge_point, nearest_on_edge};
use super::{Foot, Location};
use crate::frame::Frame;
use crate::surface::{Jet, Surface, Vec3};

/// Ways out of a pole that are asked for their curvature.
const MERIDIANS: usize = 16;
/// What the curvatures about a pole may miss those of a smooth surface by (relative), and the slope of a way out its
/// tangent plane.
const SMOOTH: f64 = 1e-6;
/// A foot this close to a pole (relative to the size of the set) takes its surface from there: what that leaves out is of the
/// order of its square, what a tangent next to the pole has lost in rounding grows with its inverse.
const NEXT_TO: f64 = 3e-6;

impl<S: Surface> PatchSet<S> {
    /// Derivative of the [pseudo-normal](Foot::normal) of a foot on an edge between faces or on a crease, as the foot moves
    /// along it by `along` (a vector of space along the line). Zero at any other place.
    #[cold]
    #[inline(never)]
    pub fn normal_along(&self, foot: &Foot, along: &Vec3) -> Vec3 {
        let (mut sum, mut slope) = (Vec3::zeros(), Vec3::zeros());
        let mut add = |jet: &Jet, side: f64| {
            if let Some(frame) = Frame::new(jet, side) {
                let (up, n_i) = (frame.rho_up(), frame.n_i());
                sum += frame.n;
                slope += n_i[0] * up[0].dot(along) + n_i[1] * up[1].dot(along);
            }
        };
        match foot.location {
            Location::Edge { edge, .. } => {
                add(&foot.jet, foot.side);
                let Some(index) = self.topology.index(foot.patch, edge) else {
                    return Vec3::zeros();
                };
                let t = nearest_on_edge(self, &foot.jet.rho, &self.topology.edges[index]).t;
                for (link, at) in self.behind(index, t, &foot.jet.rho) {
                    let patch = self.topology.edges[link.edge].patch;
                    add(&at.jet, self.sides[patch as usize]);
                }
            }
            Location::Crease { dir } => {
                let Some(patch) = self.patches.get(foot.patch as usize) else {
                    return Vec3::zeros();
                };
                let dir = dir as usize;
                let mut span = patch.find_span(foot.xi);
                add(&patch.jet_in_span(span, foot.xi), foot.side);
                let Some(before) = span[dir].checked_sub(1) else {
                    return Vec3::zeros();
                };
                span[dir] = before;
                add(&patch.jet_in_span(span, foot.xi), foot.side);
            }
            _ => {}
        }
        let length = sum.norm();
        if length <= 1e-12 {
            return Vec3::zeros();
        }
        (slope - foot.normal * foot.normal.dot(&slope)) / length
    }

    /// The surface around the foot of `q` on a pole or right next to one (3e-6 of the size), as a jet whose tangents are unit
    /// vectors across each other and the outward normal `rho_1 x rho_2`: what the patch's own parameters do not give there, or
    /// only with the digits that are left of a tangent that vanishes. The curvature is that of the ways out of the pole, along
    /// which the patch is regular: the normal curvature in a direction is a quadratic form of it, of which three directions
    /// tell all. `None` anywhere else, and where the ways out do not lie on a smooth surface (the tip of a cone).
    #[cold]
    #[inline(never)]
    pub fn pole_jet(&self, foot: &Foot, q: &Vec3) -> Option<Jet> {
        let on_pole = matches!(foot.location, Location::Pole { .. });
        let edge = match foot.location {
            Location::Pole { edge } => {
                &self.topology.edges[self.topology.index(foot.patch, edge)?]
            }
            Location::Face => {
                let poles = self
                    .topology
                    .of(foot.patch)
                    .iter()
                    .filter(|e| e.kind.is_none());
                let near = |rho: &Vec3| (rho - foot.jet.rho).norm() <= NEXT_TO * self.size;
                poles.into_iter().find(|e| near(&e.samples[0].point))?
            }
            _ => return None,
        };
        let EdgeCurve::Side { dir, .. } = edge.curve else {
            return None;
        };
        let [a, b] = edge.interval;
        let pole = edge_point(self, edge, 0.5 * (a + b)).jet.rho;
        let ways: [[Vec3; 2]; MERIDIANS] = std::array::from_fn(|k| {
            let t = a + (b - a) * (k as f64 + 0.5) / MERIDIANS as f64;
            let jet = edge_point(self, edge, t).jet;
            let (out, bend) = (jet.rho_i[dir], jet.rho_ij[2 * dir]);
            [out / out.norm(), bend / out.norm_squared()]
        });
        // Across all ways out; the mean of normals around the pole is off it by what they turn within a little of it.
        let across = |pair: &[[Vec3; 2]]| pair[0][0].cross(&pair[1][0]);
        let sum: Vec3 = ways.windows(2).map(across).sum();
        let n = sum.try_normalize(0.0)? * sum.dot(&foot.normal).signum();
        let first = Vec3::ith(n.iamin(), 1.0).cross(&n).try_normalize(0.0)?;
        let axes = [first, n.cross(&first)];
        let mut rows = [(Vec3::zeros(), 0.0); MERIDIANS];
        let (mut normal, mut right) = (Matrix3::zeros(), Vec3::zeros());
        for (row, [out, bend]) in rows.iter_mut().zip(&ways) {
            // Not for the tip of a cone, nor for what is not finite.
            let flat = out.dot(&n).abs() <= SMOOTH;
            if !(flat && (!on_pole || out.dot(&foot.normal).abs() <= SMOOTH)) {
                return None;
            }
            let [c, s] = axes.map(|e| e.dot(out));
            let along = Vec3::new(c * c, 2.0 * c * s, s * s);
            let curvature = bend.dot(&n);
            *row = (along, curvature);
            normal += along * along.transpose();
            right += along * curvature;
        }
        let shape = normal.cholesky()?.solve(&right);
        let miss = |row: &(Vec3, f64)| (row.0.dot(&shape) - row.1).abs();
        let limit = SMOOTH * shape.amax() + 1e-9 / self.size;
        let smooth = shape.iter().all(|x| x.is_finite()) && rows.iter().all(|r| miss(r) <= limit);
        if !smooth {
            return None;
        }
        // Where the foot really is, (1 - xi3 h) s = what `q` lies beside the pole, and how the normal has turned on the way.
        let d = q - pole;
        let h = Matrix2::new(shape.x, shape.y, shape.y, shape.z);
        let beside = Vector2::new(axes[0].dot(&d), axes[1].dot(&d));
        // A pole that holds the point, as a corner does, is the foot itself.
        let s = (Matrix2::identity() - h * n.dot(&d))
            .try_inverse()
            .map(|m| m * beside);
        let s = s
            .filter(|s| s.norm() <= NEXT_TO * self.size)
            .unwrap_or_default();
        let bend = h * s;
        let n = (n - axes[0] * bend.x - axes[1] * bend.y).normalize();
        let first = (axes[0] - n * n.dot(&axes[0])).normalize();
        let rise = n * (0.5 * s.dot(&bend));
        Some(Jet {
            rho: pole + axes[0] * s.x + axes[1] * s.y + rise,
            rho_i: [first, n.cross(&first)],
            rho_ij: [n * shape.x, n * shape.y, n * shape.z],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NurbsPatch;
    use crate::primitives::sphere;

    #[test]
    fn poles_of_an_ellipsoid_have_its_curvatures() {
        let ball = sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap();
        let (a, b, c) = (1.3, 0.8, 0.6);
        let patch = (ball.transformed(&|x| Vec3::new(a * x.x, b * x.y, c * x.z))).unwrap();
        let set = PatchSet::new(vec![patch], None).unwrap();
        for (z, inside) in [(c, 0.9), (c, 1.2), (-c, 0.9)] {
            let q = Vec3::new(0.0, 0.0, z * inside);
            let foot = set.project(&q, None, 1.0).unwrap();
            assert!(matches!(foot.location, Location::Pole { .. }));
            let jet = set.pole_jet(&foot, &q).expect("smooth");
            let frame = Frame::new(&jet, 1.0).unwrap();
            assert!((frame.n - Vec3::new(0.0, 0.0, z.signum())).norm() < 1e-12);
            let [low, high] = frame.principal_curvatures();
            // z = c sqrt(1 - x^2/a^2 - y^2/b^2): c / a^2 and c / b^2.
            assert!((low + c / (b * b)).abs() < 1e-9, "{low}");
            assert!((high + c / (a * a)).abs() < 1e-9, "{high}");
            let along = frame.rho_i[0] * frame.h[0] + frame.rho_i[1] * frame.h[1];
            assert!(along.norm() > 0.1);
        }
        // Off the pole there is nothing to say.
        let q = Vec3::new(0.3, 0.1, 0.4);
        let foot = set.project(&q, None, 1.0).unwrap();
        assert_eq!(set.pole_jet(&foot, &q), None);
    }

    #[test]
    fn normals_next_to_a_pole_keep_their_digits() {
        let (a, b, c) = (1.3, 0.8, 0.6);
        let ball = sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap();
        let patch = (ball.transformed(&|x| Vec3::new(a * x.x, b * x.y, c * x.z))).unwrap();
        let set = PatchSet::new(vec![patch], None).unwrap();
        let mut next_to = 0;
        for away in [1e-12, 1e-10, 1e-9, 1e-8, 3e-8, 1e-7, 4e-7, 1e-6, 1e-5] {
            for (direction, gap) in [([1.0, 0.0], -1e-3), ([0.3, -0.8], 1e-3), ([0.0, 1.0], -0.1)] {
                // A point of the ellipsoid, its normal, and a point above it.
                let (x, y) = (away * direction[0], away * direction[1]);
                let z = c * (1.0 - (x / a).powi(2) - (y / b).powi(2)).sqrt();
                let n = Vec3::new(x / (a * a), y / (b * b), z / (c * c)).normalize();
                let q = Vec3::new(x, y, z) + n * gap;
                let foot = set.project(&q, None, 1.0).unwrap();
                let jet = set.pole_jet(&foot, &q);
                next_to += usize::from(jet.is_some() && foot.location == Location::Face);
                let frame = Frame::new(&jet.unwrap_or(foot.jet), 1.0).unwrap();
                let error = (frame.n - n).norm();
                assert!(error < 2e-11, "{away:e} {gap:e}: {error:e}");
                if let Some(jet) = jet {
                    let error = (jet.rho - Vec3::new(x, y, z)).norm();
                    assert!(error < 1e-13, "{away:e} {gap:e}: {error:e}");
                }
            }
        }
        assert!(next_to >= 9, "{next_to}");
    }

    #[test]
    fn the_tip_of_a_cone_has_no_curvature() {
        // A quarter of a cone, tip up.
        let w = 0.5f64.sqrt();
        let arc = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut points: Vec<Vec3> = arc.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
        points.extend([Vec3::new(0.0, 0.0, 0.5); 3]);
        let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
        let weights = [1.0, w, 1.0, 1.0, w, 1.0];
        let patch = NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&weights)).unwrap();
        let set = PatchSet::new(vec![patch], None).unwrap();
        let q = Vec3::new(-0.01, -0.01, 0.7);
        let foot = set.project(&q, None, 1.0).unwrap();
        assert!(matches!(foot.location, Location::Pole { .. }), "{foot:?}");
        assert_eq!(set.pole_jet(&foot, &q), None);
    }

    #[test]
    fn pseudo_normals_turn_along_edges_and_creases() {
        // A curved roof, bent along its ridge: two biquadratic patches, and the same as one patch with a crease.
        let side = |sign: f64| -> Vec<Vec3> {
            (0..9)
                .map(|k| (f64::from(k % 3) * 0.5, f64::from(k / 3) * 0.5 - 0.5))
                .map(|(x, y)| {
                    let z = 0.3 * y * y + 0.2 * x * x * (1.0 + y) - 0.6 * x + 0.2 * x * y * sign;
                    Vec3::new(sign * (x + 0.1 * y * y), y, z)
                })
                .collect()
        };
        let bezier = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let patch = |points: &[Vec3]| {
            NurbsPatch::new([2, 2], [bezier(), bezier()], [3, 3], points, None).unwrap()
        };
        // The sides meet where x is 0 for both: bend them back together.
        let right = side(1.0);
        let left: Vec<Vec3> = (side(-1.0).into_iter().enumerate())
            .map(|(k, p)| if k % 3 == 0 { right[k] } else { p })
            .collect();
        let two = PatchSet::new(vec![patch(&right), patch(&left)], None).unwrap();
        let row = |j: usize| {
            [
                left[3 * j + 2],
                left[3 * j + 1],
                right[3 * j],
                right[3 * j + 1],
                right[3 * j + 2],
            ]
        };
        let joined: Vec<Vec3> = (0..3).flat_map(row).collect();
        let kink = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        let one = NurbsPatch::new([2, 2], [kink, bezier()], [5, 3], &joined, None).unwrap();
        let one = PatchSet::new(vec![one], None).unwrap();
        for set in [&two, &one] {
            let at = |y: f64| set.project(&Vec3::new(0.0, y, 0.6), None, 2.0).unwrap();
            let foot = at(0.1);
            assert!(
                matches!(
                    foot.location,
                    Location::Edge { .. } | Location::Crease { .. }
                ),
                "{:?}",
                foot.location
            );
            let step = 1e-5;
            let (a, b) = (at(0.1 - step), at(0.1 + step));
            let moved = b.jet.rho - a.jet.rho;
            let slope = set.normal_along(&foot, &(moved / moved.norm()));
            let reference = (b.normal - a.normal) / moved.norm();
            assert!(reference.norm() > 0.1, "{reference}");
            let error = (slope - reference).norm() / reference.norm();
            assert!(error < 1e-6, "{error:e}: {slope} {reference}");
        }
    }
}
