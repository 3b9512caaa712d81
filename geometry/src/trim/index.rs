//! Tree over the monotone pieces of all loops: whether a point is inside, how a rectangle lies, what border is near.
//!
//! Below the loops every node is a chain of consecutive pieces. A ray to the right crosses a chain whose box lies to the
//! right of the point an odd number of times exactly where the chain's ends lie on different sides of the ray, so only
//! boxes that hold the point itself are opened: O(log n) unless many loops nest or wind about it.

use std::cmp::Ordering;

use super::monotone::{Monotone, Point};

const LEAF: u32 = 1 << 31;
/// More than twice the depth of any tree.
const STACK: usize = 96;

#[derive(Debug, Clone, PartialEq)]
struct Node {
    low: Point,
    high: Point,
    /// xi2 of both ends of the chain; equal for whole loops.
    ends: [f64; 2],
    /// The second child (the first one follows its parent), or the piece with [`LEAF`] set.
    next: u32,
}

/// How a rectangle of parameters lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// No loop meets it, and it belongs to the surface.
    Inside,
    /// No loop meets it, and it does not belong to the surface.
    Outside,
    /// A loop meets it.
    Cut,
}

/// The nearest point of the loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BorderPoint {
    /// Number of the curve, counted over all loops.
    pub curve: u32,
    /// Parameter of the curve.
    pub t: f64,
    /// Point of the parameter plane.
    pub xi: [f64; 2],
    /// Distance, each direction divided by its scale.
    pub distance: f64,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Index {
    nodes: Vec<Node>,
    pub pieces: Vec<Monotone>,
}

impl Index {
    /// `loops` gives the range of pieces of every loop.
    pub fn new(pieces: Vec<Monotone>, loops: &[std::ops::Range<usize>]) -> Self {
        let mut index = Index {
            nodes: Vec::with_capacity(2 * pieces.len()),
            pieces,
        };
        let boxes: Vec<[Point; 2]> = loops.iter().map(|r| index.bounds(r.clone())).collect();
        let mut order: Vec<usize> = (0..loops.len()).collect();
        if !order.is_empty() {
            index.join(loops, &boxes, &mut order);
        }
        index
    }

    fn bounds(&self, range: std::ops::Range<usize>) -> [Point; 2] {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for piece in &self.pieces[range] {
            let [l, h] = piece.bounds();
            for k in 0..2 {
                low[k] = low[k].min(l[k]);
                high[k] = high[k].max(h[k]);
            }
        }
        [low, high]
    }

    /// Node over whole loops.
    fn join(
        &mut self,
        loops: &[std::ops::Range<usize>],
        boxes: &[[Point; 2]],
        order: &mut [usize],
    ) {
        if let [one] = *order {
            return self.chain(loops[one].clone());
        }
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut centre = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for &k in order.iter() {
            let [l, h] = boxes[k];
            for d in 0..2 {
                low[d] = low[d].min(l[d]);
                high[d] = high[d].max(h[d]);
                centre[0][d] = centre[0][d].min(l[d] + h[d]);
                centre[1][d] = centre[1][d].max(l[d] + h[d]);
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node {
            low,
            high,
            ends: [0.0; 2],
            next: 0,
        });
        let axis = usize::from(centre[1][1] - centre[0][1] > centre[1][0] - centre[0][0]);
        let at = |k: usize| boxes[k][0][axis] + boxes[k][1][axis];
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let (first, second) = order.split_at_mut(middle);
        self.join(loops, boxes, first);
        self.nodes[node].next = self.nodes.len() as u32;
        self.join(loops, boxes, second);
    }

    /// Node over consecutive pieces of a loop.
    fn chain(&mut self, range: std::ops::Range<usize>) {
        let [low, high] = self.bounds(range.clone());
        let node = self.nodes.len();
        let (start, end) = (range.start, range.end);
        self.nodes.push(Node {
            low,
            high,
            ends: [self.pieces[start].from[1], self.pieces[end - 1].to[1]],
            next: start as u32 | LEAF,
        });
        if end - start > 1 {
            let middle = start + (end - start) / 2;
            self.chain(start..middle);
            self.nodes[node].next = self.nodes.len() as u32;
            self.chain(middle..end);
        }
    }

    /// Whether a ray from `xi` towards larger xi1 crosses the loops an odd number of times; a vertex counts with the part
    /// above it, so nothing is counted twice. `opened` is told of every node looked at.
    #[inline]
    pub fn contains(&self, xi: Point, mut opened: impl FnMut()) -> bool {
        let [x, y] = xi;
        let mut odd = false;
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let number = stack[top];
            let node = &self.nodes[number as usize];
            opened();
            if y < node.low[1] || y >= node.high[1] || x > node.high[0] {
                continue;
            }
            if x < node.low[0] {
                odd ^= (node.ends[0] > y) != (node.ends[1] > y);
            } else if node.next & LEAF != 0 {
                let piece = &self.pieces[(node.next & !LEAF) as usize];
                odd ^= piece.compare(1, y, x) == Ordering::Greater;
            } else if top + 2 <= STACK {
                stack[top] = node.next;
                stack[top + 1] = number + 1;
                top += 2;
            }
        }
        odd
    }

