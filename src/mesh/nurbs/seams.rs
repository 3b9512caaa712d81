//! Which edges of patches are the same curve in space, so that the shells on both sides are joined there.
//!
//! An edge is compared with every other one by its closest points: where the distance is within the tolerance all along a part
//! of both, the parts are a seam. Parts begin and end at the ends of either edge, so that knots need not match, an edge may run
//! along several others, and three patches may meet in one.
use super::borders::Line;
use super::{Border, DEGREE};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use std::cell::OnceCell;

/// Distance of edges that are one, as a part of the size of the body: what CAD systems leave.
const TOLERANCE: f64 = 1e-5;

/// The same as a part of the thickness: a gap that is no gap for a shell.
const OF_THICKNESS: f64 = 0.02;

/// The tolerance is no more than this part of an edge's length.
const OF_LENGTH: f64 = 0.05;

/// Points inside of a part that have to lie on the other edge.
const INSIDE: usize = 9;

/// A part of two borders that is one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// Both borders.
    pub edges: [Border; 2],
    /// Parameters along each, ascending.
    pub ranges: [[f64; 2]; 2],
    /// The parameters run against each other.
    pub opposed: bool,
    /// Both patches are on one side of it, seen along the parameter of each.
    pub same_sense: bool,
    /// Largest distance between both at the points that were compared (length).
    pub gap: f64,
}

/// A free edge that runs near another one without being joined to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// The free edge, and the edge that it runs near to.
    pub edges: [Border; 2],
    /// Largest distance of the points that were compared (length).
    pub distance: f64,
}

/// Edges of a body's patches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Joints {
    /// Parts of edges that are joined.
    pub seams: Vec<Seam>,
    /// Edges that are joined along all of their length.
    pub inner: Vec<Border>,
    /// Edges that are joined along some of it.
    pub partial: Vec<Border>,
    /// Free edges near others, to which they are not joined.
    pub near: Vec<Near>,
    /// Free edges that lie on the inside of a patch, as that of a rib, which is not joined.
    pub inside: Vec<(Border, usize)>,
}

/// A part of a border as a curve.
pub(crate) struct Curve<'a> {
    patch: &'a NurbsPatch,
    border: Border,
    pub line: Line<'a>,
    range: [f64; 2],
    samples: Vec<(f64, Vec3)>,
    length: f64,
}

impl<'a> Curve<'a> {
    pub fn new(patch: &'a NurbsPatch, border: Border, line: Line<'a>, range: [f64; 2]) -> Self {
        let mut curve = Curve {
            patch,
            border,
            range,
            samples: Vec::new(),
            length: 0.0,
            line,
        };
        for [a, b] in curve.line.pieces(range) {
            let steps = 2 * (DEGREE + 1);
            for k in 0..steps {
                let s = a + (b - a) * k as f64 / steps as f64;
                curve.samples.push((s, curve.point(s)));
            }
        }
        curve.samples.push((range[1], curve.point(range[1])));
        let chords = curve.samples.windows(2);
        curve.length = chords.map(|w| (w[1].1 - w[0].1).norm()).sum();
        curve
    }

    /// All of a border, in parts without corners that are not closed.
    fn of(patch: &'a NurbsPatch, border: Border) -> Vec<Self> {
        let line = Line::new(patch, patch.trim(), border);
        let part = |range: &[f64; 2]| {
            let [a, b] = *range;
            let at = [0, 1, 2, 3].map(|k| a + (b - a) * f64::from(k) / 3.0);
            let x = at.map(|s| patch.point(line.xi(s)));
            let closed = (x[3] - x[0]).norm() < 1e-3 * (x[2] - x[1]).norm();
            match closed {
                true => at.windows(2).map(|w| [w[0], w[1]]).collect(),
                false => vec![*range],
            }
        };
        let ranges: Vec<[f64; 2]> = line.ranges().iter().flat_map(part).collect();
        (ranges.into_iter())
            .map(|range| Curve::new(patch, border, line.clone(), range))
            .collect()
    }

    pub fn point(&self, s: f64) -> Vec3 {
        self.patch.point(self.line.xi(s))
    }

    fn tangent(&self, s: f64) -> Vec3 {
        let [x, y] = self.line.direction(s);
        let jet = self.patch.jet(self.line.xi(s));
        jet.rho_i[0] * x + jet.rho_i[1] * y
    }

