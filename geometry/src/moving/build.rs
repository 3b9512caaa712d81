//! Facets as they are given.

use super::trimmed::Trims;
use std::collections::HashMap;

use super::extraction::Operator;
use super::topology::{Outline, Topology};
use super::{EMPTY_BOX, MAX, MovingError, MovingFacets};
use crate::surface::Vec3;

impl MovingFacets {
    /// Facets by the numbers of their nodes (any, those of a model for one), xi1 fastest, with 2 or 3 nodes in each
    /// direction; `rho_1 x rho_2` points outwards. Facets with the same end nodes (and middle node) of an edge are joined
    /// there. Two equal nodes at the ends of an edge make a triangle.
    ///
    /// # Errors
    /// No facets, node counts other than 2 or 3, lists of another length, neighbours whose normals point to different
    /// sides.
    pub fn new(facets: &[(&[u32], [u8; 2])]) -> Result<Self, MovingError> {
        check(facets)?;
        let outlines: Vec<Outline> = facets.iter().map(|f| outline(f.0, f.1)).collect();
        let topology = Topology::new(&outlines)?;
        let degree = match facets.iter().all(|f| f.1 == [2, 2]) {
            true => 1,
            false => 2,
        };
        let mut set = Parts::default();
        for (k, &(nodes, count)) in facets.iter().enumerate() {
            let operator = Operator::lagrange(count, degree);
            set.push(k, nodes, operator)?;
        }
        Ok(set.finish(degree, topology))
    }
}

/// Counts and list lengths.
pub(super) fn check(facets: &[(&[u32], [u8; 2])]) -> Result<(), MovingError> {
    if facets.is_empty() {
        return Err(MovingError::Empty);
    }
    // Each may be cut in four, and four corners each are numbered.
    if facets.len() > (u32::MAX / 64) as usize {
        return Err(MovingError::TooMany(facets.len()));
    }
    for (facet, &(nodes, count)) in facets.iter().enumerate() {
        if count.iter().any(|n| !(2..=3).contains(n)) {
            return Err(MovingError::Count { facet, count });
        }
        if nodes.len() != usize::from(count[0]) * usize::from(count[1]) {
            return Err(MovingError::Nodes {
                facet,
                count,
                found: nodes.len(),
            });
        }
    }
    Ok(())
}

/// Corner and middle nodes of a facet.
pub(super) fn outline(nodes: &[u32], count: [u8; 2]) -> Outline {
    let [n, m] = count.map(usize::from);
    let at = |i: usize, j: usize| nodes[i + n * j];
    let (along, across) = (n == 3, m == 3);
    Outline {
        corners: [at(0, 0), at(n - 1, 0), at(0, m - 1), at(n - 1, m - 1)],
        middles: [
            across.then(|| at(0, 1)),
            across.then(|| at(n - 1, 1)),
            along.then(|| at(1, 0)),
            along.then(|| at(1, m - 1)),
        ],
    }
}

/// A set in the making.
#[derive(Default)]
pub(super) struct Parts {
    numbers: HashMap<u32, u32>,
    order: Vec<u32>,
    first: Vec<u32>,
    nodes: Vec<u32>,
    places: Vec<u32>,
    operators: Vec<Operator>,
    known: HashMap<Vec<u64>, u32>,
    operator_of: Vec<u32>,
    source: Vec<u32>,
    pub trims: Trims,
}

impl Parts {
    /// Adds a facet that depends on `nodes` and comes from facet `source`.
    pub fn push(
        &mut self,
        source: usize,
        nodes: &[u32],
        operator: Operator,
    ) -> Result<(), MovingError> {
        if nodes.len() > MAX {
            return Err(MovingError::Stencil {
                facet: source,
                count: nodes.len(),
            });
        }
        if self.first.is_empty() {
            self.first.push(0);
        }
        for &node in nodes {
            let next = self.order.len() as u32;
            let place = *self.numbers.entry(node).or_insert(next);
            if place == next {
                self.order.push(node);
            }
            self.places.push(place);
        }
        self.nodes.extend_from_slice(nodes);
        self.first.push(self.nodes.len() as u32);
        let next = self.operators.len() as u32;
        let number = *self.known.entry(operator.key()).or_insert(next);
        if number == next {
            self.operators.push(operator);
        }
        self.operator_of.push(number);
        self.source.push(source as u32);
        Ok(())
    }

    pub fn finish(self, degree: usize, topology: Topology) -> MovingFacets {
        let count = self.operator_of.len();
        let points = (degree + 1) * (degree + 1);
        let rational = self.operators.iter().any(Operator::is_rational);
        MovingFacets {
            degree,
            positions: vec![Vec3::zeros(); self.order.len()],
            numbers: self.order,
            first: self.first,
            nodes: self.nodes,
            places: self.places,
            operators: self.operators,
            operator_of: self.operator_of,
            source: self.source,
            topology,
            rational,
            trims: self.trims,
            nets: vec![[0.0; 4]; count * points],
            boxes: vec![EMPTY_BOX; count],
            tree: None,
            size: 0.0,
        }
    }
}
