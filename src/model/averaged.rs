//! Slave nodes of a pair whose gaps are averaged, and the points around each.
use super::state::heap;
use super::{Model, PairModel};
use crate::contact::averaged::NodalGap;
use crate::contact::points::SlavePoint;
use std::collections::BTreeMap;

/// Mean edges of a face within which a foot is looked for: farther than from any point of the faces around a node to any
/// other.
const REACH: f64 = 3.0;

/// The slave's nodes. `m_A > 0` for each.
#[derive(Debug, Clone, PartialEq)]
pub struct SlaveNodes {
    /// Numbers in the model.
    nodes: Vec<u32>,
    /// Per point of the pair: places of its nodes among the slave's.
    places: Vec<[u32; 9]>,
    starts: Vec<u32>,
    around: Vec<Around>,
    /// Number of the first among all averaged nodes of the model.
    first: usize,
}

/// A point of a face around a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    /// Point of the pair.
    pub point: u32,
    /// The node's shape function there.
    pub shape: f64,
}

impl SlaveNodes {
    /// The nodes of a pair's points; `first` averaged nodes come before them in the model.
    ///
    /// # Errors
    /// A node for which `int N_A dS` is not positive.
    pub fn new(points: &[SlavePoint], first: usize) -> Result<Self, u32> {
        let mut place = BTreeMap::new();
        let mut around: Vec<Vec<Around>> = Vec::new();
        let mut places = Vec::with_capacity(points.len());
        let mut nodes = Vec::new();
        for (i, p) in points.iter().enumerate() {
            let mut own = [0; 9];
            for (k, (node, shape)) in p.terms().enumerate() {
                let at = *place.entry(node).or_insert_with(|| {
                    nodes.push(node as u32);
                    around.push(Vec::new());
                    nodes.len() as u32 - 1
                });
                own[k] = at;
                let point = i as u32;
                around[at as usize].push(Around { point, shape });
            }
            places.push(own);
        }
        let mut starts = vec![0];
        for (list, &node) in around.iter().zip(&nodes) {
            let mut gap = NodalGap::default();
            (list.iter()).for_each(|a| gap.add(a.shape, points[a.point as usize].area, 1.0));
            gap.gap().ok_or(node)?;
            starts.push(starts[starts.len() - 1] + list.len() as u32);
        }
        Ok(SlaveNodes {
            nodes,
            places,
            starts,
            around: around.concat(),
            first,
        })
    }

    /// From here on `first` averaged nodes come before them in the model.
    pub fn renumber(&mut self, first: usize) {
        self.first = first;
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Bytes of heap that they hold.
    pub fn bytes(&self) -> usize {
        let SlaveNodes {
            nodes,
            places,
            starts,
            around,
            first: _,
        } = self;
        heap(nodes) + heap(places) + heap(starts) + heap(around)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Numbers of the nodes in the model.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Places of these nodes in [`State::nodes`](super::state::State::nodes).
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.len()
    }

    /// Points of the faces around node number `place` of [`nodes`](Self::nodes), ascending.
    pub fn around(&self, place: usize) -> &[Around] {
        &self.around[self.starts[place] as usize..self.starts[place + 1] as usize]
    }

    /// The undeformed areas `m_A` of the nodes, over all of their faces; `points` are those of the pair.
    pub fn areas(&self, points: &[SlavePoint]) -> Vec<f64> {
        let area = |place| {
            let around = self.around(place).iter();
            around
                .map(|a| a.shape * points[a.point as usize].area)
                .sum()
        };
        (0..self.len()).map(area).collect()
    }

    /// Places of a point's nodes in [`nodes`](Self::nodes), with their shape functions.
    pub fn terms<'a>(
        &'a self,
        point: usize,
        p: &'a SlavePoint,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let n = p.count as usize;
        (self.places[point][..n].iter().zip(&p.shape[..n])).map(|(&at, &w)| (at as usize, w))
    }
}

/// What a point adds to the gaps of its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Share {
    /// Its gap, which changes with it.
    Gap(f64),
    /// It is open and far: the reach.
    Far(f64),
    /// Nothing: it faces a free border.
    Nothing,
}

impl Share {
    /// The share of a point; `seen` is what it sees within reach, its normal coordinate and whether the foot lies on a free
    /// border. A point below the surface and deeper than `depth` is none of the front's.
    pub fn new(seen: Option<(f64, bool)>, z0: f64, depth: f64, reach: f64) -> Share {
        match seen {
            Some((_, true)) => Share::Nothing,
            Some((xi3, false)) if xi3 >= -depth && xi3 <= reach => Share::Gap(xi3 - z0),
            _ => Share::Far(reach),
        }
    }

    /// Adds it to the gap of a node.
    pub fn add_to(&self, gap: &mut NodalGap, shape: f64, area: f64) {
        match *self {
            Share::Gap(g) | Share::Far(g) => gap.add(shape, area, g),
            Share::Nothing => {}
        }
    }
}

impl PairModel {
    /// How far a slave point with an averaged gap looks for the master (length).
    pub fn reach(&self, model: &Model) -> f64 {
        (self.master.depth(model)).max(REACH * self.element_size + self.offset)
    }
}
