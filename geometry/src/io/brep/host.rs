//! The surface under a face: its points at the file's parameters, and the parameters of points on it.

use super::grant::{FOOT, Grant};
use super::metered::{Metered, NoSet, set_of};
use super::reparametrise::Reparametrise;
use crate::basis::MAX_DEGREE;
use crate::project::Joining;
use crate::{NurbsCurve, NurbsPatch, PatchSet, Vec3};
use nalgebra::Vector2;
use std::cell::OnceCell;

/// A point of the parameter plane.
pub type Xi = Vector2<f64>;

/// The surface that carries a face. Parameters may lie outside of the domain where the surface is closed: they then mean
/// the point a whole number of periods away.
pub struct Host<'a> {
    pub patch: &'a NurbsPatch,
    /// From the file's parameters to those of the patch.
    parameters: &'a Reparametrise,
    /// Directions in which the surface ends where it begins.
    pub closed: [bool; 2],
    pub domain: [[f64; 2]; 2],
    /// Diagonal of the box around the patch.
    pub size: f64,
    /// Distance at which points count as the same.
    pub agree: f64,
    /// Gaps between boundary curves up to this are closed, and told.
    pub bridged: f64,
    /// A parallelogram: its origin, and the rows that take `x - origin` to shares of the domain.
    flat: Option<(Vec3, [Vec3; 2])>,
    set: OnceCell<Result<Option<PatchSet<Metered<'a>>>, String>>,
    pub grant: &'a Grant,
}

impl<'a> Host<'a> {
    pub fn new(
        patch: &'a NurbsPatch,
        parameters: &'a Reparametrise,
        resolution: f64,
        grant: &'a Grant,
    ) -> Self {
        let [low, high] = patch.bounds();
        let size = (high - low).norm();
        let agree = (1e-5 * size).max(10.0 * resolution).min(1e-3 * size);
        let domain = patch.domain();
        Self {
            patch,
            parameters,
            closed: [0, 1].map(|d| is_closed(patch, d, 1e-7 * size)),
            domain,
            size,
            agree,
            bridged: 0.0,
            flat: flat(patch, size),
            set: OnceCell::new(),
            grant,
        }
    }

    /// The same where gaps between boundary curves up to `length` are closed, within a hundredth of the surface.
    pub fn bridging(self, length: f64) -> Self {
        let bridged = length.min(1e-2 * self.size);
        Self { bridged, ..self }
    }

    /// Cost of an evaluation of the surface.
    pub fn evaluation(&self) -> u64 {
        Grant::evaluation(self.patch.degree())
    }

    /// Length of the domain in a direction, the period where the surface is closed.
    pub fn extent(&self, dir: usize) -> f64 {
        self.domain[dir][1] - self.domain[dir][0]
    }

    /// The parameters in the domain that mean the same point.
    pub fn wrap(&self, xi: Xi) -> [f64; 2] {
        [0, 1].map(|d| {
            let [a, b] = self.domain[d];
            if self.closed[d] && !(a..=b).contains(&xi[d]) {
                a + (xi[d] - a).rem_euclid(b - a)
            } else {
                xi[d]
            }
        })
    }

    /// The surface's point; beyond the border of a surface that is not closed, that of the border.
    pub fn point(&self, xi: Xi) -> Vec3 {
        let x = self.wrap(xi);
        let inside = [0, 1].map(|d| x[d].clamp(self.domain[d][0], self.domain[d][1]));
        self.patch.point(inside)
    }

    /// How far parameters lie outside of the domain of a surface that is not closed there, as a share of it.
    pub fn beyond(&self, xi: Xi) -> f64 {
        (0..2)
            .filter(|&d| !self.closed[d])
            .map(|d| {
                let [a, b] = self.domain[d];
                (a - xi[d]).max(xi[d] - b) / (b - a)
            })
            .fold(0.0, f64::max)
    }

    /// Moves the patch's parameters `xi` by whole periods as near to `near` as they get.
    pub fn nearest_copy(&self, xi: Xi, near: Xi) -> Xi {
        let mut out = xi;
        for d in 0..2 {
            if self.closed[d] {
                out[d] += self.extent(d) * ((near[d] - xi[d]) / self.extent(d)).round();
            }
        }
        out
    }

