//! Where a straight line meets a set of patches.
//!
//! Every Bezier piece whose box the line passes through is seen along the line: its control points are projected onto two
//! directions across it, and the piece is cut until it is nearly affine there or no longer covers the line. An affine part has
//! one intersection at most, which Newton's method finds. (T. Nishita, T. W. Sederberg and M. Kakimoto, "Ray tracing trimmed
//! rational surface patches", SIGGRAPH 1990, look along the ray in the same way.)

use super::PatchSet;
use super::piece::{Piece, hull, split};
use crate::surface::{Surface, Vec3};

/// Intersections nearer to each other than this share of the size are one.
const SAME: f64 = 1e-9;
/// Parts of a piece that deviate from an affine map by less than this share of their extent have one intersection at most.
const AFFINE: f64 = 0.05;
/// Most parts of one piece. More are needed only where the line runs within the surface.
const MOST: usize = 4096;
const ITERATIONS: usize = 20;

/// Where a line passes through the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Hit {
    /// Number of the patch.
    pub patch: u32,
    /// Parameters on it.
    pub xi: [f64; 2],
    /// Distance from the origin of the ray.
    pub distance: f64,
    /// The point.
    pub point: Vec3,
    /// Unit normal on the outer side of the set (that of the parameters where the component has one side only); zero where the
    /// tangents span no plane.
    pub normal: Vec3,
    /// The ray touches the surface, or passes through it at so small an angle that rounding decides.
    pub grazing: bool,
}

/// Why a ray has no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// A coordinate is infinite or not a number, the direction is zero, or the reach is not a number.
    #[error("the origin, direction or reach of the ray is not finite, or its direction is zero")]
    NotFinite,
    /// The ray runs within a patch along a line, so that it has no first point there.
    #[error("the ray runs within patch {0}")]
    Along(u32),
}

impl<S: Surface> PatchSet<S> {
    /// The first point in which the ray from `origin` along `direction` (of any length) meets the set, within the distance
    /// `reach`. Trimmed parts do not count.
    ///
    /// # Errors
    /// [`RayError`].
    ///
    /// ```
    /// use covact_geometry::{Bilinear, PatchSet, Vec3};
    /// let corners = [[0., 0., 1.], [2., 0., 1.], [0., 2., 1.], [2., 2., 1.]].map(Vec3::from);
    /// let set = PatchSet::new(vec![Bilinear::new(corners)?], None)?;
    /// let up = Vec3::new(0.0, 0.0, 2.0);
    /// let hit = set.first_hit(&Vec3::new(1.0, 0.5, 0.0), &up, 10.0)?.expect("the plate is above");
    /// assert!((hit.distance - 1.0).abs() < 1e-12 && (hit.point.z - 1.0).abs() < 1e-12);
    /// assert!(set.first_hit(&Vec3::new(5.0, 0.5, 0.0), &up, 10.0)?.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first_hit(
        &self,
        origin: &Vec3,
        direction: &Vec3,
        reach: f64,
    ) -> Result<Option<Hit>, RayError> {
        let mut ray = Ray::new(self, origin, direction, reach)?;
        ray.first = true;
        Ok(ray.run()?.into_iter().next())
    }

    /// All points in which the ray from `origin` along `direction` (of any length) meets the set within the distance
    /// `reach`, by distance. A point on an edge that patches share is given once.
    ///
    /// # Errors
    /// [`RayError`].
    pub fn hits(&self, origin: &Vec3, direction: &Vec3, reach: f64) -> Result<Vec<Hit>, RayError> {
        Ray::new(self, origin, direction, reach)?.run()
    }
}

struct Ray<'a, S: Surface> {
    set: &'a PatchSet<S>,
    origin: Vec3,
    /// Two directions across the ray, and its own, all of unit length.
    axes: [Vec3; 3],
    reach: f64,
    /// Only the first intersection is asked for.
    first: bool,
    /// Distances that do not count: rounding, and gaps at joints.
    slack: f64,
    hits: Vec<Hit>,
}

/// A part of a piece: its control points across and along the ray, times their weights.
struct Part {
    net: Vec<[f64; 4]>,
    domain: [[f64; 2]; 2],
}

impl<'a, S: Surface> Ray<'a, S> {
    fn new(
        set: &'a PatchSet<S>,
        origin: &Vec3,
        direction: &Vec3,
        reach: f64,
    ) -> Result<Self, RayError> {
        let along = direction / direction.amax();
        let along = along / along.norm();
        if reach.is_nan() || !origin.iter().chain(&along).all(|x| x.is_finite()) {
            return Err(RayError::NotFinite);
        }
        let least = along.iamin();
        let mut other = Vec3::zeros();
        other[least] = 1.0;
        let across = along.cross(&other).normalize();
        Ok(Self {
            set,
            origin: *origin,
            axes: [across, along.cross(&across), along],
            reach,
            first: false,
            slack: set.edges().largest_gap.max(SAME * set.size),
            hits: Vec::new(),
        })
    }

