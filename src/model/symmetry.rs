//! Which effects make the tangent unsymmetric. Decided once, before anything is solved.
use super::EffectKind;
use super::Model;
use super::sheet_pressure::FollowingSpan;
use crate::fem::FaceNodes;
use crate::system::Dof;
use std::collections::{BTreeMap, BTreeSet};

/// An effect that makes the tangent unsymmetric.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsymmetric {
    pub effect: EffectKind,
    /// The contact, load or material that has it.
    pub of: String,
    /// Why, in a sentence.
    pub why: String,
}

/// What makes the tangent unsymmetric; nothing for a symmetric one.
///
/// A pressure that follows the faces has a potential but for terms along their border, the triple products of two
/// displacements and the border's tangent (K. Schweizerhof and E. Ramm, "Displacement dependent pressure loads in
/// nonlinear finite element analyses", Computers and Structures 18 (1984)). They vanish along an edge that is held, and
/// along one that slides in a plane of symmetry.
pub fn unsymmetric_effects(model: &Model) -> Vec<Unsymmetric> {
    if model.small.is_some() {
        // Pressures do not follow, and half passes do not go with it.
        return friction(model).collect();
    }
    let still = still(model);
    let halves = (model.pairs.iter())
        .filter(|p| p.half.is_some_and(|h| !h.back))
        .map(|p| Unsymmetric {
            effect: EffectKind::TwoHalfPasses,
            of: p.name.clone(),
            why: format!(
                "contact `{}` is made of two half passes, in each of which the traction acts on the slave alone",
                p.name
            ),
        });
    let follower = (model.follower_loads.iter())
        .filter(|(_, load)| {
            border(&load.faces).any(|edge| !quiet(model, &still, &edge))
                || !load.spans.is_empty()
                    && load
                        .rims
                        .as_ref()
                        .is_none_or(|rims| rims.iter().any(|rim| !quiet(model, &still, rim)))
        })
        .map(|(name, load)| Unsymmetric {
            effect: EffectKind::FollowerPressure,
            of: name.clone(),
            why: match (&load.spans.first(), &load.rims) {
                (Some(FollowingSpan::Couple(_)), _) => {
                    format!("the couple `{name}` follows an edge")
                }
                _ => format!(
                    "the follower pressure `{name}` acts on faces whose border is free to move"
                ),
            },
        });
    let materials = materials(model);
    (materials.into_iter())
        .chain(follower)
        .chain(halves)
        .chain(friction(model))
        .collect()
}

/// Laws of materials whose tangents are not symmetric, once for every kind of law.
fn materials(model: &Model) -> Vec<Unsymmetric> {
    let mut out: Vec<Unsymmetric> = Vec::new();
    for body in &model.bodies {
        let law = &body.material;
        let effect = EffectKind::named(&format!("material.{}", law.key()));
        if let Some(effect) = effect.filter(|_| !law.is_symmetric())
            && out.iter().all(|u| u.of != law.key())
        {
            out.push(Unsymmetric {
                effect,
                of: law.key().to_owned(),
                why: format!(
                    "the back stress of the material of body `{}` recovers as it flows",
                    body.name
                ),
            });
        }
    }
    out
}

/// The friction of contacts; another pair of the same contact has its own.
fn friction(model: &Model) -> impl Iterator<Item = Unsymmetric> + '_ {
    (model.pairs.iter())
        .filter(|p| !p.is_second())
        .filter_map(|p| {
            Some(Unsymmetric {
                effect: p.friction.as_ref()?.law.kind().effect()?,
                of: p.name.clone(),
                why: format!(
                    "the friction of contact `{}` depends on its pressure",
                    p.name
                ),
            })
        })
}

/// Nodes of the edges that belong to one of the faces only: both ends, and the middle (or again an end).
fn border(faces: &[FaceNodes]) -> impl Iterator<Item = [u32; 3]> {
    let mut turns: BTreeMap<[u32; 2], (i32, u32)> = BTreeMap::new();
    for face in faces {
        let [n, m] = face.count.map(usize::from);
        let at = |i: usize, j: usize| face.nodes[i + n * j];
        // All the same way round.
        let corners = [at(0, 0), at(n - 1, 0), at(n - 1, m - 1), at(0, m - 1)];
        let middles = [
            at(n / 2, 0),
            at(n - 1, m / 2),
            at(n / 2, m - 1),
            at(0, m / 2),
        ];
        for (k, middle) in middles.into_iter().enumerate() {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            // Two neighbours walk along their edge in opposite directions.
            let turn = turns.entry([a.min(b), a.max(b)]).or_insert((0, middle));
            turn.0 += if a < b { 1 } else { -1 };
        }
    }
    (turns.into_iter())
        .filter(|(_, (turns, _))| *turns != 0)
        .map(|([a, b], (_, middle))| [a, b, middle])
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
fn quiet(model: &Model, still: &BTreeSet<u32>, nodes: &[u32]) -> bool {
    let held = |node: u32, c: u32| model.dofs.dof((3 * node + c) as usize) == Dof::Prescribed;
    if (0..3).all(|c| nodes.iter().all(|&n| held(n, c))) {
        return true;
    }
    let still = |node: u32, c: usize| still.contains(&(3 * node + c as u32));
    let first = model.nodes[nodes[0] as usize];
    let off: Vec<_> = (nodes.iter())
        .map(|n| model.nodes[*n as usize] - first)
        .collect();
    let size = off.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let flat = |c: usize| off.iter().all(|x| x[c].abs() <= 1e-9 * size);
    (0..3).any(|c| flat(c) && nodes.iter().all(|&n| still(n, c)))
}