    /// Whole turns to be added to file parameters that span a box, where the file means another turn than the surface.
    /// (On a closed surface all turns are one.)
    pub fn turns(&self, bounds: [[f64; 2]; 2]) -> Xi {
        let turns = self.parameters.turns(bounds);
        Xi::from_fn(|d, _| if self.closed[d] { 0.0 } else { turns[d] })
    }

    /// The patch's parameters at those of the file.
    pub fn of_file(&self, file: Xi) -> Xi {
        Xi::from_fn(|d, _| {
            let map = &self.parameters.directions[d];
            let [a, b] = map.file_range();
            let turns = match self.closed[d] && !(a..=b).contains(&file[d]) {
                true => ((file[d] - a) / (b - a)).floor(),
                false => 0.0,
            };
            let [own_a, own_b] = map.own_range();
            map.to_own(file[d] - turns * (b - a)) + turns * (own_b - own_a)
        })
    }

    /// A curve of the file's parameter plane, moved by `shift`, in that of the patch, if that is possible without loss.
    pub fn exact(&self, file: &NurbsCurve<2>, shift: Xi) -> Option<NurbsCurve<2>> {
        if self.parameters.is_identity() {
            return Some(file.clone());
        }
        let [u, v] = [0, 1].map(|d| self.parameters.directions[d].as_affine());
        let (u, v) = (u?, v?);
        file.transformed(&|x| {
            let x = x + shift;
            Xi::new(u[0] * x.x + u[1], v[0] * x.y + v[1])
        })
        .ok()
    }

    /// A space curve projected onto a plane without loss.
    pub fn exact_projection(&self, space: &NurbsCurve<3>) -> Option<NurbsCurve<2>> {
        let (origin, rows) = self.flat?;
        let points = space.homogeneous().iter().map(|p| {
            let x = Vec3::new(p[0], p[1], p[2]) - origin * p[3];
            let at = |d: usize| self.domain[d][0] * p[3] + self.extent(d) * rows[d].dot(&x);
            [at(0), at(1), 0.0, p[3]]
        });
        NurbsCurve::from_homogeneous(space.basis().clone(), points.collect()).ok()
    }

    /// The foot of `q` on the surface, as near to the parameters `near` as periods allow, and its distance.
    pub fn foot(&self, q: &Vec3, near: Xi) -> Result<(Xi, f64), String> {
        self.grant.work(FOOT * self.evaluation())?;
        let set = self.set.get_or_init(|| self.set());
        let set = set.as_ref().map_err(String::clone)?;
        let hint = crate::Hint {
            patch: 0,
            xi: self.wrap(near),
        };
        let foot = (set.as_ref()).and_then(|set| set.project(q, Some(hint), f64::INFINITY));
        // A search that ran out of work has proved nothing.
        self.grant.work(1)?;
        let foot = foot.ok_or("the surface has no closest points to project its border to")?;
        let xi = self.nearest_copy(Xi::from(foot.xi), near);
        Ok((xi, foot.distance))
    }

    /// A set of the surface alone; `None` where nothing can be projected onto it.
    fn set(&self) -> Result<Option<PatchSet<Metered<'a>>>, String> {
        // A surface of which the coordinates hold hardly a digit is all one place: everything is nearest.
        let [low, high] = self.patch.bounds();
        if self.size <= 1e-10 * low.amax().max(high.amax()) {
            return Ok(None);
        }
        let patch = Metered::untrimmed(self.patch, self.grant);
        // A face may have two hosts at a time: its boundary is read again where its curves do not meet.
        let wanted = patch.bytes_for_projections();
        let made = match wanted.saturating_mul(2) > self.grant.passing_bytes() {
            true => Err(NoSet::Memory),
            false => set_of(vec![patch], Joining::default(), (self.grant, wanted)),
        };
        match made {
            Ok(set) => Ok(Some(set)),
            Err(NoSet::Patches(_)) => Ok(None),
            Err(reason) => Err(format!(
                "its border would have to be projected onto the surface, and {reason}"
            )),
        }
    }

    /// Whether the surface has no border: it is closed in both directions, or in one between two poles.
    pub fn is_round(&self) -> bool {
        let pole = |dir: usize, end: usize| {
            (0..4).all(|k| {
                let mut xi = Xi::zeros();
                xi[dir] = self.domain[dir][end];
                xi[1 - dir] = self.domain[1 - dir][0] + self.extent(1 - dir) * (f64::from(k) / 4.0);
                self.stuck(xi)[1 - dir]
            })
        };
        let ends = |dir: usize| self.closed[dir] || (pole(dir, 0) && pole(dir, 1));
        (self.closed[0] || self.closed[1]) && ends(0) && ends(1)
    }

    /// Directions in which the parameter does not move the point at `xi` (at a pole).
    pub fn stuck(&self, xi: Xi) -> [bool; 2] {
        let jet = self.patch.jet(self.wrap(xi));
        [0, 1].map(|d| jet.rho_i[d].norm() * self.extent(d) < 1e-6 * self.size)
    }
}

