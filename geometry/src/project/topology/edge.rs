//! Edges of patches: the sides of the domain or, on a trimmed patch, the trim curves. Both are curves `t -> xi -> rho`.

use super::super::EdgeKind;
use super::super::set::PatchSet;
use super::senses::senses;
use crate::surface::{Jet, Surface, Vec3};

/// Tangents turn by no more than this (radians) from sample to sample, as long as [`DEPTH`] bisections allow.
const TURN: f64 = 0.25;
const DEPTH: usize = 6;
/// Chords in a block of a long polyline.
pub(super) const BLOCK: usize = 16;
/// Share of a chord by which the box around it grows: more than an arc that turns by [`TURN`] bulges.
const BULGE: f64 = 0.15;

/// Which curve an edge is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EdgeCurve {
    /// Parameter `dir` fixed at the start (0) or end (1) of the domain; the other one is the parameter of the edge.
    Side { dir: usize, end: usize },
    /// A curve of a trim loop, with the curve's own parameter.
    Trim { a_loop: usize, curve: usize },
}

/// A point of the polyline that stands for an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub t: f64,
    pub xi: [f64; 2],
    pub point: Vec3,
}

/// The other side of a part of an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link {
    /// Index of the other edge.
    pub edge: usize,
    /// Part of this edge that lies on the other one.
    pub own: [f64; 2],
    /// Side of the other patch over the side of this one.
    pub relation: f64,
    /// Points farther from this than each other are not on both edges: twice the tolerance or the gap.
    pub reach: f64,
    /// Smooth or sharp, by the largest angle.
    pub kind: EdgeKind,
}

/// An edge with its polyline and, when matching is done, with what lies behind it.
#[derive(Debug, Clone)]
pub(crate) struct Edge {
    pub patch: u32,
    /// Its number in [`Location`](crate::Location).
    pub number: u32,
    pub curve: EdgeCurve,
    pub interval: [f64; 2],
    /// +1 where the surface lies to the left of the edge in the plane (xi1, xi2), walked with growing parameter.
    pub sense: f64,
    /// Number of the file's curve or edge, 0 for none.
    pub entity: u32,
    pub samples: Vec<Sample>,
    /// Boxes around every [`BLOCK`] chords of a long polyline, else none.
    pub blocks: Vec<[Vec3; 2]>,
    /// A box that holds it.
    pub bounds: [Vec3; 2],
    /// Share of its length by which the box of a chord must grow to hold the arc; 0 for a straight edge.
    pub bulge: f64,
    /// Unit vector from end to end, zero where the ends meet, and the largest angle of a tangent with it.
    pub axis: Vec3,
    pub cone: f64,
    pub length: f64,
    /// `None` for a pole. Partly joined edges are free here; see [`kind_at`](Self::kind_at).
    pub kind: Option<EdgeKind>,
    pub links: Vec<Link>,
    /// Groups of corners that meet it between its ends, by parameter.
    pub vertices: Vec<(f64, u32)>,
}

/// A point of an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePoint {
    pub t: f64,
    pub xi: [f64; 2],
    /// Span of the surface on the material's side.
    pub span: [usize; 2],
    /// Jet of the surface there.
    pub jet: Jet,
    /// Derivatives of the space point along the edge.
    pub d1: Vec3,
    pub d2: Vec3,
}

impl Edge {
    /// Length of the part of the polyline between two parameters.
    pub fn length_between(&self, [a, b]: [f64; 2]) -> f64 {
        let mut sum = 0.0;
        for pair in self.samples.windows(2) {
            let (t0, t1) = (pair[0].t, pair[1].t);
            let part = (b.min(t1) - a.max(t0)) / (t1 - t0);
            if part > 0.0 {
                sum += part * (pair[1].point - pair[0].point).norm();
            }
        }
        sum
    }

    /// Parameter that is about `distance` away from `t`, for margins.
    pub fn margin(&self, distance: f64) -> f64 {
        if self.length > 0.0 {
            distance / self.length * (self.interval[1] - self.interval[0])
        } else {
            0.0
        }
    }

