//! Patches that are parts of spheres: no point of them is nearer than the sphere is, which ends a search at once that
//! bounds over pieces would end late near poles and not before thousands of cuts near the centre.

use nalgebra::Matrix3;

use super::piece::row_of_pascal;
use super::set::Grid;
use crate::surface::{Surface, Vec3};

/// A sphere that holds all of a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sphere {
    centre: Vec3,
    radius: f64,
    /// Bound on how far the patch is off the sphere.
    slack: f64,
    /// The same for patches of the same sphere.
    pub number: u32,
}

/// Gives equal numbers to patches of the same sphere.
pub(super) fn number(spheres: &mut [Option<Sphere>]) {
    let mut seen: Vec<Sphere> = Vec::new();
    for sphere in spheres.iter_mut().flatten() {
        let known = seen.iter().position(|other| other.is_same(sphere));
        sphere.number = known.unwrap_or(seen.len()) as u32;
        if known.is_none() {
            seen.push(*sphere);
        }
    }
}

impl Sphere {
    /// The sphere that a patch lies on, within 1e-12 of `size`.
    pub fn of<S: Surface>(patch: &S, grid: &Grid, size: f64) -> Option<Self> {
        // Polynomials cannot.
        let varies = |degree: [usize; 2], net: &[[f64; 4]]| {
            degree.iter().all(|&d| d >= 2) && net.iter().any(|x| x[3] != net[0][3])
        };
        let mut nets = grid.places(0).map(|place| grid.net(patch, &place));
        let (degree, net) = nets.next()?;
        if !varies(degree, &net) {
            return None;
        }
        let domain = patch.domain();
        let point = |t: [f64; 2]| {
            patch.point([0, 1].map(|k| domain[k][0] + t[k] * (domain[k][1] - domain[k][0])))
        };
        // 2 (p_k - p_0) . c = |p_k|^2 - |p_0|^2, lengths about p_0.
        let origin = point([0.1, 0.15]);
        let others = [[0.85, 0.25], [0.35, 0.9], [0.6, 0.55]].map(|t| point(t) - origin);
        let rows = Matrix3::from_rows(&others.map(|p| p.transpose()));
        let squares = Vec3::from_iterator(others.iter().map(|p| 0.5 * p.norm_squared()));
        let from_origin = rows.lu().solve(&squares)?;
        let (centre, radius) = (origin + from_origin, from_origin.norm());
        let limit = 1e-12 * size;
        let near = |t: [f64; 2]| ((point(t) - centre).norm() - radius).abs() <= limit;
        if !(radius < 1e3 * size && [[0.2, 0.7], [0.95, 0.8], [0.5, 0.4]].into_iter().all(near)) {
            return None;
        }
        let mut slack = 1e-15 * (centre.norm() + radius);
        for (degree, net) in std::iter::once((degree, net)).chain(nets) {
            if !varies(degree, &net) {
                return None;
            }
            slack = off(&net, degree, &centre, radius).max(slack);
            if slack.is_nan() || slack > limit {
                return None;
            }
        }
        Some(Sphere {
            centre,
            radius,
            slack,
            number: 0,
        })
    }

    /// Whether another sphere is the same up to rounding.
    fn is_same(&self, other: &Sphere) -> bool {
        let off = (self.centre - other.centre).norm() + (self.radius - other.radius).abs();
        off <= 4.0 * (self.slack + other.slack) + 1e-12 * self.radius
    }

    /// Whether `q` lies within 1e-8 of the radius from the centre.
    #[inline]
    pub fn has_near_centre(&self, q: &Vec3) -> bool {
        (q - self.centre).norm_squared() <= 1e-16 * self.radius * self.radius
    }

    /// The point of the sphere in the direction of `q` from the centre, in any direction where `q` is the centre.
    pub fn beyond(&self, q: &Vec3) -> Vec3 {
        let direction = (q - self.centre).try_normalize(0.0);
        self.centre + direction.unwrap_or_else(Vec3::x) * self.radius
    }

    /// Lower bound of the distance between `q` and the patch.
    #[inline]
    pub fn distance(&self, q: &Vec3) -> f64 {
        ((q - self.centre).norm() - self.radius).abs() - self.slack
    }
}

/// Bound on `| |rho - centre| - radius |` over a piece: the largest Bernstein coefficient of
/// `|w (rho - centre)|^2 - radius^2 w^2` over the least weight squared bounds the difference of the squares.
fn off(net: &[[f64; 4]], degree: [usize; 2], centre: &Vec3, radius: f64) -> f64 {
    let [n1, n2] = degree.map(|p| p + 1);
    let binomials = degree.map(row_of_pascal);
    let double = degree.map(|p| row_of_pascal(2 * p));
    let moved = |k: usize| {
        let [x, y, z, w] = net[k];
        (Vec3::new(x, y, z) - centre * w, radius * w)
    };
    let least = net.iter().map(|p| p[3]).fold(f64::INFINITY, f64::min);
    let mut largest = 0.0f64;
    for l in 0..2 * n2 - 1 {
        for m in 0..2 * n1 - 1 {
            let mut sum = 0.0;
            for j in (l + 1).saturating_sub(n2)..=l.min(n2 - 1) {
                for i in (m + 1).saturating_sub(n1)..=m.min(n1 - 1) {
                    let (a, ra) = moved(i + n1 * j);
                    let (b, rb) = moved(m - i + n1 * (l - j));
                    let factor = binomials[0][i]
                        * binomials[0][m - i]
                        * binomials[1][j]
                        * binomials[1][l - j];
                    sum += factor * (a.dot(&b) - ra * rb);
                }
            }
            let coefficient = (sum / (double[0][m] * double[1][l])).abs();
            // NaN must not get lost.
            if coefficient > largest || coefficient.is_nan() {
                largest = coefficient;
            }
        }
    }
    // |s^2 - r^2| = |s - r| (s + r) >= |s - r| r.
    largest / (least * least * radius)
}

#[cfg(test)]
mod tests {
    use super::super::PatchSet;
    use crate::primitives::{cylinder, sphere, sphere_without_poles, torus};
    use crate::surface::Vec3;

    #[test]
    fn spheres_are_found_and_nothing_else() {
        let (centre, axis) = (Vec3::new(30.0, -20.0, 5.0), Vec3::new(0.2, 0.3, 0.9));
        let mut patches = sphere_without_poles(2.0, centre, axis).unwrap().to_vec();
        patches.push(sphere(2.0, centre, axis).unwrap());
        let set = PatchSet::new(patches, None).unwrap();
        let q = Vec3::new(31.0, -20.0, 5.0);
        for sphere in &set.spheres {
            let sphere = sphere.unwrap();
            assert!((sphere.distance(&q) - 1.0).abs() < 1e-12);
            assert!((sphere.centre - centre).norm() < 1e-12 && sphere.slack < 1e-12);
        }
        let others = vec![
            torus(3.0, 1.0, centre, axis).unwrap(),
            cylinder(1.0, 2.0, centre, axis).unwrap(),
        ];
        let set = PatchSet::new(others, None).unwrap();
        assert!(set.spheres.iter().all(Option::is_none));
    }
}
