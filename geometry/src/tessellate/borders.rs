//! Edges as polylines whose nodes joined edges share.

use crate::project::PatchSet;
use crate::project::topology::{Edge, EdgeCurve, edge_point, nearest_on_edge};
use crate::surface::{Surface, Vec3};

/// Chords are halved no more often than this.
const DEPTH: u32 = 16;
/// Parts of an edge that is one point in space.
const POLE: usize = 16;
/// Nodes nearer than this share of the tolerance are one.
const SAME: f64 = 0.02;

/// A node on an edge.
#[derive(Debug, Clone, Copy)]
struct Mark {
    t: f64,
    node: u32,
}

/// The nodes of all edges, and those that are added inside of patches.
pub struct Borders {
    positions: Vec<Vec3>,
    /// Nodes that were found to be the same point have one root.
    parents: Vec<u32>,
    /// The nodes of every edge by parameter.
    marks: Vec<Vec<Mark>>,
    /// Largest distance of an edge from its chords.
    pub deviation: f64,
}

impl Borders {
    pub fn of<S: Surface>(set: &PatchSet<S>, tolerance: f64) -> Self {
        let edges = &set.topology.edges;
        let mut borders = Self {
            positions: Vec::new(),
            parents: Vec::new(),
            marks: Vec::with_capacity(edges.len()),
            deviation: 0.0,
        };
        for edge in edges {
            let [a, b] = edge.interval;
            let ends = [a, b].map(|t| Mark {
                t,
                node: borders.add(edge_point(set, edge, t).jet.rho),
            });
            borders.marks.push(ends.to_vec());
        }
        for patch in 0..set.patches().len() as u32 {
            borders.join_corners(set, patch);
        }
        for number in 0..edges.len() {
            borders.inherit(set, number, tolerance);
            let new = borders.refine(set, number, tolerance);
            borders.hand_back(set, number, &new, tolerance);
        }
        borders
    }

    /// Adds a node.
    pub fn add(&mut self, x: Vec3) -> u32 {
        self.positions.push(x);
        self.parents.push(self.parents.len() as u32);
        self.parents.len() as u32 - 1
    }

    pub fn root(&mut self, mut node: u32) -> u32 {
        while self.parents[node as usize] != node {
            let above = self.parents[self.parents[node as usize] as usize];
            self.parents[node as usize] = above;
            node = above;
        }
        node
    }

    /// The root of a node without shortening the way to it.
    pub fn root_of(&self, mut node: u32) -> u32 {
        while self.parents[node as usize] != node {
            node = self.parents[node as usize];
        }
        node
    }

    /// Where a node is.
    pub fn position(&self, node: u32) -> Vec3 {
        self.positions[node as usize]
    }

    /// Makes two nodes one, where the older of the two is.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The ends of edges that follow each other around a patch are one node.
    fn join_corners<S: Surface>(&mut self, set: &PatchSet<S>, patch: u32) {
        let first = set.topology.first[patch as usize];
        let edges = set.topology.of(patch);
        let end = |borders: &Self, edge: usize, last: bool| {
            let marks = &borders.marks[first + edge];
            marks[if last { marks.len() - 1 } else { 0 }].node
        };
        match edges.first().map(|e| e.curve) {
            Some(EdgeCurve::Side { .. }) => {
                // Sides xi1 = start, xi1 = end, xi2 = start, xi2 = end.
                for (a, b) in [
                    ((0, false), (2, false)),
                    ((0, true), (3, false)),
                    ((1, false), (2, true)),
                    ((1, true), (3, true)),
                ] {
                    let (a, b) = (end(self, a.0, a.1), end(self, b.0, b.1));
                    self.join(a, b);
                }
            }
            Some(EdgeCurve::Trim { .. }) => {
                let a_loop = |k: usize| match edges[k].curve {
                    EdgeCurve::Trim { a_loop, .. } => a_loop,
                    EdgeCurve::Side { .. } => 0,
                };
                let mut start = 0;
                for k in 0..edges.len() {
                    let last = k + 1 == edges.len() || a_loop(k + 1) != a_loop(k);
                    let next = if last { start } else { k + 1 };
                    let (a, b) = (end(self, k, true), end(self, next, false));
                    self.join(a, b);
                    start = if last { k + 1 } else { start };
                }
            }
            None => {}
        }
        for (k, edge) in edges.iter().enumerate() {
            if edge.kind.is_none() {
                let (a, b) = (end(self, k, false), end(self, k, true));
                self.join(a, b);
            }
        }
    }

    /// Puts a node of a joined edge where it lies on edge `number`, within `part` of it.
    fn place<S: Surface>(
        &mut self,
        set: &PatchSet<S>,
        number: usize,
        node: u32,
        (part, reach): ([f64; 2], f64),
        tolerance: f64,
    ) {
        let edge = &set.topology.edges[number];
        let x = self.position(self.root_of(node));
        let foot = nearest_on_edge(set, &x, edge);
        let margin = edge.margin(reach);
        let inside = foot.t >= part[0] - margin && foot.t <= part[1] + margin;
        if !inside || (foot.jet.rho - x).norm() > 2.0 * reach {
            return;
        }
        let same = SAME * tolerance + reach;
        let marks = &self.marks[number];
        let at = marks.partition_point(|m| m.t < foot.t);
        let beside = [at.checked_sub(1), (at < marks.len()).then_some(at)];
        let near = beside
            .into_iter()
            .flatten()
            .find(|&k| (edge_point(set, edge, marks[k].t).jet.rho - foot.jet.rho).norm() <= same);
        // A closed edge begins where it ends.
        match near {
            Some(k) => {
                let known = marks[k].node;
                self.join(known, node);
            }
            None => self.marks[number].insert(at, Mark { t: foot.t, node }),
        }
    }

