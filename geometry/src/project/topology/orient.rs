//! Connected components, a consistent side for every patch, and the outside of closed components.

use super::super::EdgeKind;
use super::super::set::PatchSet;
use super::edge::Edge;
use crate::surface::{Surface, Vec3};

/// Patches that hang together.
#[derive(Debug, Clone)]
pub(crate) struct Components {
    /// Patches of every component, in order.
    pub members: Vec<Vec<usize>>,
    /// Number of the component of every patch.
    pub of: Vec<usize>,
    /// For a component with one side only: two patches that cannot be oriented alike.
    pub one_sided: Vec<Option<[usize; 2]>>,
}

/// Components and sides relative to the first patch of each. The patches of a one-sided component get side 0.
pub(super) fn orient(edges: &[Edge], first: &[usize], sides: &mut [f64]) -> Components {
    let mut of = vec![usize::MAX; sides.len()];
    let mut components: Vec<Vec<usize>> = Vec::new();
    let mut one_sided = Vec::new();
    for seed in 0..sides.len() {
        if of[seed] != usize::MAX {
            continue;
        }
        let number = components.len();
        let mut members = vec![seed];
        of[seed] = number;
        sides[seed] = 1.0;
        let mut next = 0;
        let mut conflict = None;
        while next < members.len() {
            let patch = members[next];
            next += 1;
            for link in edges[first[patch]..first[patch + 1]]
                .iter()
                .flat_map(|e| &e.links)
            {
                let other = edges[link.edge].patch as usize;
                let side = sides[patch] * link.relation;
                if of[other] == usize::MAX {
                    of[other] = number;
                    sides[other] = side;
                    members.push(other);
                } else if sides[other] != side && conflict.is_none() {
                    conflict = Some([patch.min(other), patch.max(other)]);
                }
            }
        }
        members.sort_unstable();
        if conflict.is_some() {
            members.iter().for_each(|&patch| sides[patch] = 0.0);
        }
        components.push(members);
        one_sided.push(conflict);
    }
    Components {
        members: components,
        of,
        one_sided,
    }
}

/// The volume that each component encloses, with the sign of the present sides; `None` for a component with free edges, with
/// one side only, or without volume. By the divergence theorem it is a third of the integral of `(rho - c) . n` for any point `c`.
pub(super) fn volumes<S: Surface>(
    set: &PatchSet<S>,
    edges: &[Edge],
    first: &[usize],
    components: &Components,
) -> Vec<Option<f64>> {
    components
        .members
        .iter()
        .zip(&components.one_sided)
        .map(|(members, one_sided)| {
            if one_sided.is_some() {
                return None;
            }
            let own = || members.iter().flat_map(|&p| &edges[first[p]..first[p + 1]]);
            if own().any(|e| e.kind == Some(EdgeKind::Free)) {
                return None;
            }
            let mut low = Vec3::from_element(f64::INFINITY);
            let mut high = -low;
            for edge in own() {
                low = low.inf(&edge.bounds[0]);
                high = high.sup(&edge.bounds[1]);
            }
            let center = 0.5 * (low + high);
            let mut volume = 0.0;
            let mut area = 0.0;
            for &patch in members {
                let own = &edges[first[patch]..first[patch + 1]];
                let [v, a] = super::super::integrate::over(set, patch as u32, own, |jet| {
                    let n = jet.rho_i[0].cross(&jet.rho_i[1]);
                    [(jet.rho - center).dot(&n) / 3.0, n.norm()]
                });
                volume += set.sides[patch] * v;
                area += a;
            }
            // Below this the quadrature cannot tell the sign (a sheet folded onto itself).
            (volume.abs() > 1e-6 * area * area.sqrt()).then_some(volume)
        })
        .collect()
}