    /// Links of the part that holds `t`.
    pub fn links_at(&self, t: f64) -> impl Iterator<Item = &Link> {
        self.links.iter().filter(move |link| {
            let margin = self.margin(link.reach);
            t >= link.own[0] - margin && t <= link.own[1] + margin
        })
    }

    /// What the edge is at `t`.
    pub fn kind_at(&self, t: f64) -> Option<EdgeKind> {
        self.kind?;
        let mut kind = EdgeKind::Free;
        for link in self.links_at(t) {
            if link.kind == EdgeKind::Sharp || kind == EdgeKind::Free {
                kind = link.kind;
            }
        }
        Some(kind)
    }

    /// Parts that no link covers.
    pub fn free_parts(&self) -> Vec<[f64; 2]> {
        let mut parts = vec![self.interval];
        for link in &self.links {
            parts = subtract(&parts, link.own);
        }
        parts
    }
}

/// Intervals without what lies in `[a, b]`.
pub(super) fn subtract(parts: &[[f64; 2]], [a, b]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut left = Vec::with_capacity(parts.len() + 1);
    for &[s, e] in parts {
        if b <= s || a >= e {
            left.push([s, e]);
            continue;
        }
        if a > s {
            left.push([s, a]);
        }
        if b < e {
            left.push([b, e]);
        }
    }
    left
}

/// The edges of a patch, in the order of their numbers, without what lies behind them.
pub(super) fn edges_of<S: Surface>(set: &PatchSet<S>, patch: u32) -> Vec<Edge> {
    let surface = &set.patches[patch as usize];
    let grid = &set.grids[patch as usize];
    let blank = |number: u32, curve: EdgeCurve, interval: [f64; 2], sense: f64, entity: u32| Edge {
        patch,
        number,
        curve,
        interval,
        sense,
        entity,
        samples: Vec::new(),
        blocks: Vec::new(),
        bounds: [Vec3::zeros(); 2],
        bulge: BULGE,
        axis: Vec3::zeros(),
        cone: std::f64::consts::PI,
        length: 0.0,
        kind: None,
        links: Vec::new(),
        vertices: Vec::new(),
    };
    let (degree, net) = grid.net(surface, &grid.place(patch, grid.first));
    let polynomial = net.iter().all(|p| p[3] == net[0][3]);
    let mut edges = Vec::new();
    match surface.trim() {
        None => {
            for number in 0..4 {
                let (dir, end) = (number / 2, number % 2);
                let along = 1 - dir;
                let breaks = &grid.breaks[along];
                let interval = [breaks[0], breaks[breaks.len() - 1]];
                let sense = if dir == end { -1.0 } else { 1.0 };
                let curve = EdgeCurve::Side { dir, end };
                let mut edge = blank(number as u32, curve, interval, sense, 0);
                // A straight line is known by its ends.
                let straight = degree[along] == 1 && breaks.len() == 2 && polynomial;
                let parts = if straight { 1 } else { degree[along] + 1 };
                sample(set, &mut edge, breaks, parts);
                edges.push(edge);
            }
        }
        Some(trim) => {
            let more = usize::from(degree[0] > 1) + usize::from(degree[1] > 1);
            let mut first = Vec::new();
            for (a_loop, curves) in trim.loops().iter().enumerate() {
                first.push(edges.len());
                for (curve, c) in curves.curves.iter().enumerate() {
                    let number = 4 + edges.len() as u32;
                    let basis = c.parameter.basis();
                    let mut breaks: Vec<f64> = (0..basis.span_count())
                        .map(|k| basis.span_range(k)[0])
                        .collect();
                    let interval = c.parameter.domain();
                    breaks.push(interval[1]);
                    let curve = EdgeCurve::Trim { a_loop, curve };
                    let mut edge = blank(number, curve, interval, 1.0, c.entity);
                    sample(set, &mut edge, &breaks, c.parameter.degree() + 1 + more);
                    edges.push(edge);
                }
            }
            first.push(edges.len());
            for (number, sense) in senses(&edges, &first).into_iter().enumerate() {
                for edge in &mut edges[first[number]..first[number + 1]] {
                    edge.sense = sense;
                }
            }
        }
    }
    edges
}

