//! Nodes of a pair with averaged gaps, as the output shows them.
use crate::contact::averaged::NodalGap;
use crate::contact::law::NormalLaw;
use crate::model::averaged::{Share, SlaveNodes};
use crate::model::master::MasterNow;
use crate::model::state::State;
use crate::model::{Model, histories};

/// A slave node.
pub(super) struct NodeNow {
    /// Number in the model.
    pub node: usize,
    pub closed: bool,
    /// Mean gap `g_A`; of an open node the mean distance of its points.
    pub gap: f64,
    /// `-lambda_A`.
    pub pressure: f64,
    /// `m_A` of a closed node.
    pub area: f64,
    /// Normal traction by the overclosures that shrink around the node and their areas (energy).
    pub pressed: f64,
}

/// Sums of a node over its points.
#[derive(Clone, Copy, Default)]
struct Sums {
    gap: NodalGap,
    /// Weighted distances as they are shown, and all of the weight.
    shown: f64,
    area: f64,
    /// Weighted overclosures that shrink.
    shrinking: f64,
}

/// The nodes of pair `index` in an accepted state; `hints` starts the search of its points at number `first` of the state's,
/// and `front` becomes whether each is in front of the master or in contact. Also says how many of them are no longer,
/// but lie below it and deeper than its depth.
#[allow(clippy::too_many_arguments)]
pub(super) fn nodes_now<L: NormalLaw>(
    model: &Model,
    index: usize,
    nodes: &SlaveNodes,
    law: &L,
    master: &MasterNow,
    state: &State,
    first: usize,
    time: f64,
    front: &mut [bool],
    start: &[f64],
) -> (Vec<NodeNow>, usize) {
    let pair = &model.pairs[index];
    let offsets = pair.offsets(time);
    let reach = pair.reach(model);
    let shrinking = pair.resolved(start, first);
    let mut sums = vec![Sums::default(); nodes.len()];
    let mut sunk = 0;
    for (i, (p, front)) in pair.points.iter().zip(front).enumerate() {
        let z0 = offsets.as_ref().map_or(0.0, |o| o.at(i));
        let x = model.point_position(p, &state.u);
        let seen = master.see(i, &x, state.points[first + i].hint);
        sunk += usize::from(*front && seen.is_some_and(|s| s.behind));
        *front = seen.is_some_and(|s| s.in_front(pair.master.is_own()));
        let found = seen.map(|s| (s.signed_distance, s.free));
        let share = Share::new(found, z0, master.depth(), reach);
        let shown = match (share, &seen) {
            (Share::Gap(gap), _) => gap,
            (_, Some(seen)) => seen.distance,
            (_, None) => f64::NAN,
        };
        for (at, shape) in nodes.terms(i, p) {
            share.add_to(&mut sums[at].gap, shape, p.area);
            sums[at].shown += shape * p.area * shown;
            sums[at].area += shape * p.area;
            if let (Some(z0), Share::Gap(_)) = (shrinking, share) {
                sums[at].shrinking += shape * p.area * z0[i];
            }
        }
    }
    let known = histories::multipliers(&state.cuts, model, index);
    let known = &state.histories[known];
    let now = nodes.nodes().iter().zip(&sums).enumerate();
    let now = now.map(|(at, (&node, s))| {
        // With multipliers the step's own, which may be that of a node slightly above the surface.
        let n = match known.get(at) {
            Some(history) => history.n,
            None => s.gap.normal(law).n,
        };
        let closed = s.gap.gap().filter(|_| n < 0.0);
        NodeNow {
            node: node as usize,
            closed: closed.is_some(),
            gap: closed.unwrap_or(s.shown / s.area),
            pressure: -n,
            pressed: n * s.shrinking,
            area: closed.map_or(0.0, |_| s.gap.area),
        }
    });
    (now.collect(), sunk)
}
