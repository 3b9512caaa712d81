//! Which facets of a master a pair with friction couples with each other in the pattern.
//!
//! A slave point with friction feels the facet at its foot and the one that holds its attraction point, and pushes the
//! former. Mostly they are one or neighbours, so the pattern holds all neighbours among the facets that it couples with
//! slave points, and beyond these the pairs that points have at the time.
use super::couplings::Couplings;
use crate::contact::friction::history::PointHistory;
use crate::model::state::heap;
use covact_geometry::MovingFacets;
use std::collections::{BTreeSet, HashMap};

/// Pairs of facets whose nodes are coupled, and the block maps of what was asked for. Empty without friction.
#[derive(Debug, Clone, Default)]
pub(super) struct Links {
    /// With the smaller number first.
    pairs: BTreeSet<[u32; 2]>,
    /// Where the map of a cell, the facet at a foot and that of an attraction point starts.
    known: HashMap<[u32; 3], u32>,
    maps: Vec<u32>,
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Links {
    /// Links `pairs` and all neighbours among `coupled`.
    pub fn set(
        &mut self,
        facets: &MovingFacets,
        coupled: &BTreeSet<u32>,
        pairs: impl Iterator<Item = (u32, u32)>,
    ) {
        self.known.clear();
        self.maps.clear();
        self.pairs.clear();
        let far = pairs.filter(|(a, b)| a != b);
        self.pairs.extend(far.map(|(a, b)| sorted(a, b)));
        for &facet in coupled {
            let near = facets.neighbours(facet).iter();
            let near = near.filter(|f| **f > facet && coupled.contains(f));
            self.pairs.extend(near.map(|&f| [facet, f]));
        }
    }

    /// Links these pairs and no others.
    pub fn restore(&mut self, pairs: &[[u32; 2]]) {
        let Links {
            pairs: own,
            known,
            maps,
        } = self;
        known.clear();
        maps.clear();
        *own = pairs.iter().map(|[a, b]| sorted(*a, *b)).collect();
    }

    /// Bytes of heap that it holds: those of what is in its sets and maps.
    pub fn bytes(&self) -> usize {
        let Links { pairs, known, maps } = self;
        let known = known.capacity() * size_of::<([u32; 3], u32)>();
        pairs.len() * size_of::<[u32; 2]>() + known + heap(maps)
    }

    /// The pairs.
    pub fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.pairs.iter().copied()
    }

    /// Whether two facets are coupled.
    #[inline]
    pub fn hold(&self, a: u32, b: u32) -> bool {
        a == b || self.pairs.contains(&sorted(a, b))
    }

    /// Block map of a cell with the facets at a foot and at an attraction point, made by `make` where it is asked for the
    /// first time on a pattern. Its length is what `make` appends.
    pub fn map<E>(
        &mut self,
        [cell, facet, anchor]: [u32; 3],
        make: impl FnOnce(&mut Vec<u32>) -> Result<(), E>,
    ) -> Result<&[u32], E> {
        let start = match self.known.get(&[cell, facet, anchor]) {
            Some(start) => *start as usize,
            None => {
                let start = self.maps.len();
                make(&mut self.maps)?;
                self.known.insert([cell, facet, anchor], start as u32);
                start
            }
        };
        Ok(&self.maps[start..])
    }
}

/// Adds the facets of the attraction points to those at the feet of points, and links what occurs together.
pub(super) fn with_anchors(
    near: &mut Vec<(usize, u32)>,
    histories: &[PointHistory],
) -> Vec<(u32, u32)> {
    let anchor = |i: usize| Some(histories.get(i)?.place?.patch);
    let held: Vec<(usize, u32, u32)> = (near.iter())
        .filter_map(|&(i, facet)| Some((i, facet, anchor(i)?)))
        .collect();
    near.extend(held.iter().map(|&(i, _, anchor)| (i, anchor)));
    held.iter()
        .map(|&(_, facet, anchor)| (facet, anchor))
        .collect()
}

/// Whether the pattern holds what a point feels.
pub(super) fn holds(couplings: &Couplings, (point, facet, anchor): (usize, u32, u32)) -> bool {
    couplings.holds(point, facet)
        && couplings.holds(point, anchor)
        && couplings.links.hold(facet, anchor)
}