    /// Takes the nodes of the joined edges that were cut before.
    fn inherit<S: Surface>(&mut self, set: &PatchSet<S>, number: usize, tolerance: f64) {
        let edge = &set.topology.edges[number];
        for link in &edge.links {
            // Nodes of later edges are their ends so far, which may lie within this one.
            let nodes: Vec<u32> = self.marks[link.edge].iter().map(|m| m.node).collect();
            for node in nodes {
                self.place(set, number, node, (link.own, link.reach), tolerance);
            }
        }
    }

    /// Cuts an edge until its chords keep to it, in space and in the parameter plane; the nodes that were added.
    fn refine<S: Surface>(&mut self, set: &PatchSet<S>, number: usize, tolerance: f64) -> Vec<u32> {
        let edge = &set.topology.edges[number];
        let mut new = Vec::new();
        if edge.kind.is_none() {
            let node = self.marks[number][0].node;
            let [a, b] = edge.interval;
            let inner = (1..POLE).map(|k| a + (b - a) * k as f64 / POLE as f64);
            self.marks[number].extend(inner.map(|t| Mark { t, node }));
            self.marks[number].sort_by(|a, b| a.t.total_cmp(&b.t));
            return new;
        }
        let given = std::mem::take(&mut self.marks[number]);
        let mut out = Vec::with_capacity(given.len());
        for pair in given.windows(2) {
            out.push(pair[0]);
            self.cut(
                set,
                edge,
                [pair[0].t, pair[1].t],
                tolerance,
                0,
                &mut |borders, t, x| {
                    let node = borders.add(x);
                    new.push(node);
                    out.push(Mark { t, node });
                },
            );
        }
        out.extend(given.last());
        self.marks[number] = out;
        new
    }

    /// Halves a part of an edge for as long as its chord leaves it.
    fn cut<S: Surface>(
        &mut self,
        set: &PatchSet<S>,
        edge: &Edge,
        [a, b]: [f64; 2],
        tolerance: f64,
        depth: u32,
        add: &mut dyn FnMut(&mut Self, f64, Vec3),
    ) {
        let surface = &set.patches()[edge.patch as usize];
        let [from, to] = [a, b].map(|t| edge_point(set, edge, t));
        let chord = to.jet.rho - from.jet.rho;
        let whole = a == edge.interval[0] && b == edge.interval[1];
        let mut off = 0.0f64;
        let mut along = 0.0f64;
        for s in [0.25, 0.5, 0.75] {
            let point = edge_point(set, edge, a + s * (b - a)).jet.rho;
            let d = point - from.jet.rho;
            let share = (d.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
            let share = if share.is_finite() { share } else { 0.0 };
            off = off.max((d - chord * share).norm());
            // A straight line in space need not be one in the parameter plane.
            let xi = [0, 1].map(|k| from.xi[k] + s * (to.xi[k] - from.xi[k]));
            along = along.max((surface.point(xi) - point).norm());
        }
        // One chord is not enough for an edge that bends: the triangle of both its ends may be any.
        let bent = whole && off > 1e-3 * tolerance && edge.length > tolerance;
        if depth >= DEPTH || (off <= 0.5 * tolerance && along <= tolerance && !bent) {
            self.deviation = self.deviation.max(off);
            return;
        }
        let middle = 0.5 * (a + b);
        let x = edge_point(set, edge, middle).jet.rho;
        self.cut(set, edge, [a, middle], tolerance, depth + 1, add);
        add(self, middle, x);
        self.cut(set, edge, [middle, b], tolerance, depth + 1, add);
    }

    /// Gives new nodes of an edge to the joined edges that were cut before.
    fn hand_back<S: Surface>(
        &mut self,
        set: &PatchSet<S>,
        number: usize,
        new: &[u32],
        tolerance: f64,
    ) {
        let edges = &set.topology.edges;
        for link in &edges[number].links {
            if link.edge > number {
                continue;
            }
            let back = edges[link.edge].links.iter().filter(|l| l.edge == number);
            for own in back.map(|l| (l.own, l.reach)) {
                for &node in new {
                    self.place(set, link.edge, node, own, tolerance);
                }
            }
        }
    }

    /// The border of a patch as closed polygons of parameters and nodes.
    pub fn polygons<S: Surface>(&self, set: &PatchSet<S>, patch: u32) -> Vec<Vec<([f64; 2], u32)>> {
        let first = set.topology.first[patch as usize];
        let edges = set.topology.of(patch);
        let line = |k: usize, backwards: bool| {
            let edge = &edges[k];
            let mut line: Vec<_> = self.marks[first + k]
                .iter()
                .map(|m| (edge_point(set, edge, m.t).xi, m.node))
                .collect();
            if backwards {
                line.reverse();
            }
            // The last node begins the next edge.
            line.pop();
            line
        };
        let mut out: Vec<Vec<([f64; 2], u32)>> = Vec::new();
        let mut last = None;
        for (k, edge) in edges.iter().enumerate() {
            match edge.curve {
                EdgeCurve::Side { .. } => {
                    out = vec![
                        [(2, false), (1, false), (3, true), (0, true)]
                            .into_iter()
                            .flat_map(|(k, backwards)| line(k, backwards))
                            .collect(),
                    ];
                    break;
                }
                EdgeCurve::Trim { a_loop, .. } => {
                    if last != Some(a_loop) {
                        out.push(Vec::new());
                        last = Some(a_loop);
                    }
                    if let Some(polygon) = out.last_mut() {
                        polygon.extend(line(k, false));
                    }
                }
            }
        }
        out
    }
}
