//! Which effects make the tangent unsymmetric. Decided once, before anything is solved.
use super::Model;
use crate::assembly::Dof;
use std::collections::{BTreeMap, BTreeSet};

/// Corners of a face by its edges, all the same way round.
const EDGES: [[usize; 2]; 4] = [[0, 1], [1, 3], [3, 2], [2, 0]];

/// Why the tangent is unsymmetric, an effect a sentence; empty for a symmetric one.
///
/// A pressure that follows the faces has a potential but for terms along their border, the triple products of two
/// displacements and the border's tangent (K. Schweizerhof and E. Ramm, "Displacement dependent pressure loads in
/// nonlinear finite element analyses", Computers and Structures 18 (1984)). They vanish along an edge that is held, and
/// along one that slides in a plane of symmetry.
pub fn unsymmetric_effects(model: &Model) -> Vec<String> {
    let still = still(model);
    (model.follower_loads.iter())
        .filter(|(_, load)| border(&load.faces).any(|edge| !quiet(model, &still, edge)))
        .map(|(name, _)| {
            format!("the follower pressure `{name}` acts on faces whose border is free to move")
        })
        .collect()
}

/// Edges that belong to one of the faces only.
fn border(faces: &[[u32; 4]]) -> impl Iterator<Item = [u32; 2]> {
    let mut turns: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for face in faces {
        for [a, b] in EDGES {
            let (a, b) = (face[a], face[b]);
            // Two neighbours walk along their edge in opposite directions.
            *turns.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    (turns.into_iter())
        .filter(|(_, turns)| *turns != 0)
        .map(|(edge, _)| edge)
}

/// Degrees of freedom that are prescribed to stay where they are.
fn still(model: &Model) -> BTreeSet<u32> {
    let prescribed = model.prescribed.iter();
    let mut still: BTreeSet<u32> = prescribed.clone().map(|p| p.dof).collect();
    for p in prescribed.filter(|p| p.value.is_some()) {
        still.remove(&p.dof);
    }
    still.retain(|dof| model.dofs.dof(*dof as usize) == Dof::Prescribed);
    still
}

/// Whether the terms of an edge vanish: it is held, or lies in a plane across which its nodes do not move.
fn quiet(model: &Model, still: &BTreeSet<u32>, [a, b]: [u32; 2]) -> bool {
    let held = |node: u32, c: u32| model.dofs.dof((3 * node + c) as usize) == Dof::Prescribed;
    if (0..3).all(|c| held(a, c) && held(b, c)) {
        return true;
    }
    let still = |node: u32, c: usize| still.contains(&(3 * node + c as u32));
    let edge = model.nodes[b as usize] - model.nodes[a as usize];
    (0..3).any(|c| edge[c].abs() <= 1e-9 * edge.norm() && still(a, c) && still(b, c))
}
