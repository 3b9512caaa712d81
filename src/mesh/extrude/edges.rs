//! The edges of a surface, and which elements share them.
use super::SurfaceError;
use super::surface::Surface;
use crate::mesh::raw::NONE;
use std::ops::Range;

/// An edge of one element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Row {
    /// Nodes, the smaller first.
    pub ends: [u32; 2],
    pub facet: u32,
    /// Edge of the facet: from corner `side` to the next one.
    pub side: u8,
    /// The facet runs through it from the smaller node to the larger.
    pub forward: bool,
}

/// All edges, sorted by their nodes.
pub(super) struct Edges {
    rows: Vec<Row>,
    /// First row of every edge, and the number of rows.
    starts: Vec<u32>,
}

/// The corners of a facet: three or four.
pub(super) fn corners(facet: &[u32; 4]) -> &[u32] {
    &facet[..if facet[3] == NONE { 3 } else { 4 }]
}

impl Edges {
    pub fn new(facets: &[[u32; 4]]) -> Edges {
        let mut rows = Vec::with_capacity(4 * facets.len());
        for (f, facet) in facets.iter().enumerate() {
            let corners = corners(facet);
            for (side, &a) in corners.iter().enumerate() {
                let b = corners[(side + 1) % corners.len()];
                rows.push(Row {
                    ends: [a.min(b), a.max(b)],
                    facet: f as u32,
                    side: side as u8,
                    forward: a < b,
                });
            }
        }
        rows.sort_unstable();
        let mut starts = vec![0];
        for (k, pair) in rows.windows(2).enumerate() {
            if pair[0].ends != pair[1].ends {
                starts.push(k as u32 + 1);
            }
        }
        if !rows.is_empty() {
            starts.push(rows.len() as u32);
        }
        Edges { rows, starts }
    }

    /// Number of edges.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The elements at an edge.
    pub fn rows(&self, edge: usize) -> &[Row] {
        &self.rows[self.starts[edge] as usize..self.starts[edge + 1] as usize]
    }

    /// All edges with the elements at them.
    pub fn all(&self) -> impl Iterator<Item = &[Row]> {
        (0..self.count()).map(|edge| self.rows(edge))
    }

    /// The edge between two nodes.
    pub fn find(&self, a: u32, b: u32) -> Option<usize> {
        let ends = [a.min(b), a.max(b)];
        let edge = self.starts[..self.count()]
            .partition_point(|&start| self.rows[start as usize].ends < ends);
        (edge < self.count() && self.rows(edge)[0].ends == ends).then_some(edge)
    }

    /// Edges whose smaller node is `node`.
    pub fn of_node(&self, node: u32) -> Range<usize> {
        let starts = &self.starts[..self.count()];
        let from = starts.partition_point(|&start| self.rows[start as usize].ends[0] < node);
        let here = |start: &u32| self.rows[*start as usize].ends[0] == node;
        from..from
            + starts[from..]
                .iter()
                .take_while(|start| here(start))
                .count()
    }

    /// Edges of one element only.
    pub fn border(&self) -> impl Iterator<Item = &Row> {
        self.all()
            .filter(|rows| rows.len() == 1)
            .map(|rows| &rows[0])
    }

    /// Every edge belongs to at most two elements, and no two elements have the same corners.
    pub fn check(&self, surface: &Surface) -> Result<(), SurfaceError> {
        for rows in self.all().filter(|rows| rows.len() > 1) {
            for (i, a) in rows.iter().enumerate() {
                // Neighbours in the table suffice: equal facets have equal edges everywhere.
                for b in rows[i + 1..].iter().take(8) {
                    let key = |f: u32| {
                        let mut key = surface.facets[f as usize];
                        key.sort_unstable();
                        key
                    };
                    if key(a.facet) == key(b.facet) {
                        return Err(SurfaceError::Twice {
                            elements: [a.facet, b.facet].map(|f| surface.tags[f as usize]),
                            position: surface.center(a.facet),
                        });
                    }
                }
            }
            if rows.len() > 2 {
                let [a, b] = rows[0].ends.map(|n| surface.nodes[n as usize]);
                return Err(SurfaceError::Branching {
                    elements: rows
                        .iter()
                        .map(|r| surface.tags[r.facet as usize])
                        .collect(),
                    position: ((a + b) * 0.5).into(),
                });
            }
        }
        Ok(())
    }

    /// Borders of the surface, each with its edges one after the other. Every node belongs to one fan of elements, so every
    /// border is closed.
    pub fn loops(&self, surface: &Surface) -> Vec<Vec<Row>> {
        let mut next = vec![NONE; surface.nodes.len()];
        let border: Vec<Row> = self.border().copied().collect();
        for (k, row) in border.iter().enumerate() {
            next[row.start() as usize] = k as u32;
        }
        let mut done = vec![false; border.len()];
        let mut loops = Vec::new();
        for first in 0..border.len() {
            let mut loop_ = Vec::new();
            let mut k = first;
            while !done[k] {
                done[k] = true;
                loop_.push(border[k]);
                match next[border[k].end() as usize] {
                    NONE => break,
                    following => k = following as usize,
                }
            }
            if !loop_.is_empty() {
                loops.push(loop_);
            }
        }
        loops
    }
}

impl Row {
    /// Where the facet enters the edge.
    pub fn start(&self) -> u32 {
        self.ends[usize::from(!self.forward)]
    }

    /// Where the facet leaves the edge.
    pub fn end(&self) -> u32 {
        self.ends[usize::from(self.forward)]
    }
}
