//! What the points of a pair meet.
use super::super::per_pair::PerPair;
use super::super::touched::Touched;
use super::CHUNK;
use crate::contact::lever;
use crate::contact::moving::MovingTouch;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::PointFault;
use crate::model::PairModel;
use crate::model::state::heap;
use covact_geometry::ShapeRows;
use std::sync::Arc;

/// The slave points of a pair at the state evaluated last, and room for their matrices.
#[derive(Debug, Clone, Default)]
pub(in crate::assembly::assembler) struct Meetings {
    pub(super) touched: Touched<MovingTouch>,
    pub(super) rows: Vec<ShapeRows>,
    pub(super) matrices: Vec<f64>,
    /// Numbers that the largest matrix has.
    pub(super) stride: usize,
    /// The segments that the points are of.
    cut: Option<Arc<[SlavePoint]>>,
}

impl Meetings {
    /// Bytes of heap for each point of a pair, and for all of it.
    pub fn sizes(pair: &PairModel) -> Option<[usize; 2]> {
        let stride = Meetings::stride(pair)?;
        let most = CHUNK.min(pair.points.len());
        let point = size_of::<Result<Option<MovingTouch>, PointFault>>() + size_of::<u32>();
        let room = most * (size_of::<ShapeRows>() + stride * size_of::<f64>());
        Some([point, PerPair::<Meetings>::HEAD + room])
    }

    /// Numbers that the largest matrix of a pair has; none where this is not for the pair.
    fn stride(pair: &PairModel) -> Option<usize> {
        let (Some(master), None, None) = (pair.body_master(), &pair.averaged, &pair.friction)
        else {
            return None;
        };
        let facets = 0..master.facets.len() as u32;
        let facet = facets.map(|f| master.facets.nodes(f).len()).max();
        Some(room(pair, facet.unwrap_or(0)))
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        let Meetings {
            touched,
            rows,
            matrices,
            stride: _,
            // Shared with the states.
            cut: _,
        } = self;
        touched.bytes() + heap(rows) + heap(matrices)
    }

    /// Room for a pair; nothing where the master is rigid, gaps are averaged, or there is friction
    /// ([`super::sliding::Sliding`]).
    pub fn new(pair: &PairModel) -> Option<Self> {
        let mut out = Meetings {
            stride: Meetings::stride(pair)?,
            ..Meetings::default()
        };
        out.resize(pair.points.len());
        Some(out)
    }

    /// Room for another number of points.
    fn resize(&mut self, points: usize) {
        let most = CHUNK.min(points);
        self.touched.resize(points);
        self.rows.resize(most, ShapeRows::default());
        self.matrices.resize(most * self.stride, 0.0);
    }

    /// Points in contact, with the facets at their feet.
    pub(super) fn touched(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        let facet = |i: u32| Some((i as usize, self.touched.get(i)?.facet));
        self.touched.active.iter().filter_map(move |&i| facet(i))
    }

    /// Takes over the number of points of segments that were cut anew, and says whether they were.
    pub(super) fn follow(&mut self, cut: &Option<Arc<[SlavePoint]>>, points: usize) -> bool {
        let anew = !same(&self.cut, cut);
        if anew {
            self.cut.clone_from(cut);
            self.resize(points);
        }
        anew
    }
}

/// Whether the points of two cuts are the same.
pub(in crate::assembly::assembler) fn same(
    a: &Option<Arc<[SlavePoint]>>,
    b: &Option<Arc<[SlavePoint]>>,
) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        _ => false,
    }
}

/// Numbers of the largest matrix of a point of a pair with so many other nodes: of a point at a height above a mid-surface that of
/// the nodes below it, and besides that of the point itself.
pub(in crate::assembly::assembler) fn room(pair: &PairModel, others: usize) -> usize {
    let size = |nodes: usize| (3 * (nodes + others)).pow(2);
    let own = |p: &SlavePoint| match p.count {
        0 => size(lever::NODES) + size(1),
        n => size(n as usize),
    };
    pair.points.iter().map(own).max().unwrap_or(size(0))
}