/// Evaluates an edge.
pub(crate) fn edge_point<S: Surface>(set: &PatchSet<S>, edge: &Edge, t: f64) -> EdgePoint {
    let surface = &set.patches[edge.patch as usize];
    let grid = &set.grids[edge.patch as usize];
    match edge.curve {
        EdgeCurve::Side { dir, end } => {
            let along = 1 - dir;
            let last = grid.spans[dir];
            let mut xi = [t; 2];
            xi[dir] = grid.breaks[dir][if end == 0 { 0 } else { last }];
            let mut span = surface.find_span(xi);
            span[dir] = if end == 0 { 0 } else { last - 1 };
            let jet = surface.jet_in_span(span, xi);
            EdgePoint {
                t,
                xi,
                span,
                d1: jet.rho_i[along],
                d2: jet.rho_ij[2 * along],
                jet,
            }
        }
        EdgeCurve::Trim { a_loop, curve } => {
            let domain = surface.domain();
            let into = |xi: [f64; 2]| [0, 1].map(|k| xi[k].clamp(domain[k][0], domain[k][1]));
            // A patch with an edge of this kind has a trim with this curve.
            let Some(curve) = surface
                .trim()
                .and_then(|trim| trim.loops().get(a_loop)?.curves.get(curve))
            else {
                let span = surface.find_span([domain[0][0], domain[1][0]]);
                let xi = into([t; 2]);
                let jet = surface.jet_in_span(span, xi);
                let (d1, d2) = (Vec3::zeros(), Vec3::zeros());
                return EdgePoint {
                    t,
                    xi,
                    span,
                    jet,
                    d1,
                    d2,
                };
            };
            let c = curve.parameter.jet(t);
            let xi = into([c.point.x, c.point.y]);
            // On a knot line the span is the one on the material's side.
            let extent = [0, 1].map(|k| domain[k][1] - domain[k][0]);
            let inward = [
                -c.d1.y * edge.sense / extent[0],
                c.d1.x * edge.sense / extent[1],
            ];
            let length = inward[0].hypot(inward[1]);
            let nudge = if length > 0.0 { 1e-9 / length } else { 0.0 };
            let span =
                surface.find_span(into([0, 1].map(|k| xi[k] + nudge * inward[k] * extent[k])));
            let jet = surface.jet_in_span(span, xi);
            let [r1, r2] = jet.rho_i;
            let [r11, r12, r22] = jet.rho_ij;
            EdgePoint {
                t,
                xi,
                span,
                jet,
                d1: r1 * c.d1.x + r2 * c.d1.y,
                d2: r11 * (c.d1.x * c.d1.x)
                    + r12 * (2.0 * c.d1.x * c.d1.y)
                    + r22 * (c.d1.y * c.d1.y)
                    + r1 * c.d2.x
                    + r2 * c.d2.y,
            }
        }
    }
}

/// A sample with its tangent: there may be thousands, and a point with its jet takes three times the memory.
struct Turn {
    sample: Sample,
    d1: Vec3,
}

impl Turn {
    fn of(p: &EdgePoint) -> Self {
        let sample = Sample {
            t: p.t,
            xi: p.xi,
            point: p.jet.rho,
        };
        Self { sample, d1: p.d1 }
    }
}

