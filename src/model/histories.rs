//! Where the histories of the slave points of a pair stand among those of all pairs.
//!
//! Pairs whose points stay come first: their histories have the same place at every state. Those of segments follow, whose
//! number changes whenever slave faces are cut anew.
use super::state::slaves;
use super::{Model, PairModel};
use crate::contact::points::SlavePoint;
use std::ops::Range;
use std::sync::Arc;

/// Numbers the histories of all pairs that have some, as they are before anything moves.
pub fn number(pairs: &mut [PairModel]) {
    let mut first = 0;
    for segments in [false, true] {
        let own = |p: &&mut PairModel| p.remembers() && p.segments().is_some() == segments;
        for pair in pairs.iter_mut().filter(own) {
            pair.first_history = Some(first);
            first += pair.carriers();
        }
    }
}

/// The histories of a pair at a state with these segments ([`State::cuts`](super::state::State::cuts)); none where its
/// points have none.
#[inline]
pub fn range(
    cuts: &[Option<Arc<[SlavePoint]>>],
    model: &Model,
    pair: usize,
) -> Option<Range<usize>> {
    let own = &model.pairs[pair];
    let first = own.first_history?;
    if cuts.is_empty() || own.segments().is_none() {
        return Some(first..first + own.carriers());
    }
    let cut = |index: &usize| {
        let p = &model.pairs[*index];
        p.first_history.is_some() && p.segments().is_some()
    };
    // What segments before this one have more or less than at first.
    let (mut more, mut less) = (0, 0);
    for before in (0..pair).filter(cut) {
        more += slaves(cuts, model, before).len();
        less += model.pairs[before].points.len();
    }
    let first = first + more - less;
    Some(first..first + slaves(cuts, model, pair).len())
}

/// Those of a pair's multipliers; empty where it has none.
pub fn multipliers(cuts: &[Option<Arc<[SlavePoint]>>], model: &Model, pair: usize) -> Range<usize> {
    let own = range(cuts, model, pair);
    own.filter(|_| model.pairs[pair].augmentation.is_some())
        .unwrap_or(0..0)
}
