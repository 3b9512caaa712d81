//! The foot on one patch that is extended past its borders and creases.
use super::local::Local;
use super::set::PatchSet;
use super::{Foot, Hint, Location, Status};
use crate::surface::{Surface, Vec3};

/// Sine of the angle between normals below which patches have a common tangent plane.
const FLUSH: f64 = 1e-6;

impl<S: Surface> PatchSet<S> {
    /// The closest point to `q` of the patch that `on` names (of the part of it between creases), continued past each end by
    /// `beyond` of its width. `None` where another patch continues it smoothly, on a trimmed patch or one without an inside, where the distance still falls at the ends,
    /// where the patch has no normal, and where `q` lies beyond its centres of curvature.
    ///
    /// An iteration that moves a point to and fro across the fold between two nearly flat patches takes this for the foot of a
    /// point that was on the patch before.
    pub fn project_on(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<Foot> {
        let patch = self.patches().get(on.patch as usize)?;
        let finite = q.iter().chain(&on.xi).all(|x| x.is_finite());
        let side = self.sides()[on.patch as usize];
        if !finite || side == 0.0 || patch.trim().is_some() {
            return None;
        }
        let span = patch.find_span(on.xi);
        let inside = self.region(on.patch, span);
        let mut region = inside;
        for domain in &mut region.domain {
            let more = beyond * (domain[1] - domain[0]);
            *domain = [domain[0] - more, domain[1] + more];
        }
        let mut local = self.state(q, &region, on.xi, span);
        self.polish_face(q, &mut local);
        if !local.converged || local.active != [false; 2] || self.near_pole(&local).is_some() {
            return None;
        }
        if self.runs_on(&self.state(q, &inside, local.xi, span)) {
            return None;
        }
        let foot = Foot {
            patch: on.patch,
            xi: local.xi,
            location: Location::Face,
            status: Status::Unique,
            jet: local.jet,
            side,
            distance: local.d2.sqrt(),
            signed_distance: 0.0,
            normal: self.face_normal(&local) * side,
        };
        let [a, b, c] = local.hessian;
        (a > 0.0 && a * c > b * b).then(|| Foot {
            signed_distance: (q - foot.jet.rho).dot(&foot.normal),
            ..foot
        })
    }

    /// Whether other patches go on smoothly from a point of the border, so that none of its own continuation is wanted.
    fn runs_on(&self, s: &Local) -> bool {
        let n = self.face_normal(s);
        let mut joined = false;
        for (edge, t) in self.edges_under(s).into_iter().flatten() {
            for (link, at) in self.behind(edge, t, &s.jet.rho) {
                let patch = self.topology.edges[link.edge].patch;
                let m = self.normal_near(patch, at.span, at.xi) * link.relation;
                if m.cross(&n).norm() > FLUSH || m.dot(&n) <= 0.0 {
                    return false;
                }
                joined = true;
            }
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facet::Bilinear;
    use crate::project::Location;

    /// Two unit squares side by side, the second of which rises by `slope`.
    fn fold(slope: f64) -> PatchSet<Bilinear> {
        let p = Vec3::new;
        let flat = [
            p(0.0, 0.0, 0.0),
            p(1.0, 0.0, 0.0),
            p(0.0, 1.0, 0.0),
            p(1.0, 1.0, 0.0),
        ];
        let rises = [
            p(1.0, 0.0, 0.0),
            p(2.0, 0.0, slope),
            p(1.0, 1.0, 0.0),
            p(2.0, 1.0, slope),
        ];
        let patches = [flat, rises].map(|nodes| Bilinear::new(nodes).unwrap());
        PatchSet::new(patches.to_vec(), None).unwrap()
    }

    #[test]
    fn a_patch_is_continued_past_a_fold_and_past_a_free_border() {
        let set = fold(0.1);
        let inside = set.project(&Vec3::new(0.99, 0.4, -0.2), None, 1.0).unwrap();
        assert_eq!(inside.patch, 0);
        let width = set.patches()[0].domain()[0];
        let beyond = 0.02 * (width[1] - width[0]);
        let along = [Vec3::new(1.01, 0.4, -0.2), Vec3::new(0.5, -0.01, -0.2)];
        for q in along {
            let foot = set.project_on(&q, inside.hint(), 0.02).unwrap();
            assert_eq!((foot.patch, foot.location), (0, Location::Face));
            assert!((foot.signed_distance + 0.2).abs() < 1e-15);
            assert!((foot.jet.rho - Vec3::new(q.x, q.y, 0.0)).norm() < 1e-14);
            let out = |k: usize| foot.xi[k] - width[usize::from(foot.xi[k] > 0.0)];
            assert!(
                (out(0).abs() - 0.5 * beyond).abs() < 1e-12
                    || (out(1).abs() - 0.5 * beyond).abs() < 1e-12
            );
        }
        // Farther than it goes, and where there is no such patch.
        assert!(
            set.project_on(&Vec3::new(1.03, 0.4, -0.2), inside.hint(), 0.02)
                .is_none()
        );
        let nowhere = Hint {
            patch: 2,
            xi: [0.0; 2],
        };
        assert!(set.project_on(&along[0], nowhere, 0.02).is_none());
    }

    #[test]
    fn nothing_is_continued_where_the_surface_runs_on() {
        let q = Vec3::new(1.01, 0.4, -0.2);
        for (slope, continued) in [(0.0, false), (1e-4, true)] {
            let set = fold(slope);
            let inside = set.project(&Vec3::new(0.9, 0.4, -0.2), None, 1.0).unwrap();
            assert_eq!(set.project_on(&q, inside.hint(), 0.02).is_some(), continued);
        }
    }
}
