//! Which nodes of the slave and of the master a pair couples in the pattern.
//!
//! A slave point couples its nodes with those of the facet that it touches, and the facet changes as the bodies slide.
//! The pattern therefore holds more than what touches: every point that is in contact or near is coupled with its facet
//! and the facets around. Only where a point touches a facet outside of that is the pattern built anew.
use super::links::Links;
use super::memory::{CouplingMemory, MemoryError};
use crate::contact::lever::Lever;
use crate::contact::points::SlavePoint;
use crate::model::state::heap;
use covact_geometry::MovingFacets;
use std::collections::BTreeSet;

/// No map yet.
const NONE: u32 = u32::MAX;

/// A facet that a cell is coupled with.
#[derive(Debug, Clone, Copy)]
struct Coupled {
    facet: u32,
    /// Where its map starts, once it was asked for.
    map: u32,
}

/// Cells (slave points with the same nodes) and the facets that they are coupled with.
#[derive(Debug, Clone)]
pub(super) struct Couplings {
    /// Cell of every point.
    cell_of: Vec<u32>,
    /// Nodes of the cells.
    nodes: Vec<u32>,
    starts: Vec<u32>,
    /// Facets of every cell, ascending.
    facets: Vec<Vec<Coupled>>,
    /// Block maps of the couplings that were asked for.
    maps: Vec<u32>,
    /// Facets that are coupled with each other, for friction.
    pub links: Links,
}

impl Couplings {
    /// The cells of a pair, coupled with nothing.
    pub fn new(points: &[SlavePoint], levers: &[Lever]) -> Self {
        let mut cell_of = Vec::with_capacity(points.len());
        let mut nodes: Vec<u32> = Vec::new();
        let mut starts = vec![0u32];
        let mut last: Option<&[u32]> = None;
        for p in points {
            let own = match p.lever_number() {
                Some(number) => &levers[number].nodes[..],
                None => &p.nodes[..p.count as usize],
            };
            if last != Some(own) {
                nodes.extend_from_slice(own);
                starts.push(nodes.len() as u32);
            }
            last = Some(own);
            cell_of.push(starts.len() as u32 - 2);
        }
        let cells = starts.len() - 1;
        Couplings {
            cell_of,
            nodes,
            starts,
            facets: vec![Vec::new(); cells],
            maps: Vec::new(),
            links: Links::default(),
        }
    }

    /// Takes over other points on the same cells, in the same order; every cell has some.
    pub fn resample(&mut self, points: &[SlavePoint]) {
        self.cell_of.clear();
        let last = self.facets.len().saturating_sub(1);
        let mut cell = 0;
        for p in points {
            let own = &p.nodes[..p.count as usize];
            while cell < last && self.nodes(cell) != own {
                cell += 1;
            }
            self.cell_of.push(cell as u32);
        }
    }

    /// Cell of a slave point.
    #[inline]
    pub fn cell(&self, point: usize) -> usize {
        self.cell_of[point] as usize
    }

    /// Nodes of a cell.
    pub fn nodes(&self, cell: usize) -> &[u32] {
        &self.nodes[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Whether the pattern holds the coupling of a point with a facet.
    #[inline]
    pub fn holds(&self, point: usize, facet: u32) -> bool {
        self.place(self.cell(point), facet).is_some()
    }

    /// Facets that a cell is coupled with, ascending.
    pub fn facets(&self, cell: usize) -> impl Iterator<Item = u32> + '_ {
        self.facets[cell].iter().map(|c| c.facet)
    }

    /// All couplings, cell by cell.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (self.facets.iter().enumerate())
            .flat_map(|(cell, f)| f.iter().map(move |c| (cell, c.facet)))
    }

    /// Sets the couplings to those of `near` (points with the facets at their feet) and of the facets around. What was
    /// coupled before stays, so that points that go back and forth do not rebuild the pattern every time, until it
    /// outnumbers what is needed.
    pub fn couple(&mut self, facets: &MovingFacets, near: impl Iterator<Item = (usize, u32)>) {
        let feet: BTreeSet<(usize, u32)> = near.map(|(p, f)| (self.cell(p), f)).collect();
        let mut wanted = feet.clone();
        for (cell, facet) in feet {
            wanted.extend(facets.neighbours(facet).iter().map(|&f| (cell, f)));
        }
        let before: usize = self.facets.iter().map(Vec::len).sum();
        if before <= 2 * wanted.len() {
            wanted.extend(self.pairs());
        }
        self.facets.iter_mut().for_each(Vec::clear);
        for (cell, facet) in wanted {
            self.facets[cell].push(Coupled { facet, map: NONE });
        }
        self.maps.clear();
    }