    /// The closest point of the edge, and its distance.
    pub fn foot(&self, x: &Vec3) -> (f64, f64) {
        let by = |a: &&(f64, Vec3), b: &&(f64, Vec3)| {
            (a.1 - x)
                .norm_squared()
                .total_cmp(&(b.1 - x).norm_squared())
        };
        let mut s = self
            .samples
            .iter()
            .min_by(by)
            .map_or(self.range[0], |p| p.0);
        let [low, high] = self.range;
        for _ in 0..40 {
            let t = self.tangent(s);
            let step = (x - self.point(s)).dot(&t) / t.norm_squared();
            let next = (s + step).clamp(low, high);
            // Not finite where the tangent vanishes: the sample stands.
            if !next.is_finite() || (next - s).abs() <= 1e-15 * (high - low) {
                break;
            }
            s = next;
        }
        (s, (self.point(s) - x).norm())
    }

    fn bounds(&self) -> [Vec3; 2] {
        let start = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
        let points = self.samples.iter();
        points.fold(start, |[low, high], (_, x)| [low.inf(x), high.sup(x)])
    }

    fn ends(&self) -> [Vec3; 2] {
        [self.samples[0].1, self.samples[self.samples.len() - 1].1]
    }

    /// Parts of this edge that lie on `other`, as seams.
    fn on(&self, other: &Curve, tolerance: f64) -> Vec<Seam> {
        let tolerance = tolerance.min(OF_LENGTH * self.length.min(other.length));
        let [low, high] = self.range;
        let mut cuts = vec![low, high];
        for end in other.ends() {
            let (s, distance) = self.foot(&end);
            let from_ends = self.ends().map(|x| (self.point(s) - x).norm());
            if distance <= tolerance && from_ends.iter().all(|d| *d > 2.0 * tolerance) {
                cuts.push(s);
            }
        }
        cuts.sort_by(f64::total_cmp);
        let mut out = Vec::new();
        for part in cuts.windows(2) {
            let [a, b] = [part[0], part[1]];
            let at = |k: usize| a + (b - a) * k as f64 / (INSIDE + 1) as f64;
            let feet: Vec<(f64, f64)> = (1..=INSIDE)
                .map(|k| other.foot(&self.point(at(k))))
                .collect();
            let gap = feet.iter().map(|f| f.1).fold(0.0, f64::max);
            if gap > tolerance {
                continue;
            }
            let [from, to] = [a, b].map(|s| other.foot(&self.point(s)).0);
            // A closed curve would have one foot for both ends.
            let opposed = feet[INSIDE - 1].0 < feet[0].0;
            let run = if opposed { from > to } else { from < to };
            if run {
                out.push(Seam {
                    edges: [self.border, other.border],
                    same_sense: self.line.is_counter_clockwise()
                        == other.line.is_counter_clockwise(),
                    ranges: [[a, b], [from.min(to), from.max(to)]],
                    opposed,
                    gap,
                });
            }
        }
        out
    }
}

/// Whether two ranges have more in common than a small part of the shorter one.
fn overlap(a: [f64; 2], b: [f64; 2]) -> bool {
    let common = a[1].min(b[1]) - a[0].max(b[0]);
    common > 1e-3 * (a[1] - a[0]).min(b[1] - b[0])
}

