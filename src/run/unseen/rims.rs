//! Edges of rigid surfaces that are no slaves, as steps are accepted: one that sinks in between slave points is seen by none of them.
use crate::model::build::master_faces;
use crate::model::error::number;
use crate::model::master::moving_facets;
use crate::model::rims::{self, SlaveFaces};
use crate::model::{Model, edges, penalty};
use crate::run::bearing::Bearing;
use covact_geometry::project::RimPoint;
use covact_geometry::{MovingFacets, Vec3};
use nalgebra::Point3;

/// An edge that is deeper in the slave than the first part of the slave's elements, or the second of the slave's way where that is less,
/// has sunk in. Less is what any faces that are flat between their nodes do.
const SUNK: [f64; 2] = [0.05, 0.02];
/// Part of the slave's elements below which a depth says nothing, however short the slave's way is.
const NOTHING: f64 = 1e-4;
/// Cosine of the angle between the slave's normal and that of either side of an edge, about .2, above which the slave lies on that
/// side. A point that happens to lie on the edge is pushed along the normal of one side, wherever the slave is bent to.
const BENT: f64 = 0.98;

/// The edges of all rigid surfaces that may sink in.
#[derive(Debug, Default)]
pub(in crate::run) struct RimWatch(Vec<Watched>);

/// The edges of the master of a pair.
#[derive(Debug)]
struct Watched {
    pair: usize,
    /// Points on them, in the surface's own coordinates.
    points: Vec<RimPoint>,
    /// The slave's faces, the size of their elements, and how deep below them edges are looked for (length).
    faces: MovingFacets,
    size: f64,
    depth: f64,
    /// They may become slaves in another run.
    may: bool,
}

/// Cosine of the angle between a point's contact normal and the slave's own, from behind, below which the master does not press against
/// the slave there but along it, and the part of a contact's force above which that counts.
const ASIDE: f64 = 0.5;
const COUNTS: f64 = 0.1;

/// Part of a contact's force near edges from which what they carry decides about it.
const DECIDES: f64 = 0.5;

/// An edge that has sunk in.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::run) struct Sunk {
    /// Number of the pair.
    pub pair: usize,
    /// The edge may become a slave in another run.
    pub may: bool,
    /// It is a tip.
    tip: bool,
    depth: f64,
    at: Vec3,
}

impl Watched {
    /// The edges of the master of pair `index`; none where it has no such edges, or they are slaves already.
    fn new(model: &Model, index: usize, (end, may): (f64, bool)) -> Option<Self> {
        let pair = &model.pairs[index];
        let surface = &model.surfaces[pair.rigid_master()?];
        let slave = &model.bodies[pair.body];
        let has = |p: &crate::model::PairModel| p.edges_of == Some(index);
        if slave.block.sheet().is_some() || model.pairs.iter().any(has) {
            return None;
        }
        let start = |n: u32| model.nodes[n as usize];
        let faces = moving_facets(&slave.mesh, slave.first_node, &pair.faces, false, start).ok()?;
        let at_start = SlaveFaces {
            facets: &faces,
            position: &start,
            size: pair.element_size,
            offset: pair.offset,
        };
        let points = rims::points(surface, &at_start, end).ok()?;
        let points: Vec<RimPoint> = points.into_iter().map(|(p, _)| p).collect();
        let master = master_faces::check(&slave.mesh, &pair.faces, &pair.slave);
        (!points.is_empty()).then(|| Watched {
            pair: index,
            points,
            size: pair.element_size,
            // A point that leaves the surface may let an edge in at once.
            depth: (penalty::face_size(&slave.mesh, &pair.faces).depth).max(pair.element_size),
            faces,
            may: may && master.is_ok(),
        })
    }

