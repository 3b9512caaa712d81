//! Sharp edges of bodies that are no slaves, as steps are accepted: one that sinks in between slave points is seen by none of them.
use super::deformed;
use crate::model::master::moving_facets;
use crate::model::{Model, edges, penalty};
use covact_geometry::MovingFacets;

/// An edge that is deeper in the slave than this part of the slave's elements, or of the way by which it is deformed where that is
/// shorter, has sunk in.
const SUNK: f64 = 0.02;
/// Part of the slave's elements below which a depth says nothing, however little the slave is deformed.
const NOTHING: f64 = 1e-4;

/// The sharp edges of all bodies that may sink into their slaves.
#[derive(Debug, Default)]
pub(in crate::run) struct EdgeWatch(Vec<Watched>);

/// The edges of the master of a pair.
#[derive(Debug)]
struct Watched {
    pair: usize,
    /// Nodes of the model at both ends of each.
    edges: Vec<[u32; 2]>,
    /// The slave's faces and their nodes, the size of their elements, and how deep below them edges are looked for (length).
    faces: MovingFacets,
    of_slave: Vec<u32>,
    size: f64,
    depth: f64,
}

impl Watched {
    /// The edges of the master of pair `index`; none where it has no such edges, or they are slaves already.
    fn new(model: &Model, index: usize) -> Option<Self> {
        let pair = &model.pairs[index];
        let master = pair.body_master()?;
        let [body, slave] = [&model.bodies[master.body], &model.bodies[pair.body]];
        let asked = model.pairs.iter().any(|p| p.edges_of == Some(index));
        let sheet = body.block.sheet().is_some() || slave.block.sheet().is_some();
        if asked
            || sheet
            || pair.half.is_some()
            || pair.edges_of.is_some()
            || master.body == pair.body
        {
            return None;
        }
        let start = |n: u32| model.nodes[n as usize];
        let faces = moving_facets(&slave.mesh, slave.first_node, &pair.faces, false, start).ok()?;
        let size = pair.element_size;
        let first = body.first_node;
        let edges = edges::sharp_edges(&body.mesh, &master.faces, |n| start(n + first));
        let edges = edges
            .into_iter()
            .map(|e| [e[0] + first, e[e.len() - 1] + first]);
        let edges: Vec<[u32; 2]> = edges.collect();
        let mut of_slave: Vec<u32> = (0..faces.len() as u32)
            .flat_map(|f| faces.nodes(f).to_vec())
            .collect();
        of_slave.sort_unstable();
        of_slave.dedup();
        (!edges.is_empty()).then(|| Watched {
            pair: index,
            edges,
            of_slave,
            size,
            depth: penalty::face_size(&slave.mesh, &pair.faces).depth.max(size),
            faces,
        })
    }

    /// Whether one of them has sunk in at displacements `u`; `penetration`: the deepest of the slave's own points (length).
    fn sunk(&mut self, model: &Model, u: &[f64], penetration: f64) -> bool {
        // A contact that does not act in a stage has no points.
        if model.pairs[self.pair].points.is_empty() {
            return false;
        }
        self.faces.update(|n| model.position(n as usize, u));
        let least = NOTHING.max(SUNK * (deformed(&self.of_slave, u) / self.size).min(1.0));
        self.edges.iter().any(|ends| {
            let [a, b] = ends.map(|n| model.position(n as usize, u));
            let middle = (a + b) * 0.5;
            let foot = self.faces.project(&middle, None, self.depth, |_| true);
            // Where both sides end together nothing sinks in.
            foot.is_some_and(|foot| {
                -foot.signed_distance - penetration > least * self.size
                    && !edges::at_border(&foot)
                    && !edges::flush_with(&middle, &(b - a), &self.faces, self.size)
            })
        })
    }
}

impl EdgeWatch {
    /// The edges of the masters of the pairs `may`, which may become slaves in another variant of the run.
    pub fn new(model: &Model, may: &[usize]) -> Self {
        if model.small.is_some() || model.dynamics.is_some() {
            return EdgeWatch::default();
        }
        EdgeWatch(may.iter().filter_map(|i| Watched::new(model, *i)).collect())
    }

    /// Whether any of them has sunk in at displacements `u`; `penetration` is the deepest of the points of every pair (length).
    pub fn sunk(&mut self, model: &Model, u: &[f64], penetration: &[f64]) -> bool {
        (self.0.iter_mut()).any(|w| w.sunk(model, u, penetration[w.pair]))
    }
}
