//! Which facets meet at which edges and nodes.
//!
//! Edges of a facet: 0 is xi1 = -1, 1 is xi1 = +1, 2 is xi2 = -1, 3 is xi2 = +1. Corners: bit 0 set at xi1 = +1, bit 1 set
//! at xi2 = +1.

use std::collections::HashMap;

use super::{MovingError, heap};

/// Corners at the ends of the edges, in the direction of the parameter that runs along them.
pub(super) const ENDS: [[usize; 2]; 4] = [[0, 2], [1, 3], [0, 1], [2, 3]];
/// The two edges of every corner: along xi2 (an edge of fixed xi1), then along xi1.
pub(super) const EDGES_AT: [[usize; 2]; 4] = [[0, 2], [1, 2], [0, 3], [1, 3]];
/// +1 where the parameter along an edge goes round the facet counter-clockwise.
const SENSE: [i8; 4] = [-1, 1, 1, -1];

/// Lists of `(facet, edge or corner)`, one after the other.
#[derive(Debug, Clone, Default)]
struct Lists {
    first: Vec<u32>,
    members: Vec<(u32, u8)>,
}

impl Lists {
    /// From the list number of every `(facet, edge or corner)`, four a facet.
    fn new(of: &[[u32; 4]], count: usize) -> Self {
        let mut first = vec![0u32; count + 1];
        for &k in of.iter().flatten().filter(|&&k| k != NONE) {
            first[k as usize + 1] += 1;
        }
        for k in 0..count {
            first[k + 1] += first[k];
        }
        let mut next = first.clone();
        let mut members = vec![(0, 0); first[count] as usize];
        for (facet, own) in of.iter().enumerate() {
            for (k, &list) in own.iter().enumerate().filter(|(_, list)| **list != NONE) {
                let place = &mut next[list as usize];
                members[*place as usize] = (facet as u32, k as u8);
                *place += 1;
            }
        }
        Self { first, members }
    }

    fn get(&self, list: u32) -> &[(u32, u8)] {
        if list == NONE {
            return &[];
        }
        let k = list as usize;
        &self.members[self.first[k] as usize..self.first[k + 1] as usize]
    }
}

/// No edge: both ends are one node.
const NONE: u32 = u32::MAX;

#[derive(Debug, Clone, Default)]
pub(super) struct Topology {
    edge_of: Vec<[u32; 4]>,
    corner_of: Vec<[u32; 4]>,
    edges: Lists,
    corners: Lists,
    first_neighbour: Vec<u32>,
    neighbours: Vec<u32>,
    /// Facets and edges where the surface goes on without a common edge, ascending.
    joined: Vec<(u32, u8)>,
}

/// A facet as its boundary: corner nodes by corner number, and the middle nodes of its edges where it has some.
pub(super) struct Outline {
    pub corners: [u32; 4],
    pub middles: [Option<u32>; 4],
}

