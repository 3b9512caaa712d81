//! Nodes that slide off a free border of a body while the faces around them still lie on it.
//!
//! A node stands for half of the faces up to its neighbours. A row of nodes that a squeezed body pushes past the border of the other,
//! flush with it at the start, lets go one after the other with all of that, and what lies inside of the border is left without a
//! point. Points within the faces see it. Edges as slaves are left alone, and two half passes, of which the other sees those faces.
use crate::model::Model;
use crate::model::master::Masters;
use crate::model::state::State;

/// Part of the radius by which a border is rounded off that a node may hang over.
const PAST: f64 = 0.5;
/// Part of the area that bears, of nodes that hang over by more, from which on it counts.
const BEARS: f64 = 0.04;

/// The pairs among those in `may` whose nodes hang over a border of a body at an accepted state.
pub(in crate::run) fn hanging(
    model: &Model,
    masters: &mut Masters,
    (state, time): (&State, f64),
    may: &[usize],
) -> Vec<usize> {
    let nodal = |index: &usize| {
        let pair = &model.pairs[*index];
        let points = &pair.points;
        pair.body_master().is_some()
            && pair.averaged.is_none()
            && pair.edges_of.is_none()
            && pair.half.is_none()
            && points.first().is_some_and(|p| p.count == 1)
    };
    let pairs: Vec<usize> = may.iter().copied().filter(nodal).collect();
    if pairs.is_empty() {
        return pairs;
    }
    masters.update(model, &state.u);
    let mut found = pairs;
    found.retain(|&index| {
        let first: usize = (model.pairs[..index].iter().enumerate())
            .map(|(i, _)| state.slaves(model, i).len())
            .sum();
        let Ok(master) = masters.at(model, index, &state.u, time) else {
            return false;
        };
        let points = model.pairs[index].points.iter().zip(&state.points[first..]);
        let (mut bears, mut over) = (0.0, 0.0);
        for (p, s) in points.filter(|(_, s)| s.closed) {
            let x = model.point_position(p, &state.u);
            bears += p.area;
            if master.past(&x, s.hint, p.overhang(true)) > PAST {
                over += p.area;
            }
        }
        over > BEARS * bears
    });
    found
}