impl Joints {
    /// Compares all edges of some patches of a shell of this thickness.
    pub fn new(patches: &[&NurbsPatch], thickness: f64) -> Joints {
        let mut out = Joints::default();
        if patches.len() < 2 {
            return out;
        }
        let curves: Vec<Curve> = (patches.iter().enumerate())
            .flat_map(|(k, patch)| Border::all(k, patch, patch.trim()).into_iter())
            .flat_map(|border| Curve::of(patches[border.patch()], border))
            .collect();
        let boxes: Vec<[Vec3; 2]> = curves.iter().map(Curve::bounds).collect();
        let low = boxes.iter().fold(boxes[0][0], |low, b| low.inf(&b[0]));
        let high = boxes.iter().fold(boxes[0][1], |high, b| high.sup(&b[1]));
        let tolerance = (TOLERANCE * (high - low).norm()).max(OF_THICKNESS * thickness);
        let apart = |i: usize, j: usize, reach: f64| {
            (0..3).any(|c| {
                boxes[i][0][c] > boxes[j][1][c] + reach || boxes[j][0][c] > boxes[i][1][c] + reach
            })
        };
        for i in 0..curves.len() {
            for j in i + 1..curves.len() {
                let own = curves[i].border.patch() == curves[j].border.patch();
                if !own && !apart(i, j, tolerance) {
                    out.seams.extend(curves[i].on(&curves[j], tolerance));
                }
            }
        }
        // Made where a free edge comes near; one that cannot be searched is near nothing.
        let surfaces = vec![OnceCell::new(); patches.len()];
        let surface = |k: usize| -> &Option<PatchSet> {
            surfaces[k].get_or_init(|| PatchSet::new(vec![patches[k].clone()], None).ok())
        };
        let extents: Vec<[Vec3; 2]> = patches.iter().map(|p| p.bounds()).collect();
        let free: Vec<Vec<[f64; 2]>> = curves.iter().map(|c| out.free(c)).collect();
        let mut at = 0;
        for group in curves.chunk_by(|a, b| a.border == b.border) {
            let own = at..at + group.len();
            at = own.end;
            let whole: f64 = group.iter().map(|c| c.range[1] - c.range[0]).sum();
            let left: f64 = free[own].iter().flatten().map(|[a, b]| b - a).sum();
            if left < 1e-3 * whole {
                out.inner.push(group[0].border);
            } else if left < (1.0 - 1e-3) * whole {
                out.partial.push(group[0].border);
            }
        }
        for (i, curve) in curves.iter().enumerate() {
            let free = &free[i];
            if out.inner.contains(&curve.border) {
                continue;
            }
            for (j, other) in curves.iter().enumerate() {
                let own = curve.border.patch() == other.border.patch();
                let known = |n: &Near| n.edges == [other.border, curve.border];
                if own || apart(i, j, thickness) || out.near.iter().any(known) {
                    continue;
                }
                for [a, b] in free {
                    let at = |k: usize| curve.point(a + (b - a) * 0.25 * k as f64);
                    let distances = [1, 2, 3].map(|k| other.foot(&at(k)).1);
                    let distance = distances.into_iter().fold(0.0, f64::max);
                    if distance <= thickness {
                        let edges = [curve.border, other.border];
                        out.near.push(Near { edges, distance });
                        break;
                    }
                }
            }
            for (k, [low, high]) in extents.iter().enumerate() {
                let told = |n: &Near| n.edges.contains(&curve.border);
                let far = (0..3).any(|c| {
                    boxes[i][0][c] > high[c] + thickness || boxes[i][1][c] < low[c] - thickness
                });
                if far || k == curve.border.patch() || out.near.iter().any(told) {
                    continue;
                }
                let on = |[a, b]: &[f64; 2]| {
                    let near = |x: &Vec3| {
                        let surface = surface(k).as_ref();
                        surface.is_some_and(|s| s.project(x, None, thickness).is_some())
                    };
                    (1..=3).all(|m| near(&curve.point(a + (b - a) * 0.25 * f64::from(m))))
                };
                if free.iter().any(on) {
                    out.inside.push((curve.border, k));
                }
            }
        }
        out
    }

    /// Parts of an edge that are on no seam.
    fn free(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let mut taken: Vec<[f64; 2]> = (self.seams.iter())
            .flat_map(|seam| [0, 1].map(|k| (seam.edges[k], seam.ranges[k])))
            .filter(|(edge, _)| *edge == curve.border)
            .map(|(_, range)| range)
            .collect();
        taken.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [start, end] = curve.range;
        let (mut from, mut free) = (start, Vec::new());
        for [a, b] in taken.into_iter().filter(|[a, b]| *b > start && *a < end) {
            if a > from {
                free.push([from, a]);
            }
            from = from.max(b);
        }
        if end > from {
            free.push([from, end]);
        }
        free
    }

    /// Which patches have to be turned over, so that the normals of all point to one side: that of the first one of each
    /// connected part. Where three and more meet, any side will do.
    ///
    /// # Errors
    /// Two neighbours that cannot have one side: a surface with one side only.
    pub fn turned(&self, patches: usize) -> Result<Vec<bool>, [usize; 2]> {
        let branches = |seam: &Seam| {
            [0, 1].iter().any(|&k| {
                let others = self.seams.iter().filter(|o| *o != seam);
                others
                    .flat_map(|o| [0, 1].map(|m| (o.edges[m], o.ranges[m])))
                    .any(|(edge, range)| edge == seam.edges[k] && overlap(range, seam.ranges[k]))
            })
        };
        let links: Vec<([usize; 2], bool)> = (self.seams.iter())
            .filter(|seam| !branches(seam))
            .map(|seam| {
                let same = seam.same_sense != seam.opposed;
                (seam.edges.map(Border::patch), same)
            })
            .collect();
        let mut turned: Vec<Option<bool>> = vec![None; patches];
        for first in 0..patches {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            let mut front = vec![first];
            while let Some(at) = front.pop() {
                for (pair, same) in links.iter().filter(|(pair, _)| pair.contains(&at)) {
                    let other = if pair[0] == at { pair[1] } else { pair[0] };
                    let wanted = turned[at].map(|t| t != *same);
                    match turned[other] {
                        None => {
                            turned[other] = wanted;
                            front.push(other);
                        }
                        found if found != wanted => return Err(*pair),
                        _ => {}
                    }
                }
            }
        }
        Ok(turned.into_iter().map(|t| t == Some(true)).collect())
    }
}
