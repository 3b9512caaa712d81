//! The foot on one facet that is extended past its border.
use super::local::Problem;
use super::place::unit_normal;
use super::{MovingFacets, MovingFoot, MovingPlace};
use crate::project::{Hint, Status};
use crate::surface::Vec3;

impl MovingFacets {
    /// The closest point to `q` of the facet that `on` names, its polynomial continued past each border by `beyond` of
    /// its width. `None` where the distance still falls at the ends of that, where the facet has no normal, and
    /// where `q` lies beyond its centres of curvature.
    ///
    /// Where the surface is smooth over all facets it has no folds, and nothing is continued.
    ///
    /// An iteration that moves a point to and fro across the fold between two nearly flat facets takes this for the foot of a
    /// point that was on the facet before.
    pub fn project_on(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<MovingFoot> {
        if on.patch as usize >= self.len()
            || self.tree.is_none()
            || !self.is_finite(on.patch)
            || !(q.iter().all(|x| x.is_finite()) && on.xi.iter().all(|x| x.is_finite()))
        {
            return None;
        }
        match self.degree {
            1 => self.project_on_as::<2>(q, on, beyond),
            2 => self.project_on_as::<3>(q, on, beyond),
            // Bicubic facets join smoothly.
            _ => None,
        }
    }

    fn project_on_as<const M: usize>(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<MovingFoot> {
        let problem = Problem {
            net: self.net::<M>(on.patch),
            q,
            range: [[-1.0 - 2.0 * beyond, 1.0 + 2.0 * beyond]; 2],
            size: self.size,
            rational: self.rational,
        };
        let mut local = problem.solve::<M>(on.xi);
        problem.refine::<M>(&mut local);
        if !local.converged || local.active != [false; 2] || local.focal() {
            return None;
        }
        let normal = unit_normal(&local.jet)?;
        Some(MovingFoot {
            facet: on.patch,
            xi: local.xi,
            jet: local.jet,
            normal,
            signed_distance: local.d.dot(&normal),
            distance: local.d2.sqrt(),
            place: MovingPlace::Face,
            status: Status::Unique,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_facet_is_continued_as_far_as_asked_for() {
        let facets: [(&[u32], [u8; 2]); 1] = [(&[0, 1, 2, 3], [2, 2])];
        let mut set = MovingFacets::new(&facets).unwrap();
        let on = Hint {
            patch: 0,
            xi: [0.9, 0.1],
        };
        let q = Vec3::new(2.02, 0.6, -0.3);
        assert!(
            set.project_on(&q, on, 0.02).is_none(),
            "before the first update"
        );
        // A saddle, of which the continuation is the same polynomial.
        let height = |x: f64, y: f64| 0.1 * (x - 1.0) * (y - 0.5);
        set.update(|k| {
            let (x, y) = (2.0 * f64::from(k % 2), f64::from(k / 2));
            Vec3::new(x, y, height(x, y))
        });
        let foot = set.project_on(&q, on, 0.02).unwrap();
        assert!(foot.xi[0] > 1.0 && foot.xi[1].abs() < 1.0);
        let rho = foot.jet.rho;
        assert!((rho.z - height(rho.x, rho.y)).abs() < 1e-15);
        let d = q - rho;
        assert!(foot.jet.rho_i.iter().all(|r| d.dot(r).abs() < 1e-13));
        assert!((foot.signed_distance + d.norm()).abs() < 1e-14);
        assert!(
            set.project_on(&Vec3::new(2.2, 0.6, -0.3), on, 0.02)
                .is_none()
        );
    }
}