    fn run(mut self) -> Result<Vec<Hit>, RayError> {
        let (set, mut fault) = (self.set, None);
        let limit = |reach: f64| match reach.is_finite() {
            true => reach * reach * (1.0 + 1e-12),
            false => f64::MAX,
        };
        let (origin, axes, slack) = (self.origin, self.axes, self.slack);
        // The square of the distance at which the ray enters a box.
        let enters = |low: &Vec3, high: &Vec3| {
            let (mut from, mut to) = (0.0f64, f64::INFINITY);
            for k in 0..3 {
                let (a, b) = (low[k] - slack - origin[k], high[k] + slack - origin[k]);
                if axes[2][k] == 0.0 {
                    if a > 0.0 || b < 0.0 {
                        return f64::INFINITY;
                    }
                    continue;
                }
                let (s, t) = (a / axes[2][k], b / axes[2][k]);
                from = from.max(s.min(t));
                to = to.min(s.max(t));
            }
            if from <= to && low.x <= high.x {
                from * from
            } else {
                f64::INFINITY
            }
        };
        let tree = &set.tree;
        tree.scan(enters, limit(self.reach), |leaf| {
            if (leaf as usize) < set.pieces.count()
                && fault.is_none()
                && let Err(error) = self.piece(set.piece(leaf))
            {
                fault = Some(error);
            }
            let nearest = self
                .hits
                .iter()
                .map(|h| h.distance)
                .fold(self.reach, f64::min);
            limit(if self.first { nearest } else { self.reach })
        });
        if let Some(error) = fault {
            return Err(error);
        }
        self.hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut out: Vec<Hit> = Vec::with_capacity(self.hits.len());
        for hit in self.hits {
            let along = |h: &Hit| axes[2].dot(&h.normal);
            let near = |h: &Hit| (h.point - hit.point).norm() <= 4.0 * slack;
            let alike =
                |h: &Hit| h.grazing || hit.grazing || (along(h) > 0.0) == (along(&hit) > 0.0);
            match out
                .iter_mut()
                .rev()
                .take_while(|h| near(h))
                .find(|h| alike(h))
            {
                Some(same) => same.grazing &= hit.grazing,
                None => out.push(hit),
            }
        }
        Ok(out)
    }

    /// Adds the intersections with one piece.
    fn piece(&mut self, piece: &Piece) -> Result<(), RayError> {
        let degree = piece.degree;
        let seen = piece.net().iter().map(|&[x, y, z, w]| {
            let d = Vec3::new(x, y, z) - self.origin * w;
            [
                self.axes[0].dot(&d),
                self.axes[1].dot(&d),
                self.axes[2].dot(&d),
                w,
            ]
        });
        let mut parts = vec![Part {
            net: seen.collect(),
            domain: piece.domain,
        }];
        let mut count = 0;
        while let Some(mut part) = parts.pop() {
            let [low, high] = hull(&part.net);
            let misses = |k: usize| low[k] > self.slack || high[k] < -self.slack;
            if misses(0) || misses(1) || high.z < -self.slack || low.z > self.reach + self.slack {
                continue;
            }
            count += 1;
            if count > MOST {
                return Err(RayError::Along(piece.patch));
            }
            if (high - low).norm() <= SAME * self.set.size {
                let middle = part.domain.map(|[a, b]| 0.5 * (a + b));
                self.take(piece, middle, true);
                continue;
            }
            let affine = Affine::of(&part.net, degree);
            if let Some(inverse) = affine.inverse()
                && affine.deviation * inverse.norm() < AFFINE
            {
                // Where the affine map meets the ray; the part itself does so nearby or not at all.
                let at = nalgebra::Vector2::repeat(0.5) - inverse * affine.middle;
                let room = 2.0 * AFFINE + self.slack * inverse.norm();
                if at.iter().all(|&s| (-room..=1.0 + room).contains(&s))
                    && let Some((xi, grazing)) = self.refine(piece, &part, at)
                {
                    self.take(piece, xi, grazing);
                }
                continue;
            }
            let longer = usize::from(affine.sides[1] > affine.sides[0]);
            let mut right = part.net.clone();
            split(&mut part.net, &mut right, degree, longer, 0.5);
            let [a, b] = part.domain[longer];
            let mut domains = [part.domain; 2];
            domains[0][longer][1] = 0.5 * (a + b);
            domains[1][longer][0] = 0.5 * (a + b);
            parts.push(Part {
                net: right,
                domain: domains[1],
            });
            parts.push(Part {
                net: part.net,
                domain: domains[0],
            });
        }
        Ok(())
    }

