//! Rigid motions that fit displacements, and those in which supports carry a body.
use super::Model;
use crate::scene::ValueError;
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion};
use std::collections::BTreeMap;

/// What a motion may leave of the displacements that supports prescribe, as a part of the largest: they are rigid.
const RIGID: f64 = 1e-9;
/// Weight of a motion that does not turn, relative to the points' own: it settles turns about a line that all of them lie on.
const STILL: f64 = 1e-13;

/// The rigid motion that leads from `points` nearest to `points + displacement` (Kabsch, Acta Cryst. A32, 1976).
pub fn nearest_motion(points: &[Vec3], displacement: &[Vec3]) -> Isometry3<f64> {
    let both = || points.iter().zip(displacement);
    let count = points.len().max(1) as f64;
    let from = points.iter().sum::<Vec3>() / count;
    let to = both().map(|(x, u)| x + u).sum::<Vec3>() / count;
    let mut covariance = Matrix3::zeros();
    for (x, u) in both() {
        covariance += (x + u - to) * (x - from).transpose();
    }
    covariance += Matrix3::identity() * (STILL * covariance.norm());
    let svd = covariance.svd(true, true);
    let rotation = match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) => {
            let mut flip = Matrix3::identity();
            flip[(2, 2)] = (u * v_t).determinant().signum();
            Rotation3::from_matrix_unchecked(u * flip * v_t)
        }
        _ => Rotation3::identity(),
    };
    let moved = to - rotation * from;
    Isometry3::from_parts(
        Translation3::from(moved),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

impl Model {
    /// The rigid motion in which supports carry a body from the displacements `u` to `time`: none where they do not move it, nothing where
    /// they do not move it rigidly.
    ///
    /// # Errors
    /// A prescribed value that cannot be evaluated.
    pub fn carried(
        &self,
        body: usize,
        u: &[f64],
        time: f64,
    ) -> Result<Option<Isometry3<f64>>, ValueError> {
        let body = &self.bodies[body];
        let first = body.first_node as usize;
        let own = first..first + body.mesh.nodes.len();
        let supports = || (self.supports()).filter(|s| own.contains(&(s.dofs[0] as usize / 3)));
        if !supports().any(|s| s.moves()) {
            return Ok(Some(Isometry3::identity()));
        }
        let mut ways = BTreeMap::<usize, ([bool; 3], Vec3)>::new();
        let mut moved = Vec::new();
        for support in supports() {
            let way = support.missing(u, time)?;
            for dof in support.dofs.map(|d| d as usize) {
                let (held, to) = ways.entry(dof / 3).or_default();
                (held[dof % 3], to[dof % 3]) = (true, way);
                if support.moves() {
                    moved.push(dof / 3);
                }
            }
        }
        moved.sort_unstable();
        moved.dedup();
        let position = |n: &usize| self.position(*n, u);
        let points: Vec<Vec3> = moved.iter().map(position).collect();
        let displacements: Vec<Vec3> = moved.iter().map(|n| ways[n].1).collect();
        let motion = nearest_motion(&points, &displacements);
        let largest = (ways.values()).fold(0.0f64, |a, (_, way)| a.max(way.amax()));
        let fits = ways.iter().all(|(n, (held, way))| {
            let x = position(n);
            let left = (motion * Point3::from(x)).coords - x - way;
            (0..3).all(|c| !held[c] || left[c].abs() <= RIGID * largest)
        });
        Ok(fits.then_some(motion))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(moved: &Isometry3<f64>, points: &[Vec3]) -> Isometry3<f64> {
        let way = |x: &Vec3| (moved * Point3::from(*x)).coords - x;
        nearest_motion(points, &points.iter().map(way).collect::<Vec<_>>())
    }

    #[test]
    fn a_motion_is_found_again() {
        let moved = Isometry3::new(Vec3::new(3.0, -1.0, 2.0), Vec3::new(0.3, 2.5, -0.4));
        let points: Vec<Vec3> = (0..25)
            .map(|i| Vec3::new(f64::from(i % 5), f64::from(i / 5), 0.0) * 0.25)
            .collect();
        let found = back(&moved, &points);
        for x in &points {
            let x = Point3::from(*x);
            assert!((found * x - moved * x).norm() < 1e-11);
        }
    }

    /// Nothing says how what lies along a line turns about it.
    #[test]
    fn what_lies_along_a_line_does_not_turn_about_it() {
        let points: Vec<Vec3> = (0..5).map(|i| Vec3::new(f64::from(i), 2.0, 0.0)).collect();
        let moved = Isometry3::new(Vec3::new(3.0, -1.0, 2.0), Vec3::new(0.0, 0.0, 0.7));
        let found = back(&moved, &points);
        assert!(found.rotation.angle_to(&moved.rotation) < 1e-6);
        let one = back(&moved, &points[..1]);
        assert!(one.rotation.angle() < 1e-12);
    }
}
