//! Slaves that end where their master does.
use super::super::Builder;
use super::super::supports::components;
use crate::mesh::Face;
use crate::model::edges;
use covact_geometry::{MovingFacets, Vec3};
use std::collections::HashSet;

/// Distance within the master's free border, and beside the master, up to which the slave ends with it, in terms of the distance of the
/// slave's nodes.
const FLUSH: f64 = 0.25;
const NEIGHBOUR: f64 = 1.0;
/// Cosine of the ways out of both from which on their borders go along with each other.
const ALONG: f64 = 0.9;
/// Cosine of the normals of faces up to which they face each other.
const FACING: f64 = -0.5;
/// Part of the way outwards along an axis from which on a support in it holds a node at a border.
const HELD: f64 = 0.5;
/// Area that nodes at such a border stand for, as a part of what faces the master, from which on it counts.
const COUNTS: f64 = 0.04;

impl Builder<'_> {
    /// Whether the slave ends where its master does, so that the nodes of its border stand near the master's. A node stands for half of the
    /// faces up to its neighbours, and where it slides past the master's border it loses them all, though most of them still lie on the
    /// master; what is soft and is squeezed widens, so that the nodes of its border do so one after the other.
    pub(super) fn ends_with(
        &self,
        (body, faces): (usize, &[Face]),
        master: &MovingFacets,
        size: f64,
    ) -> bool {
        let slave = &self.bodies[body];
        let place = |n: u32| self.nodes[(n + slave.first_node) as usize];
        // A foot of what lies in front of the master, as near as its next node, and faces it.
        let before = |x: &Vec3, normal: &Vec3| {
            let foot = master.project(x, None, f64::INFINITY, |_| true)?;
            let away = x - foot.jet.rho;
            let beside = away.cross(&foot.normal).norm();
            let near = away.dot(&foot.normal).abs() <= size && beside <= NEIGHBOUR * size;
            (near && normal.dot(&foot.normal) < FACING).then_some(foot)
        };
        let held = self.supported();
        let mut ends = 0.0;
        for (nodes, [normal, middle]) in edges::border(&slave.mesh, faces) {
            let [a, b] = nodes.map(place);
            let (at, along) = ((a + b) * 0.5, (b - a).normalize());
            let across = at - middle;
            let across = across - along * across.dot(&along);
            let (out, width) = (across.normalize(), across.norm());
            // Where supports hold it, as in a plane of symmetry, it stays where it is.
            let stays = (0..3).any(|c| {
                let held = |n: &u32| held.contains(&(n + slave.first_node, c as u32));
                out[c].abs() > HELD && nodes.iter().all(held)
            });
            // Past the border that it goes along with, not the end of the master beside it.
            let x = at + out * (FLUSH * size);
            let past = before(&x, &normal).is_some_and(|foot| {
                let away = x - foot.jet.rho;
                let beside = away - foot.normal * away.dot(&foot.normal);
                edges::at_border(&foot) && beside.dot(&out) > ALONG * beside.norm()
            });
            if past && !stays {
                ends += (b - a).norm() * width;
            }
        }
        let area = |face: &Face| {
            let (area, normal) = slave.mesh.face_area_normal(*face);
            let corners = slave.mesh.face_corners(*face).map(place);
            let middle = corners.iter().sum::<Vec3>() / 4.0;
            before(&middle, &normal).map_or(0.0, |_| area)
        };
        ends > 0.0 && ends > COUNTS * faces.iter().map(area).sum::<f64>()
    }

    /// Nodes and components that supports prescribe.
    fn supported(&self) -> HashSet<(u32, u32)> {
        let mut held = HashSet::new();
        for support in self.scene.supports.values() {
            let which = components(support);
            for (at, reference) in support.on.places("/supports") {
                // What is wrong with it is told where supports are made.
                let Ok((_, nodes)) = self.set_nodes(reference, &at) else {
                    continue;
                };
                let all = |node: u32| which.iter().map(move |(c, _)| (node, *c));
                held.extend(nodes.into_iter().flat_map(all));
            }
        }
        held
    }
}
