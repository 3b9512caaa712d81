//! Slave points that slide over flat faces of a curved master: gaps are measured between the curved surfaces as the points lie at the
//! start, and where they have slid to, the faces change them by something else.
use crate::model::Model;
use crate::model::state::State;

/// Part of the overclosure or clearance at the start by which flat faces may change gaps as points slide, without a word.
const COUNTS: f64 = 0.05;

/// The pairs whose points have slid so far, with that part.
pub(in crate::run) fn slides(model: &Model, state: &State) -> Vec<(usize, f64)> {
    let mut first = 0;
    let mut out = Vec::new();
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = state.slaves(model, index);
        let states = &state.points[first..first + points.len()];
        first += points.len();
        if let (Some(below), Some(master)) = (&pair.below, pair.body_master()) {
            let part = below.slid(points, states, |patch| master.facets.source(patch));
            if part > COUNTS {
                out.push((index, part));
            }
        }
    }
    out
}