    /// The intersection with a nearly affine part by Newton's method, or none where it lies outside of the part.
    fn refine(
        &self,
        piece: &Piece,
        part: &Part,
        start: nalgebra::Vector2<f64>,
    ) -> Option<([f64; 2], bool)> {
        let surface = &self.set.patches[piece.patch as usize];
        let [u, v] = part.domain;
        let extent = [u[1] - u[0], v[1] - v[0]];
        let mut xi = [u[0] + extent[0] * start.x, v[0] + extent[1] * start.y];
        for (x, [a, b]) in xi.iter_mut().zip(part.domain) {
            *x = x.clamp(a, b);
        }
        let mut grazing = false;
        for _ in 0..ITERATIONS {
            let jet = surface.jet_in_span(piece.span, xi);
            let d = jet.rho - self.origin;
            let seen = |v: &Vec3| nalgebra::Vector2::new(self.axes[0].dot(v), self.axes[1].dot(v));
            let slope =
                nalgebra::Matrix2::from_columns(&[seen(&jet.rho_i[0]), seen(&jet.rho_i[1])]);
            let area = jet.rho_i[0].cross(&jet.rho_i[1]).norm();
            grazing = slope.determinant().abs() <= 1e-6 * area;
            let step = slope.try_inverse()? * seen(&d);
            xi = [xi[0] - step.x, xi[1] - step.y];
            let small = (0..2).all(|k| step[k].abs() <= 1e-13 * extent[k].max(xi[k].abs()));
            if small {
                break;
            }
        }
        // Beyond the part another one has it, but for gaps at borders.
        let jet = surface.jet_in_span(piece.span, xi);
        for (d, x) in xi.iter_mut().enumerate() {
            let [a, b] = part.domain[d];
            let room = 1e-9 * (b - a) + self.slack / jet.rho_i[d].norm();
            if !(a - room..=b + room).contains(x) {
                return None;
            }
            *x = x.clamp(piece.domain[d][0], piece.domain[d][1]);
        }
        Some((xi, grazing))
    }

    /// Takes an intersection that the trim leaves.
    fn take(&mut self, piece: &Piece, xi: [f64; 2], grazing: bool) {
        let surface = &self.set.patches[piece.patch as usize];
        let jet = surface.jet_in_span(piece.span, xi);
        if let Some(trim) = surface.trim()
            && !trim.contains(xi)
        {
            let lengths = jet.rho_i.map(|t| t.norm().max(f64::MIN_POSITIVE));
            let near = trim.nearest_border(xi, lengths.map(f64::recip), self.slack);
            if near.is_none() {
                return;
            }
        }
        let distance = self.axes[2].dot(&(jet.rho - self.origin));
        if !(-self.slack..=self.reach + self.slack).contains(&distance) {
            return;
        }
        let side = self.set.sides[piece.patch as usize];
        let normal = jet.rho_i[0].cross(&jet.rho_i[1]) * if side < 0.0 { -1.0 } else { 1.0 };
        self.hits.push(Hit {
            patch: piece.patch,
            xi,
            distance: distance.max(0.0),
            point: jet.rho,
            normal: normal.try_normalize(0.0).unwrap_or_default(),
            grazing,
        });
    }
}

/// A control net seen along the ray as an affine map of the unit square.
struct Affine {
    middle: nalgebra::Vector2<f64>,
    slope: nalgebra::Matrix2<f64>,
    /// Largest distance of a control point from where the map has it.
    deviation: f64,
    /// Lengths of the net in space along both directions.
    sides: [f64; 2],
}

impl Affine {
    fn of(net: &[[f64; 4]], degree: [usize; 2]) -> Self {
        let [n1, n2] = degree.map(|p| p + 1);
        let point = |i: usize, j: usize| {
            let [x, y, _, w] = net[i + n1 * j];
            nalgebra::Vector2::new(x / w, y / w)
        };
        let [a, b, c, d] = [
            point(0, 0),
            point(n1 - 1, 0),
            point(0, n2 - 1),
            point(n1 - 1, n2 - 1),
        ];
        let slope =
            nalgebra::Matrix2::from_columns(&[(b - a + d - c) / 2.0, (c - a + d - b) / 2.0]);
        let middle = (a + b + c + d) / 4.0;
        let mut deviation = 0.0f64;
        for j in 0..n2 {
            for i in 0..n1 {
                let at = nalgebra::Vector2::new(
                    i as f64 / degree[0].max(1) as f64 - 0.5,
                    j as f64 / degree[1].max(1) as f64 - 0.5,
                );
                deviation = deviation.max((point(i, j) - middle - slope * at).norm());
            }
        }
        let space = |i: usize, j: usize| {
            let [x, y, z, w] = net[i + n1 * j];
            Vec3::new(x, y, z) / w
        };
        let along = |count: usize, lines: usize, at: &dyn Fn(usize, usize) -> Vec3| {
            let line = |l: usize| (1..count).map(move |k| (at(k, l) - at(k - 1, l)).norm());
            (0..lines).map(|l| line(l).sum::<f64>()).fold(0.0, f64::max)
        };
        let sides = [
            along(n1, n2, &|k, l| space(k, l)),
            along(n2, n1, &|k, l| space(l, k)),
        ];
        Self {
            middle,
            slope,
            deviation,
            sides,
        }
    }

    fn inverse(&self) -> Option<nalgebra::Matrix2<f64>> {
        let inverse = self.slope.try_inverse()?;
        inverse.iter().all(|x| x.is_finite()).then_some(inverse)
    }
}