fn is_closed(patch: &NurbsPatch, dir: usize, slack: f64) -> bool {
    let domain = patch.domain();
    let [from, to] = domain[1 - dir];
    // More samples than a patch of one span needs to agree by chance.
    let n = 2 * MAX_DEGREE;
    let apart = |k: usize| {
        let across = from + (to - from) * (k as f64 / n as f64);
        let at = |along: f64| match dir {
            0 => patch.point([along, across]),
            _ => patch.point([across, along]),
        };
        let ([a, b], middle) = (domain[dir], 0.5 * (domain[dir][0] + domain[dir][1]));
        ((at(a) - at(b)).norm(), (at(a) - at(middle)).norm())
    };
    let found: Vec<_> = (0..=n).map(apart).collect();
    found.iter().all(|f| f.0 <= slack) && found.iter().any(|f| f.1 > slack)
}

fn flat(patch: &NurbsPatch, size: f64) -> Option<(Vec3, [Vec3; 2])> {
    if patch.degree() != [1, 1] || patch.counts() != [2, 2] || patch.is_rational() {
        return None;
    }
    let [[a, b], [c, d]] = patch.domain();
    let at = |u, v| patch.point([u, v]);
    let (origin, e1, e2) = (at(a, c), at(b, c) - at(a, c), at(a, d) - at(a, c));
    if (at(b, d) - origin - e1 - e2).norm() > 1e-12 * size {
        return None;
    }
    let (g11, g12, g22) = (e1.dot(&e1), e1.dot(&e2), e2.dot(&e2));
    let det = g11 * g22 - g12 * g12;
    if det <= 1e-12 * g11 * g22 {
        return None;
    }
    let rows = [(e1 * g22 - e2 * g12) / det, (e2 * g11 - e1 * g12) / det];
    Some((origin, rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::brep::BasePatch;

    /// A wave of 60 x 60 control points, which a short file may hold in few bytes, has no place for projections in the memory
    /// of that file, and has one in that of a long file.
    #[test]
    fn surfaces_too_large_for_their_file() {
        let n = 60;
        let points = (0..n * n).map(|k| {
            let [x, y] = [k % n, k / n].map(|i| i as f64);
            Vec3::new(x, y, x.sin() * y.cos())
        });
        let points: Vec<Vec3> = points.collect();
        let knots: Vec<f64> = (0..n + 4).map(|i| i.clamp(3, n) as f64).collect();
        let patch = NurbsPatch::new([3, 3], [knots.clone(), knots], [n, n], &points, None);
        let base = BasePatch::exact(patch.unwrap());
        let foot = |lines: usize| {
            let grant = Grant::of_lines(lines, lines);
            let host = Host::new(&base.patch, &base.parameters, 1e-6, &grant);
            host.foot(
                &Vec3::new(20.0, 30.0, 0.5),
                host.domain.map(|[a, _]| a).into(),
            )
        };
        let refused = foot(10).unwrap_err();
        assert!(refused.contains("more memory than a file"), "{refused}");
        let (_, distance) = foot(2_000).unwrap();
        assert!(distance < 1.0, "{distance}");
    }
}
