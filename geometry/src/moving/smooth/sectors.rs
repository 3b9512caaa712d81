//! What meets at a node: facets in sectors that sharp edges and borders part.

use super::Mesh;
use crate::moving::topology::{EDGES_AT, ENDS};
use crate::surface::Vec3;

/// An edge as it leaves a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spoke {
    pub edge: u32,
    /// The node at its other end.
    pub to: u32,
}

/// Facets around a node between which the surface is smooth.
#[derive(Debug, Clone, Default)]
pub(super) struct Sector {
    /// Facets with their corners at the node.
    pub corners: Vec<(u32, u8)>,
    /// Smooth edges.
    pub soft: Vec<Spoke>,
    /// Sharp edges and borders: none, or the two that end the sector.
    pub hard: Vec<Spoke>,
    /// Whether a facet has two corners here.
    pub pole: bool,
}

impl Sector {
    /// Whether four facets meet all around.
    pub fn is_regular(&self) -> bool {
        self.corners.len() == 4 && self.hard.is_empty() && self.soft.len() == 4 && !self.pole
    }
}

impl Mesh {
    /// The two spokes of a corner of a facet, along xi2 and along xi1; `None` for an edge that is one node.
    pub(super) fn spokes(&self, facet: u32, corner: usize) -> [Option<Spoke>; 2] {
        EDGES_AT[corner].map(|edge| {
            let [a, b] = ENDS[edge];
            let to = self.node(facet, if a == corner { b } else { a });
            Some(Spoke {
                edge: self.topology.edge(facet, edge)?,
                to,
            })
        })
    }

    /// Mean normal of the facets of a sector at its node, weighted with their angles; not normalised.
    pub(super) fn normal_around(&self, node: u32, sector: &Sector) -> Vec3 {
        let origin = self.point(node);
        let mut sum = Vec3::zeros();
        for &(facet, corner) in &sector.corners {
            let corner = corner as usize;
            let off = |c: usize| self.point(self.node(facet, c)) - origin;
            // At the tip of a triangle one of both is the node itself.
            let leg = |c: usize| {
                if self.node(facet, c) == node {
                    off(corner ^ 3)
                } else {
                    off(c)
                }
            };
            let (a, b) = (leg(corner ^ 1), leg(corner ^ 2));
            // The sign makes it rho_1 x rho_2 whatever the corner.
            let sign = if corner == 0 || corner == 3 {
                1.0
            } else {
                -1.0
            };
            let cross = a.cross(&b);
            let angle = cross.norm().atan2(a.dot(&b));
            sum += cross.try_normalize(0.0).unwrap_or_else(Vec3::zeros) * (sign * angle);
        }
        sum
    }

    /// Sectors of a node.
    pub(super) fn sectors(&self, node: u32) -> Vec<Sector> {
        let corners = self.topology.at_node(node);
        let mut group: Vec<usize> = (0..corners.len()).collect();
        let soft_edges = |k: usize| {
            let (facet, corner) = corners[k];
            let spokes = self.spokes(facet, corner as usize).into_iter().flatten();
            spokes.filter(|s| !self.hard[s.edge as usize])
        };
        // Few meet at a node: everything with everything else.
        for a in 0..corners.len() {
            for b in 0..a {
                let joined = corners[a].0 == corners[b].0
                    || soft_edges(a).any(|s| soft_edges(b).any(|t| s.edge == t.edge));
                if joined && group[a] != group[b] {
                    let (from, to) = (group[a], group[b]);
                    group
                        .iter_mut()
                        .filter(|g| **g == from)
                        .for_each(|g| *g = to);
                }
            }
        }
        let mut out: Vec<(usize, Sector)> = Vec::new();
        for (k, &(facet, corner)) in corners.iter().enumerate() {
            if out.iter().all(|s| s.0 != group[k]) {
                out.push((group[k], Sector::default()));
            }
            let Some((_, sector)) = out.iter_mut().find(|s| s.0 == group[k]) else {
                continue;
            };
            sector.pole |= sector.corners.iter().any(|c| c.0 == facet);
            sector.corners.push((facet, corner));
            for spoke in self.spokes(facet, corner as usize) {
                let Some(spoke) = spoke else {
                    sector.pole = true;
                    continue;
                };
                let list = if self.hard[spoke.edge as usize] {
                    &mut sector.hard
                } else {
                    &mut sector.soft
                };
                if !list.contains(&spoke) {
                    list.push(spoke);
                }
            }
        }
        out.into_iter().map(|s| s.1).collect()
    }
}
