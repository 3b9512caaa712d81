//! Which effects make the tangent unsymmetric. Decided once, before anything is solved.
use super::Model;
use crate::assembly::Dof;
use crate::mesh::FaceNodes;
use std::collections::{BTreeMap, BTreeSet};

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

/// Edges that belong to one of the faces only, from node to node (a quadratic edge is two).
fn border(faces: &[FaceNodes]) -> impl Iterator<Item = [u32; 2]> {
    let mut turns: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for face in faces {
        let around: Vec<u32> = around(face).collect();
        for (k, &a) in around.iter().enumerate() {
            let b = around[(k + 1) % around.len()];
            // Two neighbours walk along their edge in opposite directions.
            *turns.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    (turns.into_iter())
        .filter(|(_, turns)| *turns != 0)
        .map(|(edge, _)| edge)
}

/// Nodes of a face around its border.
fn around(face: &FaceNodes) -> impl Iterator<Item = u32> + '_ {
    let [nu, nv] = face.count.map(usize::from);
    let below = 0..nu - 1;
    let right = (0..nv - 1).map(move |j| nu * j + nu - 1);
    let above = (1..nu).rev().map(move |i| nu * (nv - 1) + i);
    let left = (1..nv).rev().map(move |j| nu * j);
    (below.chain(right).chain(above).chain(left)).map(|k| face.nodes[k])
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
