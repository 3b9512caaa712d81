//! New nodes in the middle of edges and elements: for triangles, which become quadrilaterals, and for quadratic elements.
use super::edges::{Edges, corners};
use super::surface::Surface;
use crate::mesh::raw::NONE;
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Nodes in the middle of edges and elements.
struct Middles<'e> {
    edges: &'e Edges,
    of_edge: Vec<u32>,
    of_facet: Vec<u32>,
}

/// Cuts every triangle into three quadrilaterals and every quadrilateral into four, from its centre to the middles of its
/// edges.
pub(super) fn split(surface: &mut Surface, edges: &Edges) {
    let mut middles = Middles {
        edges,
        of_edge: Vec::with_capacity(edges.count()),
        of_facet: Vec::with_capacity(surface.facets.len()),
    };
    for edge in 0..edges.count() {
        let [a, b] = edges.rows(edge)[0].ends.map(|n| surface.nodes[n as usize]);
        middles.of_edge.push(surface.add((a + b) * 0.5));
    }
    for f in 0..surface.facets.len() {
        let center = Vec3::from(surface.center(f as u32));
        middles.of_facet.push(surface.add(center));
    }
    let of_facets = middles.of_facets(surface.facets.len());
    let mut facets = Vec::new();
    let (mut tags, mut thickness, mut first) = (Vec::new(), Vec::new(), Vec::new());
    for (f, facet) in surface.facets.iter().enumerate() {
        first.push(facets.len() as u32);
        let corners = corners(facet);
        let last = corners.len() - 1;
        for (k, &corner) in corners.iter().enumerate() {
            let before = of_facets[f][if k == 0 { last } else { k - 1 }];
            facets.push([corner, of_facets[f][k], middles.of_facet[f], before]);
            tags.push(surface.tags[f]);
            thickness.push(surface.thickness[f]);
        }
    }
    first.push(facets.len() as u32);
    middles.grow_node_sets(surface);
    for set in surface.sets.values_mut() {
        let parts = |f: &u32| first[*f as usize]..first[*f as usize + 1];
        *set = set.iter().flat_map(parts).collect();
    }
    for set in surface.lines.values_mut() {
        *set = (set.iter())
            .flat_map(|&[a, b]| match edges.find(a, b) {
                Some(edge) => vec![[a, middles.of_edge[edge]], [middles.of_edge[edge], b]],
                None => vec![[a, b]],
            })
            .collect();
    }
    surface.facets = facets;
    surface.tags = tags;
    surface.thickness = thickness;
    surface.middles = Vec::new();
}

/// Gives every quadrilateral its nodes in the middle of edges and in its own. Those that the file has are kept; others lie
/// midway on straight edges, and in elements where the serendipity functions of eight nodes put their middle. Returns how
/// many nodes the file did not have.
pub(super) fn complete(surface: &mut Surface, edges: &Edges) -> usize {
    let count = surface.facets.len();
    surface.middles.resize(count, [NONE; 5]);
    let before = surface.nodes.len();
    let mut of_edge = Vec::with_capacity(edges.count());
    for edge in 0..edges.count() {
        let rows = edges.rows(edge);
        let given = (rows.iter())
            .map(|row| surface.middles[row.facet as usize][row.side as usize])
            .find(|n| *n != NONE);
        let node = given.unwrap_or_else(|| {
            let [a, b] = rows[0].ends.map(|n| surface.nodes[n as usize]);
            surface.add((a + b) * 0.5)
        });
        of_edge.push(node);
        for row in rows {
            let own = &mut surface.middles[row.facet as usize][row.side as usize];
            if *own == NONE {
                *own = node;
            }
        }
    }
    for f in 0..count {
        if surface.middles[f][4] == NONE {
            let sum =
                |nodes: &[u32]| -> Vec3 { nodes.iter().map(|&n| surface.nodes[n as usize]).sum() };
            let middle = sum(&surface.middles[f][..4]) * 0.5 - sum(&surface.facets[f]) * 0.25;
            surface.middles[f][4] = surface.add(middle);
        }
    }
    let middles = Middles {
        edges,
        of_edge,
        of_facet: surface.middles.iter().map(|m| m[4]).collect(),
    };
    middles.grow_node_sets(surface);
    surface.nodes.len() - before
}

impl Middles<'_> {
    /// Middle nodes of the edges of every facet.
    fn of_facets(&self, facets: usize) -> Vec<[u32; 4]> {
        let mut out = vec![[NONE; 4]; facets];
        for edge in 0..self.edges.count() {
            for row in self.edges.rows(edge) {
                out[row.facet as usize][row.side as usize] = self.of_edge[edge];
            }
        }
        out
    }

    /// Adds the new nodes to the node sets. A set of nodes on the border gets the middles of its border edges; one that
    /// also has nodes inside gets those of all its edges around elements whose corners it holds.
    fn grow_node_sets(&self, surface: &mut Surface) {
        let mut on_border = vec![false; surface.nodes.len()];
        for edge in 0..self.edges.count() {
            if let [row] = self.edges.rows(edge) {
                row.ends.iter().for_each(|&n| on_border[n as usize] = true);
                on_border[self.of_edge[edge] as usize] = true;
            }
        }
        let mut holds = vec![false; surface.nodes.len()];
        let mut sets = std::mem::take(&mut surface.node_sets);
        for set in sets.values_mut() {
            set.iter().for_each(|&n| holds[n as usize] = true);
            let mut more = Vec::new();
            let inner = set.iter().any(|&n| !on_border[n as usize]);
            let whole = |f: u32| {
                let corners = corners(&surface.facets[f as usize]);
                corners.iter().all(|&n| holds[n as usize])
            };
            // Found from the nodes of the set, so that many small sets stay cheap.
            for edge in set.iter().flat_map(|&n| self.edges.of_node(n)) {
                let rows = self.edges.rows(edge);
                if !holds[rows[0].ends[1] as usize] {
                    continue;
                }
                let before = more.len();
                if inner {
                    let whole = rows.iter().filter(|row| whole(row.facet));
                    more.extend(whole.map(|row| self.of_facet[row.facet as usize]));
                }
                if rows.len() == 1 || more.len() > before {
                    more.push(self.of_edge[edge]);
                }
            }
            set.iter().for_each(|&n| holds[n as usize] = false);
            set.extend(more);
        }
        surface.node_sets = sets;
    }
}

impl Surface {
    /// Adds a node that the file does not have.
    fn add(&mut self, x: Vec3) -> u32 {
        self.nodes.push(x);
        self.node_tags.push(0);
        self.nodes.len() as u32 - 1
    }

    /// Nodes of every element set and of every set of lines, added to the node sets of the same names.
    pub fn add_nodes_of_sets(&mut self) {
        let mut all: BTreeMap<String, Vec<u32>> = std::mem::take(&mut self.node_sets);
        for (name, set) in &self.sets {
            let nodes = all.entry(name.clone()).or_default();
            for &f in set {
                nodes.extend(corners(&self.facets[f as usize]));
                nodes.extend(self.middles.get(f as usize).into_iter().flatten());
            }
        }
        for (name, set) in &self.lines {
            all.entry(name.clone())
                .or_default()
                .extend(set.iter().flatten());
        }
        for nodes in all.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        self.node_sets = all;
    }
}
