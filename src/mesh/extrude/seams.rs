//! Nodes of a surface at the same place: borders that touch, but are not joined.
use super::SurfaceError;
use super::edges::{Edges, corners};
use super::surface::Surface;
use crate::mesh::check::close_pairs;
use crate::mesh::raw::{KEPT_APART, SLITS};
use crate::mesh::topology::root;

/// Refuses borders of one part that touch, unless they are `meant` as slits: the body would gape there, and nothing else would
/// tell, because its sides go apart along different normals. Parts that touch each other stay apart, which `notes` tells: they may
/// be partners in contact.
pub(super) fn check(
    surface: &Surface,
    edges: &Edges,
    meant: bool,
    notes: &mut Vec<String>,
) -> Result<(), SurfaceError> {
    let length = |ends: [u32; 2]| {
        let [a, b] = ends.map(|n| surface.nodes[n as usize]);
        (b - a).norm()
    };
    let lengths = edges.all().map(|rows| length(rows[0].ends));
    let shortest = lengths.fold(f64::INFINITY, f64::min);
    // Edges without a length are told with their elements.
    if shortest == 0.0 || !shortest.is_finite() {
        return Ok(());
    }
    let pairs = close_pairs(&surface.nodes, shortest);
    if pairs.is_empty() {
        return Ok(());
    }
    let mut parent: Vec<u32> = (0..surface.nodes.len() as u32).collect();
    for (f, facet) in surface.facets.iter().enumerate() {
        let first = root(&mut parent, facet[0]);
        let middles = surface.middles.get(f).into_iter().flatten();
        for &node in corners(facet).iter().chain(middles) {
            if (node as usize) < parent.len() {
                let other = root(&mut parent, node);
                parent[other as usize] = first;
            }
        }
    }
    let mut joined = |pair: &&[u32; 2]| root(&mut parent, pair[0]) == root(&mut parent, pair[1]);
    let slits: Vec<&[u32; 2]> = pairs.iter().filter(|pair| joined(pair)).collect();
    match slits.first() {
        Some(_) if meant => {
            notes.push(format!("{} {SLITS}", slits.len()));
            if pairs.len() > slits.len() {
                notes.push(format!("{} {KEPT_APART}", pairs.len() - slits.len()));
            }
            Ok(())
        }
        Some(&&[a, b]) => Err(SurfaceError::Unjoined {
            nodes: [a, b].map(|n| surface.node_tags[n as usize]),
            position: surface.nodes[a as usize].into(),
            count: slits.len(),
        }),
        None => {
            notes.push(format!("{} {KEPT_APART}", pairs.len()));
            Ok(())
        }
    }
}