    /// Whether any piece meets the closed rectangle.
    pub fn meets(&self, low: Point, high: Point) -> bool {
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let number = stack[top];
            let node = &self.nodes[number as usize];
            if (0..2).any(|k| node.low[k] > high[k] || node.high[k] < low[k]) {
                continue;
            }
            if node.next & LEAF != 0 {
                if self.pieces[(node.next & !LEAF) as usize].meets(low, high) {
                    return true;
                }
            } else if top + 2 <= STACK {
                stack[top] = node.next;
                stack[top + 1] = number + 1;
                top += 2;
            }
        }
        false
    }

    /// The point of the loops that is nearest to `xi`, directions divided by `scale`, if it is nearer than `reach`.
    pub fn nearest(&self, xi: Point, scale: [f64; 2], reach: f64) -> Option<BorderPoint> {
        let mut best: Option<(&Monotone, f64, BorderPoint)> = None;
        let mut limit = reach;
        let far = |low: &Point, high: &Point| {
            let d = [0, 1].map(|k| (low[k] - xi[k]).max(xi[k] - high[k]).max(0.0) / scale[k]);
            (d[0] * d[0] + d[1] * d[1]).sqrt()
        };
        let mut stack = [(0u32, 0.0f64); STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let (number, distance) = stack[top];
            if distance >= limit {
                continue;
            }
            let node = &self.nodes[number as usize];
            if node.next & LEAF != 0 {
                let piece = &self.pieces[(node.next & !LEAF) as usize];
                if let Some((s, found)) = nearest_of(piece, xi, scale, limit) {
                    limit = found.distance;
                    best = Some((piece, s, found));
                }
                continue;
            }
            let pair = [number + 1, node.next].map(|n| {
                let node = &self.nodes[n as usize];
                (n, far(&node.low, &node.high))
            });
            let order = if pair[0].1 <= pair[1].1 {
                [1, 0]
            } else {
                [0, 1]
            };
            for k in order {
                if pair[k].1 < limit && top < STACK {
                    stack[top] = pair[k];
                    top += 1;
                }
            }
        }
        let (piece, s, point) = best?;
        Some(downhill(piece, xi, scale, s, point))
    }
}

/// Points of the border that are farther away than the nearest by no more than this share may be taken for it.
const CLOSE: f64 = 1e-3;

/// Nearest point of one piece with its place there, if nearer than `limit`: halves whose box (that of their ends) is
/// farther away are left out.
fn nearest_of(
    piece: &Monotone,
    xi: Point,
    scale: [f64; 2],
    limit: f64,
) -> Option<(f64, BorderPoint)> {
    let off = |p: &Point| [0, 1].map(|k| (p[k] - xi[k]) / scale[k]);
    let length = |p: &Point| {
        let [a, b] = off(p);
        (a * a + b * b).sqrt()
    };
    let bound = |a: &Point, b: &Point| {
        let (a, b) = (off(a), off(b));
        let d = [0, 1].map(|k| a[k].min(b[k]).max(-a[k].max(b[k])).max(0.0));
        (d[0] * d[0] + d[1] * d[1]).sqrt()
    };
    let mut best: Option<(f64, BorderPoint)> = None;
    let mut limit = limit;
    let mut offer = |s: f64, p: Point, limit: &mut f64| {
        let distance = length(&p);
        if distance < *limit {
            *limit = distance;
            let point = BorderPoint {
                curve: piece.curve,
                t: piece.parameter(s),
                xi: p,
                distance,
            };
            best = Some((s, point));
        }
    };
    offer(0.0, piece.from, &mut limit);
    offer(1.0, piece.to, &mut limit);
    let mut stack = [([0.0, 1.0], piece.from, piece.to); STACK];
    let mut top = 1;
    let mut steps = 0;
    while top > 0 {
        top -= 1;
        let ([a, b], from, to) = stack[top];
        if bound(&from, &to) >= limit * (1.0 - CLOSE) || b - a < 1e-14 || steps > 1000 {
            continue;
        }
        steps += 1;
        // The foot on the chord, or the middle.
        let (u, v) = (off(&from), off(&to));
        let d = [v[0] - u[0], v[1] - u[1]];
        let share = -(u[0] * d[0] + u[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let share = if share > 0.01 && share < 0.99 {
            share
        } else {
            0.5
        };
        let s = a + share * (b - a);
        let p = piece.point(s);
        offer(s, p, &mut limit);
        if top + 2 <= STACK {
            let halves = [([a, s], from, p), ([s, b], p, to)];
            let nearer = usize::from(bound(&p, &to) < bound(&from, &p));
            stack[top] = halves[1 - nearer];
            stack[top + 1] = halves[nearer];
            top += 2;
        }
    }
    best
}

/// The minimum next to a point of a piece: Gauss-Newton steps, halved where they lead too far.
fn downhill(
    piece: &Monotone,
    xi: Point,
    scale: [f64; 2],
    mut s: f64,
    mut point: BorderPoint,
) -> BorderPoint {
    let off = |p: &Point| [0, 1].map(|k| (p[k] - xi[k]) / scale[k]);
    for _ in 0..50 {
        let (p, d) = piece.tangent(s);
        let (d0, d) = (off(&p), [0, 1].map(|k| d[k] / scale[k]));
        let mut step = -(d0[0] * d[0] + d0[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let mut moved = false;
        for _ in 0..20 {
            let next = (s + step).clamp(0.0, 1.0);
            if next == s || !next.is_finite() {
                break;
            }
            let p = piece.point(next);
            let [a, b] = off(&p);
            let distance = (a * a + b * b).sqrt();
            if distance < point.distance {
                (s, moved) = (next, true);
                point = BorderPoint {
                    t: piece.parameter(s),
                    xi: p,
                    distance,
                    ..point
                };
                break;
            }
            step *= 0.5;
        }
        if !moved {
            break;
        }
    }
    point
}