    /// The point that is deepest in the slave, and how deep, at displacements `u`; none where none has sunk in, or where most of the
    /// force acts elsewhere. `penetration`: the deepest of the slave's own points (length).
    fn sunk(
        &mut self,
        model: &Model,
        u: &[f64],
        time: f64,
        (penetration, bearing): (f64, &Bearing),
    ) -> Option<Sunk> {
        let pair = &model.pairs[self.pair];
        if bearing.at_rims < DECIDES * bearing.force {
            return None;
        }
        // A contact that does not act in a stage has no points.
        if pair.points.is_empty() {
            return None;
        }
        let pose = model.surfaces[pair.rigid_master()?].pose(time, u).ok()?;
        self.faces.update(|n| model.position(n as usize, u));
        let mut deepest: Option<(f64, Vec3, bool)> = None;
        let mut bent = false;
        for point in &self.points {
            let at = (pose * Point3::from(point.x)).coords;
            let foot = self.faces.project(&at, None, self.depth, |_| true);
            let Some(foot) = foot.filter(|f| !edges::at_border(f)) else {
                continue;
            };
            let depth = -foot.signed_distance;
            // The slave is bent around the edge where it is opposed to neither side.
            let opposed = |n: &Vec3| -(pose * n).dot(&foot.normal) > BENT;
            bent |= depth - penetration > NOTHING * self.size && !point.normals.iter().any(opposed);
            if deepest.is_none_or(|(d, ..)| depth > d) {
                deepest = Some((depth, at, point.along == Vec3::zeros()));
            }
        }
        let (depth, at, tip) = deepest?;
        let way = || {
            let facets = 0..self.faces.len() as u32;
            let nodes = facets.flat_map(|f| self.faces.nodes(f));
            let way = |n: &u32| {
                let at = 3 * *n as usize;
                Vec3::new(u[at], u[at + 1], u[at + 2]).norm()
            };
            nodes.map(way).fold(0.0, f64::max)
        };
        let own = depth - penetration;
        let sunk = bent
            || own > NOTHING * self.size && own > (SUNK[0] * self.size).min(SUNK[1] * way())
            || self.aside(bearing);
        sunk.then_some(Sunk {
            pair: self.pair,
            may: self.may,
            tip,
            depth,
            at,
        })
    }

    /// Whether a point of the slave has slipped off an edge onto a side of it that the slave does not face: a node exactly over an edge
    /// that goes down beside it is held along the slave, and lets the edge in between itself and the next one.
    fn aside(&self, bearing: &Bearing) -> bool {
        let strongest = bearing.at_edge.filter(|p| p.force > COUNTS * bearing.force);
        let Some(point) = strongest else { return false };
        let foot = self.faces.project(&point.x, None, self.depth, |_| true);
        // At the border of its faces the slave may be pushed aside.
        let foot = foot.filter(|f| !edges::at_border(f));
        foot.is_some_and(|f| -point.normal.dot(&f.normal) < ASIDE)
    }
}

impl RimWatch {
    /// The edges of all rigid surfaces of a model that may sink in until the time `end`; those of the pairs `may` may become slaves in
    /// another run.
    pub fn new(model: &Model, end: f64, may: &[usize]) -> Self {
        if model.small.is_some() || model.dynamics.is_some() {
            return RimWatch::default();
        }
        let pairs = 0..model.pairs.len();
        let watched = pairs.filter_map(|i| Watched::new(model, i, (end, may.contains(&i))));
        RimWatch(watched.collect())
    }

    /// The edges that have sunk in at displacements `u`; `penetration` is the deepest of the points of every pair (length), `bearings`
    /// what the points of every pair carry.
    pub fn sunk(
        &mut self,
        model: &Model,
        u: &[f64],
        time: f64,
        (penetration, bearings): (&[f64], &[Bearing]),
    ) -> Vec<Sunk> {
        let all = self.0.iter_mut();
        all.filter_map(|w| w.sunk(model, u, time, (penetration[w.pair], &bearings[w.pair])))
            .collect()
    }
}

impl Sunk {
    /// How a warning of it begins: each contact is told of once.
    pub fn head(&self, model: &Model) -> String {
        let pair = &model.pairs[self.pair];
        format!(
            "contact `{}`: {} of {} sinks into `{}` between its slave points",
            pair.name,
            if self.tip { "a tip" } else { "an edge" },
            pair.master_words(model),
            pair.slave
        )
    }

    /// What the user is told.
    pub fn told(&self, model: &Model, time: f64) -> String {
        format!(
            "{}, at time {} by {} near ({}, {}, {}): what it carries depends on where these lie. Round it, by two of their \
             spacings at least, or take a finer mesh{}",
            self.head(model),
            number(time),
            number(self.depth),
            number(self.at.x),
            number(self.at.y),
            number(self.at.z),
            match self.may {
                true => ", or `\"passes\": \"edges\"`",
                false => "",
            }
        )
    }
}