impl Topology {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        let Topology {
            edge_of,
            corner_of,
            edges,
            corners,
            first_neighbour,
            neighbours,
            joined,
        } = self;
        let lists = [edges, corners].map(|l| heap(&l.first) + heap(&l.members));
        let own = heap(edge_of)
            + heap(corner_of)
            + heap(first_neighbour)
            + heap(neighbours)
            + heap(joined);
        own + lists.iter().sum::<usize>()
    }

    /// Joins facets over common edges (same ends and, where there is one, the same middle node).
    ///
    /// # Errors
    /// [`MovingError::Flipped`] with numbers of outlines.
    pub fn new(facets: &[Outline]) -> Result<Self, MovingError> {
        let mut edges: HashMap<(u32, u32, Option<u32>), u32> = HashMap::new();
        let mut corners: HashMap<u32, u32> = HashMap::new();
        let mut out = Topology::default();
        for facet in facets {
            out.corner_of.push(facet.corners.map(|node| {
                let next = corners.len() as u32;
                *corners.entry(node).or_insert(next)
            }));
            out.edge_of.push(std::array::from_fn(|k| {
                let [a, b] = ENDS[k].map(|corner| facet.corners[corner]);
                if a == b {
                    return NONE;
                }
                let next = edges.len() as u32;
                let key = (a.min(b), a.max(b), facet.middles[k]);
                *edges.entry(key).or_insert(next)
            }));
        }
        out.edges = Lists::new(&out.edge_of, edges.len());
        // A node that is two corners of one facet is in its list twice; angles then add up as they should.
        out.corners = Lists::new(&out.corner_of, corners.len());
        for edge in 0..edges.len() as u32 {
            if let [a, b] = *out.edges.get(edge)
                && a.0 != b.0
            {
                let sense = [a, b].map(|(_, k)| SENSE[k as usize]);
                let reversed = out.reversed(a, b);
                if (sense[0] == sense[1]) != reversed {
                    return Err(MovingError::Flipped(a.0 as usize, b.0 as usize));
                }
            }
        }
        out.first_neighbour.push(0);
        let mut around = Vec::new();
        for (facet, corners) in out.corner_of.iter().enumerate() {
            around.clear();
            for &corner in corners {
                around.extend(out.corners.get(corner).iter().map(|m| m.0));
            }
            around.sort_unstable();
            around.dedup();
            around.retain(|&other| other as usize != facet);
            out.neighbours.extend_from_slice(&around);
            out.first_neighbour.push(out.neighbours.len() as u32);
        }
        Ok(out)
    }

    /// Says that the surface goes on beyond an edge of a facet, on facets that do not share it.
    pub fn join(&mut self, facet: usize, edge: usize) {
        let own = (facet as u32, edge as u8);
        if let Err(place) = self.joined.binary_search(&own) {
            self.joined.insert(place, own);
        }
    }

    /// Whether the surface goes on beyond an edge that no other facet shares.
    pub fn is_joined(&self, facet: u32, edge: usize) -> bool {
        self.joined.binary_search(&(facet, edge as u8)).is_ok()
    }

    pub fn neighbours(&self, facet: u32) -> &[u32] {
        let k = facet as usize;
        match (self.first_neighbour.get(k), self.first_neighbour.get(k + 1)) {
            (Some(&a), Some(&b)) => &self.neighbours[a as usize..b as usize],
            _ => &[],
        }
    }

    /// Facets with their edges at an edge of a facet, itself among them; none at an edge that is one node.
    #[inline]
    pub fn at_edge(&self, facet: u32, edge: usize) -> &[(u32, u8)] {
        self.edges.get(self.edge_of[facet as usize][edge])
    }

    /// Facets with their corners at a corner of a facet, itself among them.
    #[inline]
    pub fn at_corner(&self, facet: u32, corner: usize) -> &[(u32, u8)] {
        self.corners.get(self.corner_of[facet as usize][corner])
    }

    /// Whether an edge is one node.
    #[inline]
    pub fn is_point(&self, facet: u32, edge: usize) -> bool {
        self.edge_of[facet as usize][edge] == NONE
    }

    /// Whether the parameters of two facets run in opposite directions along their common edge.
    #[inline]
    pub fn reversed(&self, a: (u32, u8), b: (u32, u8)) -> bool {
        let start =
            |(facet, edge): (u32, u8)| self.corner_of[facet as usize][ENDS[edge as usize][0]];
        start(a) != start(b)
    }

    /// Number of the node at a corner.
    #[inline]
    pub fn node(&self, facet: u32, corner: usize) -> u32 {
        self.corner_of[facet as usize][corner]
    }

    /// Number of an edge of a facet; `None` where it is one node.
    pub fn edge(&self, facet: u32, edge: usize) -> Option<u32> {
        Some(self.edge_of[facet as usize][edge]).filter(|&k| k != NONE)
    }

    /// Facets with their edges at an edge by its number.
    pub fn edge_members(&self, edge: u32) -> &[(u32, u8)] {
        self.edges.get(edge)
    }

    pub fn edge_count(&self) -> usize {
        self.edges.first.len() - 1
    }

    pub fn facet_count(&self) -> usize {
        self.edge_of.len()
    }

    /// Number of the nodes that are corners.
    pub fn node_count(&self) -> usize {
        self.corners.first.len() - 1
    }

    /// Facets with their corners at a node.
    pub fn at_node(&self, node: u32) -> &[(u32, u8)] {
        self.corners.get(node)
    }
}

/// Parameters of a point of an edge, `s` along it.
#[inline]
pub(super) fn on_edge(edge: usize, s: f64) -> [f64; 2] {
    match edge {
        0 => [-1.0, s],
        1 => [1.0, s],
        2 => [s, -1.0],
        _ => [s, 1.0],
    }
}

/// Parameters of a corner.
#[inline]
pub(super) fn corner_xi(corner: usize) -> [f64; 2] {
    [corner & 1, corner >> 1].map(|k| 2.0 * k as f64 - 1.0)
}
