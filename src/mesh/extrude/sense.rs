//! One sense of rotation for all elements, so that all normals point to the same side.
use super::SurfaceError;
use super::edges::Edges;
use super::surface::Surface;
use crate::mesh::raw::NONE;

/// Turns the elements that look against the others of their part; where both senses are there, the more frequent one is
/// kept. Returns how many were turned.
pub(super) fn unify(surface: &mut Surface, edges: &Edges) -> Result<usize, SurfaceError> {
    let mut beyond = vec![[NONE; 4]; surface.facets.len()];
    let mut against = vec![[false; 4]; surface.facets.len()];
    for rows in edges.all() {
        if let [a, b] = rows {
            for (one, other) in [(a, b), (b, a)] {
                beyond[one.facet as usize][one.side as usize] = other.facet;
                against[one.facet as usize][one.side as usize] = one.forward == other.forward;
            }
        }
    }
    // Whether each element turns if the first one of its part stays.
    let mut turned: Vec<Option<bool>> = vec![None; surface.facets.len()];
    let mut part = Vec::new();
    let mut total = 0;
    for first in 0..surface.facets.len() {
        if turned[first].is_some() {
            continue;
        }
        turned[first] = Some(false);
        part.clear();
        part.push(first as u32);
        let mut at = 0;
        while at < part.len() {
            let f = part[at] as usize;
            at += 1;
            let own = turned[f] == Some(true);
            for (&other, &against) in beyond[f].iter().zip(&against[f]) {
                if other == NONE {
                    continue;
                }
                let sense = own != against;
                match turned[other as usize] {
                    None => {
                        turned[other as usize] = Some(sense);
                        part.push(other);
                    }
                    Some(known) if known != sense => {
                        return Err(SurfaceError::OneSided {
                            elements: [f as u32, other].map(|f| surface.tags[f as usize]),
                            position: surface.center(other),
                        });
                    }
                    Some(_) => {}
                }
            }
        }
        let is_turned = |f: &&u32| turned[**f as usize] == Some(true);
        let count = part.iter().filter(is_turned).count();
        let keep = 2 * count <= part.len();
        let turn: Vec<u32> = (part.iter().copied())
            .filter(|f| (turned[*f as usize] == Some(true)) == keep)
            .collect();
        total += turn.len();
        turn.into_iter().for_each(|f| surface.turn(f));
    }
    Ok(total)
}

/// Every node belongs to one fan of elements, each sharing an edge with the next.
pub(super) fn check_fans(surface: &Surface, edges: &Edges) -> Result<(), SurfaceError> {
    // Corners of elements, joined across edges.
    let mut parent: Vec<u32> = (0..4 * surface.facets.len() as u32).collect();
    let corner = |facet: u32, node: u32| {
        let place = surface.facets[facet as usize]
            .iter()
            .position(|n| *n == node);
        4 * facet + place.unwrap_or(0) as u32
    };
    for rows in edges.all() {
        if let [a, b] = rows {
            for node in a.ends {
                let one = root(&mut parent, corner(a.facet, node));
                let other = root(&mut parent, corner(b.facet, node));
                parent[other as usize] = one;
            }
        }
    }
    let mut fan = vec![NONE; surface.nodes.len()];
    for f in 0..surface.facets.len() as u32 {
        for (k, &node) in super::edges::corners(&surface.facets[f as usize])
            .iter()
            .enumerate()
        {
            let own = root(&mut parent, 4 * f + k as u32);
            let known = &mut fan[node as usize];
            if *known != NONE && *known != own {
                return Err(SurfaceError::Pinched {
                    node: surface.node_tags[node as usize],
                    position: surface.nodes[node as usize].into(),
                });
            }
            *known = own;
        }
    }
    Ok(())
}

/// Root in a union-find forest, halving the path on the way.
fn root(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        let next = parent[parent[at as usize] as usize];
        parent[at as usize] = next;
        at = next;
    }
    at
}
