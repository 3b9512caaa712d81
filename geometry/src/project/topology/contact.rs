//! Which parts of one edge lie on another one.

use super::super::piece::box_distance2;
use super::super::set::PatchSet;
use super::edge::{Edge, EdgePoint, chord_box, edge_point};
use super::nearest::nearest_on_edge;
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// Bisections of an interval of which only a part is in contact (edges that leave each other tangentially).
const DEPTH: usize = 6;
/// Cosine of the largest angle between edges that count as running along each other.
const PARALLEL: f64 = 0.9;

/// One edge against another one.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    /// Parts of the edge that lie on the other one, in order.
    pub covered: Vec<[f64; 2]>,
    /// Their length.
    pub length: f64,
    /// Largest distance and where.
    pub gap: f64,
    pub gap_at: Vec3,
    /// Sum of the signs of tangent products.
    pub sense: f64,
    /// Largest angle of normals, with the other normal taken as it is and reversed.
    pub angles: [f64; 2],
    /// Smallest angle of normals, likewise.
    pub least_angles: [f64; 2],
    /// Ends of the other edge that lie on this one between its ends: which end, and the parameter here.
    pub ends: Vec<(usize, f64)>,
}

impl Contact {
    const NONE: Contact = Contact {
        covered: Vec::new(),
        length: 0.0,
        gap: 0.0,
        gap_at: Vec3::new(0.0, 0.0, 0.0),
        sense: 0.0,
        angles: [0.0; 2],
        least_angles: [f64::INFINITY; 2],
        ends: Vec::new(),
    };
}

/// Whether two edges are proved to be in contact over no more than four tolerances, from their directions and ends alone:
/// nowhere do they run along each other; or they run alike, and seen along their common direction, in which both only
/// advance, one ends where the other begins.
pub(super) fn apart(one: &Edge, other: &Edge, tolerance: f64) -> bool {
    let (a, b) = (one.axis, other.axis);
    let between = a.cross(&b).norm().atan2(a.dot(&b).abs());
    // A hundredth of a radian is left for how angles are sampled.
    if between - one.cone - other.cone > PARALLEL.acos() + 0.01 {
        return true;
    }
    let along = if a.dot(&b) < 0.0 { a - b } else { a + b };
    let Some(along) = along.try_normalize(0.0) else {
        return false;
    };
    // No tangent is farther off than this, so lengths are at most 5/2 of what is seen of them.
    let widest = 0.5 * between + one.cone.max(other.cone);
    if widest.is_nan() || widest > 0.4f64.acos() {
        return false;
    }
    let range = |edge: &Edge| {
        let ends = [0, edge.samples.len() - 1].map(|k| edge.samples[k].point.dot(&along));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    };
    let (one, other) = (range(one), range(other));
    let common = one[1].min(other[1]) - one[0].max(other[0]);
    2.5 * (common + tolerance) < 3.9 * tolerance
}

/// A compared point.
#[derive(Clone, Copy)]
struct Probe {
    t: f64,
    point: EdgePoint,
    /// Nearest point of the other edge, if it was looked for.
    at: Option<EdgePoint>,
    /// Within the tolerance of the other edge.
    on: bool,
    /// The edges run along each other here, as far as their tangents can tell.
    parallel: bool,
}

