//! The distance between two sets of patches.
//!
//! Pairs of Bezier pieces are cut, those that may be nearest first, until none can be nearer than the pair of points at hand by
//! more than the tolerance. Two convex hulls are apart by at least what separates them along any direction; along the line
//! between the middles of two small pieces that is their distance up to the square of their size, so that pieces need not get
//! as small as the tolerance. The points themselves come from closest points on one set and on the other in turn, with
//! the limit of their sequence extrapolated.

use super::piece::{Piece, Place, hull, split};
use super::{Foot, PatchSet, QueryError};
use crate::surface::{Surface, Vec3};
use crate::trim::Part;
use nalgebra::Isometry3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Most pairs that are cut. What is left then shows in [`Separation::at_least`].
const MOST: usize = 100_000;
/// Pieces from which closest points are looked for first.
const STARTS: usize = 24;
const ITERATIONS: usize = 40;

/// The nearest points of two sets.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Separation {
    /// Their distance; 0 (to rounding) where the surfaces meet.
    pub distance: f64,
    /// No two points of the sets are nearer to each other than this.
    pub at_least: f64,
    /// The feet on the first and on the second set, the latter where the pose puts it. Their distances are those of the points
    /// from each other.
    pub feet: [Foot; 2],
}

/// Why there is no distance.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeparationError {
    /// The tolerance is not a positive finite number.
    #[error("the tolerance {0} of the distance is not a positive number")]
    Tolerance(f64),
    /// The pose is not finite.
    #[error(transparent)]
    Query(#[from] QueryError),
}

impl<S: Surface> PatchSet<S> {
    /// The distance between this set and the `other` one where `pose` puts it, up to `tolerance` (a length). Surfaces count,
    /// not what they enclose: the distance of a body inside of another one is that of their skins. The time grows where much
    /// of both is nearly as near (coaxial cylinders), by the square root of the tolerance for lines and in proportion for
    /// areas that are not flat; after a bounded number of steps [`Separation::at_least`] says how far the proof has come.
    ///
    /// # Errors
    /// A tolerance or a pose that is not finite.
    ///
    /// ```
    /// use covact_geometry::nalgebra::Isometry3;
    /// use covact_geometry::{Bilinear, PatchSet, Vec3};
    /// let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]].map(Vec3::from);
    /// let plate = PatchSet::new(vec![Bilinear::new(corners)?], None)?;
    /// // The same plate, put 2 to the side and .5 up: the nearest points lie on edges, 1 and .5 apart.
    /// let pose = Isometry3::translation(2.0, 0.0, 0.5);
    /// let found = plate.separation(&plate, &pose, 1e-9)?;
    /// assert!((found.distance - 1.25f64.sqrt()).abs() < 1e-8);
    /// assert!(found.at_least <= found.distance);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn separation<T: Surface>(
        &self,
        other: &PatchSet<T>,
        pose: &Isometry3<f64>,
        tolerance: f64,
    ) -> Result<Separation, SeparationError> {
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err(SeparationError::Tolerance(tolerance));
        }
        let mut search = Search {
            one: self,
            other,
            pose,
            best: None,
        };
        let count = self.pieces.count();
        let step = count.div_ceil(STARTS);
        for number in (0..count as u32).step_by(step) {
            let piece = self.piece_place(number);
            search.improve_from(&self.patches[piece.patch as usize].point(middle(piece.domain)))?;
        }
        search.run(tolerance)
    }
}

fn middle(domain: [[f64; 2]; 2]) -> [f64; 2] {
    domain.map(|[a, b]| 0.5 * (a + b))
}

struct Search<'a, S: Surface, T: Surface> {
    one: &'a PatchSet<S>,
    other: &'a PatchSet<T>,
    pose: &'a Isometry3<f64>,
    best: Option<(f64, [Foot; 2])>,
}

/// A part of a piece, in the coordinates of the first set.
#[derive(Clone)]
struct Cell {
    patch: u32,
    degree: [usize; 2],
    domain: [[f64; 2]; 2],
    net: Vec<[f64; 4]>,
    bounds: [Vec3; 2],
}

impl Cell {
    fn new(patch: u32, degree: [usize; 2], domain: [[f64; 2]; 2], net: Vec<[f64; 4]>) -> Self {
        let bounds = hull(&net);
        Self {
            patch,
            degree,
            domain,
            net,
            bounds,
        }
    }

    fn of(place: &Place, degree: [usize; 2], net: Vec<[f64; 4]>) -> Self {
        Self::new(place.patch, degree, place.domain, net)
    }