/// Fills the polyline of an edge: `parts` intervals in each of its own spans, more where it crosses spans of the surface
/// or turns.
fn sample<S: Surface>(set: &PatchSet<S>, edge: &mut Edge, breaks: &[f64], parts: usize) {
    let mut points = Vec::new();
    let mut last = edge_point(set, edge, breaks[0]);
    points.push(Turn::of(&last));
    for pair in breaks.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let end = edge_point(set, edge, b);
        let crossed = (0..2)
            .map(|k| end.span[k].abs_diff(last.span[k]))
            .sum::<usize>();
        let n = parts + crossed;
        for k in 1..=n {
            let next = if k == n {
                end
            } else {
                edge_point(set, edge, a + (b - a) * k as f64 / n as f64)
            };
            bisect(set, edge, &last, &next, DEPTH, &mut points);
            points.push(Turn::of(&next));
            last = next;
        }
    }
    directions(edge, &points);
    let mut low = Vec3::from_element(f64::INFINITY);
    let mut high = -low;
    let mut length = 0.0;
    for pair in points.windows(2) {
        let (a, b) = (pair[0].sample.point, pair[1].sample.point);
        let [l, h] = chord_box(&a, &b, edge.bulge);
        low = low.inf(&l);
        high = high.sup(&h);
        length += (b - a).norm();
    }
    edge.samples = points.iter().map(|p| p.sample).collect();
    if edge.samples.len() > 2 * BLOCK {
        let around = |k: usize| {
            let end = (k + BLOCK + 1).min(edge.samples.len());
            let own = edge.samples[k..end].iter().map(|s| s.point);
            let first = edge.samples[k].point;
            own.fold([first; 2], |[low, high], x| [low.inf(&x), high.sup(&x)])
        };
        let chords = edge.samples.len() - 1;
        edge.blocks = (0..chords).step_by(BLOCK).map(around).collect();
    }
    edge.bounds = [low, high];
    edge.length = length;
}

/// Bulge, axis and cone of an edge from the points of its polyline. Tangents are taken to turn between two points by no
/// more than they do anywhere from one point to the next.
fn directions(edge: &mut Edge, points: &[Turn]) {
    let angle = |a: &Vec3, b: &Vec3| a.cross(b).norm().atan2(a.dot(b));
    let mut turn = 0.0f64;
    for pair in points.windows(2) {
        let chord = pair[1].sample.point - pair[0].sample.point;
        let parts = [(&pair[0].d1, &chord), (&chord, &pair[1].d1)];
        // A tangent of no length has no direction: nothing is known.
        if pair.iter().any(|p| p.d1.norm_squared() == 0.0) {
            return;
        }
        turn = parts
            .iter()
            .fold(turn, |turn, (a, b)| turn.max(angle(a, b)));
        turn = turn.max(angle(&pair[0].d1, &pair[1].d1));
    }
    edge.bulge = BULGE.min(BULGE / TURN * turn);
    let run = points[points.len() - 1].sample.point - points[0].sample.point;
    if let Some(axis) = run.try_normalize(0.0)
        && turn <= 2.0 * TURN
    {
        edge.axis = axis;
        let widest = points.iter().map(|p| angle(&p.d1, &axis));
        edge.cone = turn + widest.fold(0.0, f64::max);
    }
}

fn bisect<S: Surface>(
    set: &PatchSet<S>,
    edge: &Edge,
    a: &EdgePoint,
    b: &EdgePoint,
    depth: usize,
    out: &mut Vec<Turn>,
) {
    let turn = a.d1.cross(&b.d1).norm().atan2(a.d1.dot(&b.d1));
    if depth == 0 || turn <= TURN || !set.patches[edge.patch as usize].may_sample() {
        return;
    }
    let middle = edge_point(set, edge, 0.5 * (a.t + b.t));
    // A kink at one end needs no smaller intervals.
    bisect(set, edge, a, &middle, depth - 1, out);
    out.push(Turn::of(&middle));
    bisect(set, edge, &middle, b, depth - 1, out);
}

/// Box of a chord and its arc.
pub(super) fn chord_box(a: &Vec3, b: &Vec3, bulge: f64) -> [Vec3; 2] {
    let grow = Vec3::from_element(bulge * (b - a).norm());
    [a.inf(b) - grow, a.sup(b) + grow]
}