    /// Sets the couplings to points with these facets, and no others.
    pub fn set(&mut self, feet: impl Iterator<Item = (usize, u32)>) {
        let feet: BTreeSet<(usize, u32)> = feet.map(|(p, f)| (self.cell(p), f)).collect();
        self.facets.iter_mut().for_each(Vec::clear);
        for (cell, facet) in feet {
            self.facets[cell].push(Coupled { facet, map: NONE });
        }
        self.maps.clear();
    }

    /// Couples, besides the neighbours among the facets that are coupled with points, `pairs` of facets with each other.
    pub fn link(&mut self, facets: &MovingFacets, pairs: impl Iterator<Item = (u32, u32)>) {
        let coupled = self.pairs().map(|(_, facet)| facet).collect();
        self.links.set(facets, &coupled, pairs);
    }

    /// Block map of the coupling of a point with a facet, made by `make` where it is asked for the first time on a
    /// pattern; `None` if they are not coupled.
    pub fn map<E>(
        &mut self,
        point: usize,
        facet: u32,
        make: impl FnOnce(&[u32], &mut Vec<u32>) -> Result<(), E>,
    ) -> Option<Result<usize, E>> {
        let cell = self.cell(point);
        let place = self.place(cell, facet)?;
        if self.facets[cell][place].map == NONE {
            let start = self.maps.len();
            let nodes = &self.nodes[self.starts[cell] as usize..self.starts[cell + 1] as usize];
            if let Err(e) = make(nodes, &mut self.maps) {
                return Some(Err(e));
            }
            self.facets[cell][place].map = start as u32;
        }
        Some(Ok(self.facets[cell][place].map as usize))
    }

    /// What is coupled.
    pub fn memory(&self) -> CouplingMemory {
        // Cells and nodes are those of the model; maps are made as they are asked for.
        let Couplings {
            cell_of: _,
            nodes: _,
            starts: _,
            facets,
            maps: _,
            links,
        } = self;
        CouplingMemory {
            counts: facets.iter().map(|f| f.len() as u32).collect(),
            facets: facets.iter().flatten().map(|c| c.facet).collect(),
            links: links.pairs().collect(),
        }
    }

    /// Couples what was coupled then, of `facets` facets that there are.
    ///
    /// # Errors
    /// [`MemoryError::Misfit`]
    pub fn restore(&mut self, memory: &CouplingMemory, facets: usize) -> Result<(), MemoryError> {
        let known = |f: &u32| (*f as usize) < facets;
        let all = memory.facets.iter().chain(memory.links.iter().flatten());
        let sum: u64 = memory.counts.iter().map(|c| u64::from(*c)).sum();
        if memory.counts.len() != self.facets.len()
            || sum != memory.facets.len() as u64
            || !all.clone().all(known)
        {
            return Err(MemoryError::Misfit("another set of coupled facets"));
        }
        let mut rest = memory.facets.iter();
        for (cell, count) in self.facets.iter_mut().zip(&memory.counts) {
            cell.clear();
            let own = rest.by_ref().take(*count as usize);
            cell.extend(own.map(|&facet| Coupled { facet, map: NONE }));
            if !cell.is_sorted_by(|a, b| a.facet < b.facet) {
                return Err(MemoryError::Misfit("coupled facets without order"));
            }
        }
        self.maps.clear();
        self.links.restore(&memory.links);
        Ok(())
    }

    /// Bytes of heap that it holds, links left out.
    pub fn bytes(&self) -> usize {
        let Couplings {
            cell_of,
            nodes,
            starts,
            facets,
            maps,
            links: _,
        } = self;
        let coupled: usize = facets.iter().map(heap).sum();
        heap(cell_of) + heap(nodes) + heap(starts) + heap(facets) + heap(maps) + coupled
    }

    /// Block maps, from where [`Couplings::map`] says.
    pub fn maps(&self) -> &[u32] {
        &self.maps
    }

    fn place(&self, cell: usize, facet: u32) -> Option<usize> {
        self.facets[cell]
            .binary_search_by_key(&facet, |c| c.facet)
            .ok()
    }
}
