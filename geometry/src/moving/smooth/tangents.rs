//! Tangents of the edges at their ends.

use super::fit::{fit, in_plane};
use super::lines::central;
use super::sectors::{Sector, Spoke};
use super::{CREASE, Combination, Mesh};
use crate::moving::topology::ENDS;

/// Lines that turn by more than this within the surface at a node (radians, 15 degrees) do not run on through it: the
/// parabola through three such nodes is a poor curve of the surface, and finer meshes would be no better there.
const KINK: f64 = std::f64::consts::PI / 12.0;

/// How the tangent of an edge at one of its ends came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rule {
    /// From the parabola through the nodes on both sides; the edge on the other side.
    Central(Spoke),
    /// From the parabola through the next two nodes; the edge behind the first.
    OneSided(Spoke),
    /// The chord.
    Chord,
    /// From a tangent plane.
    Plane,
}

/// Tangents of all edges at both ends, pointing into the edge, for a parameter that grows by 1 along it.
pub(super) struct Tangents {
    /// `[edge][end]`, ends in ascending order of nodes.
    of: Vec<[Option<(Rule, Combination)>; 2]>,
    zero: Combination,
}

impl Tangents {
    pub fn new(mesh: &Mesh) -> Self {
        let mut out = Self {
            of: vec![[None, None]; mesh.hard.len()],
            zero: Combination::default(),
        };
        let count = mesh.topology.node_count() as u32;
        let all: Vec<Vec<Sector>> = (0..count).map(|node| mesh.sectors(node)).collect();
        for (node, sectors) in all.iter().enumerate() {
            out.central(mesh, node as u32, sectors, &all);
        }
        // What lines that end here take over from their next nodes is central there.
        let mut ends = Vec::new();
        for (node, sectors) in all.iter().enumerate() {
            out.last_of_lines(mesh, node as u32, sectors, &mut ends);
        }
        for (edge, end, rule, tangent) in ends.drain(..) {
            out.of[edge as usize][end] = Some((rule, tangent));
        }
        for (node, sectors) in all.iter().enumerate() {
            for sector in sectors {
                out.planes(mesh, node as u32, sector);
            }
        }
        out
    }

    /// Tangent of edge `edge` of a facet at its end at `corner`; zero for an edge that is one node.
    pub fn of(&self, mesh: &Mesh, facet: u32, edge: usize, corner: usize) -> &Combination {
        self.at(mesh, facet, edge, corner)
            .map_or(&self.zero, |t| &t.1)
    }

    /// How it came about.
    pub fn rule(&self, mesh: &Mesh, facet: u32, edge: usize, corner: usize) -> Rule {
        self.at(mesh, facet, edge, corner)
            .map_or(Rule::Plane, |t| t.0)
    }

    fn at(
        &self,
        mesh: &Mesh,
        facet: u32,
        edge: usize,
        corner: usize,
    ) -> Option<&(Rule, Combination)> {
        let number = mesh.topology.edge(facet, edge)?;
        let other = ENDS[edge][usize::from(ENDS[edge][0] == corner)];
        let end = end(mesh.node(facet, corner), mesh.node(facet, other));
        self.of[number as usize][end].as_ref()
    }

    fn set(&mut self, node: u32, spoke: Spoke, rule: Rule, tangent: Combination) {
        let place = &mut self.of[spoke.edge as usize][end(node, spoke.to)];
        if place.is_none() {
            *place = Some((rule, tangent));
        }
    }

    /// Edges of lines that run on through a node, and of nodes inside the surface where they do not.
    fn central(&mut self, mesh: &Mesh, node: u32, sectors: &[Sector], all: &[Vec<Sector>]) {
        if let Some([a, b]) = running_on(mesh, node, sectors) {
            for (own, other) in [(a, b), (b, a)] {
                self.set(
                    node,
                    own,
                    Rule::Central(other),
                    through(mesh, node, own, other),
                );
            }
        }
        for sector in sectors.iter().filter(|s| s.hard.is_empty()) {
            if sector.is_regular() {
                for &own in &sector.soft {
                    let other = opposite(mesh, sector, own);
                    if let Some(other) = other.filter(|o| runs_on(mesh, all, node, own, *o)) {
                        let tangent = through(mesh, node, own, other);
                        self.set(node, own, Rule::Central(other), tangent);
                    }
                }
            }
            self.planes(mesh, node, sector);
        }
    }

    /// Edges of lines that end at a node: sharp edges and borders, and what leaves a straight border between two facets.
    fn last_of_lines(
        &self,
        mesh: &Mesh,
        node: u32,
        sectors: &[Sector],
        out: &mut Vec<(u32, usize, Rule, Combination)>,
    ) {
        let straight = running_on(mesh, node, sectors).is_some();
        for sector in sectors {
            let soft = sector.soft.iter();
            let simple = straight && sector.corners.len() == 2 && !sector.pole;
            let soft = soft.filter(|_| simple && !sector.hard.is_empty());
            for spoke in sector.hard.iter().chain(soft) {
                let own = end(node, spoke.to);
                if self.of[spoke.edge as usize][own].is_some() {
                    continue;
                }
                let chord = [(spoke.to, 1.0), (node, -1.0)];
                let (rule, tangent) = match &self.of[spoke.edge as usize][1 - own] {
                    Some((rule, there)) => {
                        let mut tangent = Combination::of(&chord).scaled(2.0);
                        tangent.add(there, 1.0);
                        match rule {
                            Rule::Central(next) => (Rule::OneSided(*next), tangent),
                            _ => (Rule::Plane, tangent),
                        }
                    }
                    None => (Rule::Chord, Combination::of(&chord)),
                };
                out.push((spoke.edge, own, rule, tangent));
            }
        }
    }