    fn size(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).norm()
    }

    fn centre(&self) -> Vec3 {
        (self.bounds[0] + self.bounds[1]) / 2.0
    }

    /// Lowest and highest place of the control points along a direction.
    fn extent(&self, n: &Vec3) -> [f64; 2] {
        let places = self
            .net
            .iter()
            .map(|&[x, y, z, w]| n.dot(&Vec3::new(x, y, z)) / w);
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| {
            [a.min(t), b.max(t)]
        })
    }

    /// Both halves, cut in the direction in which the net is longer, without what a trim takes away whole.
    fn halves<S: Surface>(mut self, surface: &S) -> Vec<Self> {
        let n1 = self.degree[0] + 1;
        let point = |k: usize| {
            let [x, y, z, w] = self.net[k];
            Vec3::new(x, y, z) / w
        };
        let last = self.net.len() - 1;
        let across =
            (point(n1 - 1) - point(0)).norm() + (point(last) - point(last + 1 - n1)).norm();
        let up = (point(last + 1 - n1) - point(0)).norm() + (point(last) - point(n1 - 1)).norm();
        let bend = |dir: usize| (1..self.degree[dir]).len() as f64 * 1e-3 * self.size();
        let dir = usize::from(up + bend(1) > across + bend(0));
        let mut right = self.net.clone();
        split(&mut self.net, &mut right, self.degree, dir, 0.5);
        let [a, b] = self.domain[dir];
        let mut domains = [self.domain; 2];
        domains[0][dir][1] = 0.5 * (a + b);
        domains[1][dir][0] = 0.5 * (a + b);
        let nets = [self.net, right];
        let halves = domains.into_iter().zip(nets);
        let kept = halves.filter(|(domain, _)| {
            surface
                .trim()
                .is_none_or(|trim| trim.part(*domain) != Part::Outside)
        });
        kept.map(|(domain, net)| Self::new(self.patch, self.degree, domain, net))
            .collect()
    }
}