/// Finds the parts of `one` that are within `tolerance` of `other` and run along it. Parts begin and end at samples and at
/// the ends of the other edge, so no contact is too short to be found; where the edges leave each other tangentially it is
/// bisected.
pub(super) fn contact<S: Surface>(
    set: &PatchSet<S>,
    one: &Edge,
    other: &Edge,
    tolerance: f64,
) -> Contact {
    let mut out = Contact::NONE;
    let grow = Vec3::from_element(tolerance);
    let [low, high] = other.bounds;
    let (low, high) = (low - grow, high + grow);
    let [first, last] = one.interval;
    let ends = [0, other.samples.len() - 1].map(|k| other.samples[k].point);
    let mut inner: Vec<f64> = Vec::new();
    for (end, p) in ends.iter().enumerate() {
        if box_distance2(p, &one.bounds[0], &one.bounds[1]) > tolerance * tolerance {
            continue;
        }
        let at = nearest_on_edge(set, p, one);
        let margin = one.margin(tolerance);
        if (at.jet.rho - p).norm() <= tolerance && at.t > first + margin && at.t < last - margin {
            inner.push(at.t);
            out.ends.push((end, at.t));
        }
    }
    inner.sort_by(f64::total_cmp);
    let mut compare = Compare {
        set,
        one,
        other,
        tolerance,
        out,
    };
    let mut before: Option<Probe> = None;
    for pair in one.samples.windows(2) {
        let [near, far] = chord_box(&pair[0].point, &pair[1].point, one.bulge);
        let apart = (0..3).any(|k| near[k] > high[k] || far[k] < low[k]);
        if apart {
            before = None;
            continue;
        }
        let mut start = before.unwrap_or_else(|| compare.probe(pair[0].t));
        let within = inner.iter().filter(|t| **t > pair[0].t && **t < pair[1].t);
        for &t in within.chain([&pair[1].t]) {
            let end = compare.probe(t);
            compare.interval(&start, &end, DEPTH);
            start = end;
        }
        before = Some(start);
    }
    let mut out = compare.out;
    out.length = out
        .covered
        .iter()
        .map(|part| one.length_between(*part))
        .sum();
    out
}

struct Compare<'a, S: Surface> {
    set: &'a PatchSet<S>,
    one: &'a Edge,
    other: &'a Edge,
    tolerance: f64,
    out: Contact,
}

impl<S: Surface> Compare<'_, S> {
    fn probe(&mut self, t: f64) -> Probe {
        let point = edge_point(self.set, self.one, t);
        let p = &point.jet.rho;
        let mut probe = Probe {
            t,
            point,
            at: None,
            on: false,
            parallel: false,
        };
        let [low, high] = &self.other.bounds;
        if box_distance2(p, low, high) > self.tolerance * self.tolerance {
            return probe;
        }
        let at = nearest_on_edge(self.set, p, self.other);
        probe.on = (at.jet.rho - p).norm() <= self.tolerance;
        let product = point.d1.dot(&at.d1);
        probe.parallel = product.abs() >= PARALLEL * point.d1.norm() * at.d1.norm();
        probe.at = Some(at);
        probe
    }

    /// Takes the interval between two probes if all of it is in contact, else looks into its halves.
    fn interval(&mut self, a: &Probe, b: &Probe, depth: usize) {
        let middle = self.probe(0.5 * (a.t + b.t));
        let good = |p: &Probe| p.on && p.parallel;
        if a.on && b.on && good(&middle) {
            for probe in [a, &middle, b] {
                self.measure(probe);
            }
            match self.out.covered.last_mut() {
                Some(last) if last[1] == a.t => last[1] = b.t,
                _ => self.out.covered.push([a.t, b.t]),
            }
            return;
        }
        if depth > 0 && (good(a) || good(&middle) || good(b)) {
            self.interval(a, &middle, depth - 1);
            self.interval(&middle, b, depth - 1);
        }
    }

    /// Gap, sense and angle at a point in contact.
    fn measure(&mut self, probe: &Probe) {
        let p = probe.point.jet.rho;
        let Some(at) = probe.at else {
            return;
        };
        let gap = (at.jet.rho - p).norm();
        if gap >= self.out.gap {
            (self.out.gap, self.out.gap_at) = (gap, 0.5 * (p + at.jet.rho));
        }
        if !probe.parallel {
            return;
        }
        self.out.sense += probe.point.d1.dot(&at.d1).signum();
        let normals = (Frame::new(&probe.point.jet, 1.0), Frame::new(&at.jet, 1.0));
        if let (Some(a), Some(b)) = normals {
            let angle = a.n.cross(&b.n).norm().atan2(a.n.dot(&b.n));
            for (k, angle) in [angle, std::f64::consts::PI - angle]
                .into_iter()
                .enumerate()
            {
                self.out.angles[k] = self.out.angles[k].max(angle);
                self.out.least_angles[k] = self.out.least_angles[k].min(angle);
            }
        }
    }
}