    /// Edges that have no tangent yet, in the plane of those that have or of a fit.
    fn planes(&mut self, mesh: &Mesh, node: u32, sector: &Sector) {
        let open = |s: &&Spoke| self.of[s.edge as usize][end(node, s.to)].is_none();
        let left: Vec<Spoke> = sector.soft.iter().filter(open).copied().collect();
        if left.is_empty() {
            return;
        }
        let borders: Vec<Combination> = (sector.hard.iter().chain(&sector.soft))
            .filter_map(|s| self.of[s.edge as usize][end(node, s.to)].clone())
            .map(|t| t.1)
            .collect();
        let fit = fit(mesh, node, sector);
        for spoke in left {
            let chord = mesh.point(spoke.to) - mesh.point(node);
            let plane = |a: &Combination, b: &Combination| in_plane(&mesh.points, [a, b], &chord);
            let by_borders = match &borders[..] {
                [a, .., b] => plane(a, b),
                _ => None,
            };
            let by_fit = || {
                let fit = fit.as_ref()?;
                let Some(border) = borders.first() else {
                    return plane(&fit.tangents[0], &fit.tangents[1]);
                };
                // Across the border, in the plane of the fit.
                let along = border.on(&mesh.points);
                let [x, y] = fit.axes.map(|axis| axis.dot(&along));
                let mut across = fit.tangents[0].scaled(-y);
                across.add(&fit.tangents[1], x);
                plane(border, &across).or_else(|| plane(&fit.tangents[0], &fit.tangents[1]))
            };
            let tangent = by_borders.or_else(by_fit).and_then(|t| {
                // As long as the chord: what the projection on the plane takes away is not missing in the edge.
                let length = t.on(&mesh.points).norm();
                (length > 0.1 * chord.norm()).then(|| t.scaled(chord.norm() / length))
            });
            let (rule, tangent) = match tangent {
                Some(tangent) => (Rule::Plane, tangent),
                None => (
                    Rule::Chord,
                    Combination::of(&[(spoke.to, 1.0), (node, -1.0)]),
                ),
            };
            self.set(node, spoke, rule, tangent);
        }
    }
}

/// Which end of an edge a node is.
fn end(node: u32, other: u32) -> usize {
    usize::from(node > other)
}

/// Tangent of the parabola through the ends of two edges that meet at a node, along the first.
fn through(mesh: &Mesh, node: u32, own: Spoke, other: Spoke) -> Combination {
    let [before, at, behind] = central(mesh.ratio(other.edge, own.edge));
    Combination::of(&[(node, at), (own.to, behind), (other.to, before)])
}

/// The two sharp edges or borders that run through a node as one line.
fn running_on(mesh: &Mesh, node: u32, sectors: &[Sector]) -> Option<[Spoke; 2]> {
    let mut hard: Vec<Spoke> = Vec::new();
    for spoke in sectors.iter().flat_map(|s| &s.hard) {
        if !hard.contains(spoke) {
            hard.push(*spoke);
        }
    }
    let [a, b] = *hard.first_chunk::<2>().filter(|_| hard.len() == 2)?;
    // A facet alone between them would have no angle.
    if sectors
        .iter()
        .any(|s| !s.hard.is_empty() && s.corners.len() < 2)
    {
        return None;
    }
    let [u, v] = [a, b].map(|s| mesh.point(s.to) - mesh.point(node));
    (u.cross(&v).norm().atan2(-u.dot(&v)) <= CREASE).then_some([a, b])
}

/// Whether a line runs on through a regular node: it hardly turns there within the surface, or hardly more than at the next
/// nodes of the line, where it is merely a coarse curve.
fn runs_on(mesh: &Mesh, all: &[Vec<Sector>], node: u32, own: Spoke, other: Spoke) -> bool {
    let regular = |node: u32| match &all[node as usize][..] {
        [sector] if sector.is_regular() => Some(sector),
        _ => None,
    };
    let next = |spoke: Spoke| {
        let sector = regular(spoke.to)?;
        let back = Spoke { to: node, ..spoke };
        Some(turn(
            mesh,
            spoke.to,
            sector,
            back,
            opposite(mesh, sector, back)?,
        ))
    };
    let Some(sector) = regular(node) else {
        return false;
    };
    let here = turn(mesh, node, sector, own, other);
    let coarse = || {
        [own, other]
            .into_iter()
            .filter_map(next)
            .any(|next| here <= 1.5 * next)
    };
    here <= KINK || coarse()
}

/// Angle by which a line turns at a node within the surface (radians, on the reference positions).
fn turn(mesh: &Mesh, node: u32, sector: &Sector, own: Spoke, other: Spoke) -> f64 {
    let normal = mesh.normal_around(node, sector);
    let [u, v] = [own, other].map(|s| mesh.point(s.to) - mesh.point(node));
    let length2 = normal.norm_squared().max(f64::MIN_POSITIVE);
    let [u, v] = [u, v].map(|u| u - normal * (u.dot(&normal) / length2));
    u.cross(&v).norm().atan2(-u.dot(&v))
}

/// The edge on the other side of a regular node: the one that shares no facet with it.
fn opposite(mesh: &Mesh, sector: &Sector, own: Spoke) -> Option<Spoke> {
    let beside = |spoke: &Spoke| {
        sector.corners.iter().any(|&(facet, corner)| {
            let spokes = mesh.spokes(facet, corner as usize);
            spokes.contains(&Some(own)) && spokes.contains(&Some(*spoke))
        })
    };
    let mut others = sector.soft.iter().filter(|s| **s != own && !beside(s));
    let found = others.next().copied();
    if others.next().is_some() { None } else { found }
}