/// A pair of cells with a bound on the distance of any two of their points.
struct Pair {
    bound: f64,
    cells: [Cell; 2],
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The pair with the lowest bound is the greatest.
impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

fn box_distance(a: &[Vec3; 2], b: &[Vec3; 2]) -> f64 {
    let gaps = (0..3).map(|k| (a[0][k] - b[1][k]).max(b[0][k] - a[1][k]).max(0.0));
    gaps.map(|d| d * d).sum::<f64>().sqrt()
}

impl<S: Surface, T: Surface> Search<'_, S, T> {
    fn distance(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |b| b.0)
    }

    /// The foot on the second set nearest to a point, and that on the first one nearest to it in turn.
    fn there_and_back(&self, x: &Vec3) -> Result<[Foot; 2], QueryError> {
        let there = self.other.closest_at(self.pose, x, f64::INFINITY)?;
        let back = self.one.closest(&there.jet.rho)?;
        Ok([back, there])
    }

    /// Takes closest points in turn, from `x` on, for as long as they get nearer to each other.
    fn improve_from(&mut self, x: &Vec3) -> Result<(), QueryError> {
        let mut feet = self.there_and_back(x)?;
        let mut steps: Vec<Vec3> = vec![feet[0].jet.rho];
        for _ in 0..ITERATIONS {
            let before = feet[0].distance;
            // Not worth following where it will not beat what is known.
            if before > 4.0 * self.distance() + self.one.size * 1e-3 {
                break;
            }
            let next = self.there_and_back(&feet[0].jet.rho)?;
            if next[0].distance < feet[0].distance {
                feet = next;
            }
            steps.push(feet[0].jet.rho);
            if let [.., a, b, c] = steps[..] {
                // The limit of steps that shrink by the same factor each time.
                let (first, second) = (b - a, c - b);
                let factor = second.norm() / first.norm();
                if factor.is_finite() && factor < 0.9999 && factor > 0.05 {
                    let limit = c + second * (factor / (1.0 - factor));
                    let beyond = self.there_and_back(&limit)?;
                    if beyond[0].distance < feet[0].distance {
                        feet = beyond;
                        steps = vec![feet[0].jet.rho];
                    }
                }
            }
            if before - feet[0].distance <= 1e-15 * self.one.size {
                break;
            }
        }
        let distance = feet[0].distance;
        if distance < self.distance() {
            // The foot on the second set belongs to the one on the first.
            feet[1].distance = distance;
            self.best = Some((distance, feet));
        }
        Ok(())
    }

    /// The middle of the first cell if the middles of both, where their trims leave them, are nearer than the best pair.
    fn nearer(&self, a: &Cell, b: &Cell) -> Option<Vec3> {
        let (p, q) = (middle(a.domain), middle(b.domain));
        let one = &self.one.patches[a.patch as usize];
        let other = &self.other.patches[b.patch as usize];
        let x = one.point(p);
        let y = self.pose.transform_point(&other.point(q).into()).coords;
        let nearer = (x - y).norm() < self.distance();
        let left = |trim: Option<&crate::trim::Trim>, xi| trim.is_none_or(|t| t.contains(xi));
        (nearer && left(one.trim(), p) && left(other.trim(), q)).then_some(x)
    }

    /// Whether the first cell is the one to be cut: the one that is deeper along the line between both, by which the bound on
    /// their distance falls short of it. (A cell across that line is not, however large it is.)
    fn first_is_deeper(&self, a: &Cell, b: &Cell) -> bool {
        let n = (a.centre() - b.centre()).try_normalize(0.0);
        let best = self.best.map(|(_, feet)| feet[0].jet.rho - feet[1].jet.rho);
        let n = best.and_then(|d| d.try_normalize(0.0)).or(n);
        let depth = |cell: &Cell| {
            let along = n.map_or(0.0, |n| {
                let [low, high] = cell.extent(&n);
                high - low
            });
            along + 1e-3 * cell.size()
        };
        depth(a) >= depth(b)
    }

    /// A bound on the distance of any two points of two cells.
    fn bound(&self, a: &Cell, b: &Cell) -> f64 {
        let mut bound = box_distance(&a.bounds, &b.bounds);
        let middles = a.centre() - b.centre();
        let best = self.best.map(|(_, feet)| feet[0].jet.rho - feet[1].jet.rho);
        for direction in [Some(middles), best].into_iter().flatten() {
            if let Some(n) = direction.try_normalize(0.0) {
                let ([low, _], [_, high]) = (a.extent(&n), b.extent(&n));
                let ([_, top], [bottom, _]) = (a.extent(&n), b.extent(&n));
                bound = bound.max(low - high).max(bottom - top);
            }
        }
        bound
    }

    fn run(mut self, tolerance: f64) -> Result<Separation, SeparationError> {
        let mut pairs = BinaryHeap::new();
        let turn = self.pose.rotation;
        let placed = |piece: &Piece| {
            let net = piece.net().iter().map(|&[x, y, z, w]| {
                let p = turn * Vec3::new(x, y, z) + self.pose.translation.vector * w;
                [p.x, p.y, p.z, w]
            });
            Cell::of(piece, piece.degree, net.collect())
        };
        let back = self.pose.inverse();
        for number in 0..self.one.pieces.count() as u32 {
            if !self.one.trimmed.is_inside(number) && !self.one.trimmed.is_cut(number) {
                continue;
            }
            let place = self.one.piece_place(number);
            let (degree, net) = self.one.net_at(&place);
            let cell = Cell::of(&place, degree, net);
            // A ball around the cell in the coordinates of the other set.
            let centre = back.transform_point(&cell.centre().into()).coords;
            let radius = cell.size() / 2.0;
            let limit = (self.distance() + radius).powi(2) * (1.0 + 1e-12);
            let measure = |low: &Vec3, high: &Vec3| {
                let inverted = low.x > high.x;
                let d2 = super::piece::box_distance2(&centre, low, high);
                if inverted { f64::INFINITY } else { d2 }
            };
            let mut found = Vec::new();
            self.other.tree.scan(measure, limit.min(f64::MAX), |leaf| {
                if (leaf as usize) < self.other.pieces.count() {
                    found.push(self.other.piece(leaf));
                }
                limit.min(f64::MAX)
            });
            for piece in found {
                let pair = [cell.clone(), placed(piece)];
                let bound = self.bound(&pair[0], &pair[1]);
                if bound < self.distance() - tolerance {
                    pairs.push(Pair { bound, cells: pair });
                }
            }
        }
        let mut cut = 0;
        let mut at_least = f64::INFINITY;
        while let Some(Pair { bound, cells }) = pairs.pop() {
            if bound >= self.distance() - tolerance || cut >= MOST {
                at_least = bound;
                break;
            }
            cut += 1;
            let [a, b] = cells;
            if let Some(x) = self.nearer(&a, &b) {
                self.improve_from(&x)?;
            }
            let (kept, parts, first) = match self.first_is_deeper(&a, &b) {
                true => {
                    let surface = &self.one.patches[a.patch as usize];
                    (b, a.halves(surface), true)
                }
                false => {
                    let surface = &self.other.patches[b.patch as usize];
                    (a, b.halves(surface), false)
                }
            };
            for part in parts {
                let cells = if first {
                    [part, kept.clone()]
                } else {
                    [kept.clone(), part]
                };
                let found = self.bound(&cells[0], &cells[1]).max(bound);
                if found < self.distance() - tolerance {
                    pairs.push(Pair {
                        bound: found,
                        cells,
                    });
                }
            }
        }
        let (distance, feet) = self.best.ok_or(QueryError::NotFinite)?;
        Ok(Separation {
            distance,
            at_least: at_least.min(distance - tolerance).max(0.0),
            feet,
        })
    }
}
