//! How far aside the normal forces of slave points act on a rigid surface that turns between them.
//!
//! A point is pressed along the normal of the surface, which at single points of a coarse slave on a round tool of radius `R`
//! leans by up to `s / (2 R)` against the slave's own normal, `s` being the distance of points. Where two smooth surfaces touch
//! their normals are opposite. Over many points the leanings cancel; where few carry, their sum is about what the force is
//! wrong by to a side, however little the tool sinks in beside the way by which the slave is deformed. Of what the slave's own
//! roundness adds to it nothing is wrong: no more counts than what the surface turns by within half the distance of points.
//!
//! Nothing is known at folds of the slave and at edges of the surface, and at a border of the slave nothing across it: there the
//! surface may press on a rim.
use crate::contact::law::{NormalLaw, PairLaw, Penalty};
use crate::model::state::State;
use crate::model::{Model, sharp};
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use covact_geometry::{EdgeKind, Foot, Location, Vec3};
use std::collections::HashMap;

/// Sine of the angle between the normals of slave and surface from which on they do not touch as smooth surfaces do.
const LEANING: f64 = 0.35;
/// Cosine of the angle between faces around a node below which they meet in a fold, as of sharp edges elsewhere.
const FOLD: f64 = 0.88;
/// Shape functions below this do not make a point one of a node.
const NEAR: f64 = 0.05;

/// Slave faces of a pair, and which of their nodes lie where.
#[derive(Debug)]
pub(super) struct Leaning {
    /// Numbers in the model of the corners of every face, in the order of their parameters.
    corners: Vec<[u32; 4]>,
    /// Faces around every node.
    around: HashMap<u32, Vec<u32>>,
    /// Half the distance of slave points (length).
    half: f64,
    /// Edges of one face, with the corner of it that lies opposite to their first node.
    borders: Vec<[u32; 3]>,
}

/// What of the normal force of a pair acts aside, step by step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::run) struct Lean {
    /// The normal force at the last accepted step, and the largest so far (force).
    force: f64,
    largest: f64,
    /// The most of it that acted aside, and when (force).
    worst: f64,
    time: f64,
}

impl Lean {
    pub fn put(&self, out: &mut Writer) {
        let Lean {
            force,
            largest,
            worst,
            time,
        } = self;
        for x in [force, largest, worst, time] {
            out.f64(*x);
        }
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut x = [0.0; 4];
        from.f64s(&mut x)?;
        let [force, largest, worst, time] = x;
        Ok(Lean {
            force,
            largest,
            worst,
            time,
        })
    }

    /// Goes on by a step from `from` to `to` to a force of which `aside` acts to a side. Returns that as a part of the largest force
    /// to be expected until `end`, if it grows as in this step.
    pub(super) fn goes(&mut self, [force, aside]: [f64; 2], [from, to, end]: [f64; 3]) -> f64 {
        let growth = (force - self.force).max(0.0) / (to - from);
        self.force = force;
        self.largest = self.largest.max(force);
        if aside > self.worst {
            (self.worst, self.time) = (aside, to);
        }
        let expected = self.largest.max(force + growth * (end - to).max(0.0));
        if aside > 0.0 { aside / expected } else { 0.0 }
    }

    /// The most that acted aside as a part of the largest force, and when.
    pub(super) fn part(&self) -> [f64; 2] {
        match self.worst > 0.0 {
            true => [self.worst / self.largest, self.time],
            false => [0.0; 2],
        }
    }
}

impl Leaning {
    /// The slave faces of a pair whose points are its own; none where gaps are averaged.
    pub fn new(model: &Model, pair: usize) -> Option<Self> {
        let own = &model.pairs[pair];
        if own.averaged.is_some() {
            return None;
        }
        let body = &model.bodies[own.body];
        let mut out = Leaning {
            corners: Vec::with_capacity(own.faces.len()),
            around: HashMap::new(),
            half: 0.5 * sharp::spacing(model, own),
            borders: Vec::new(),
        };
        let mut edges: HashMap<[u32; 2], (u32, [u32; 3])> = HashMap::new();
        for (number, face) in own.faces.iter().enumerate() {
            let corners = body.mesh.face_corners(*face).map(|n| n + body.first_node);
            out.corners.push(corners);
            for node in body.mesh.face_nodes(*face).nodes() {
                let around = out.around.entry(node + body.first_node).or_default();
                around.push(number as u32);
            }
            let [a, b, c, d] = corners;
            for [p, q, inner] in [[a, b, c], [c, d, a], [a, c, b], [b, d, a]] {
                let key = [p.min(q), p.max(q)];
                edges.entry(key).or_insert((0, [p, q, inner])).0 += 1;
            }
        }
        let of_one = edges.into_values().filter(|(faces, _)| *faces == 1);
        out.borders = of_one.map(|(_, edge)| edge).collect();
        out.borders.sort_unstable();
        Some(out)
    }

    /// The normal force of pair `pair` at an accepted state, and the size of what of it acts aside (force); nothing where most of
    /// it acts where nothing is known.
    pub fn forces(
        &self,
        model: &Model,
        pair: usize,
        (state, time): (&State, f64),
        penalty: f64,
    ) -> Option<[f64; 2]> {
        let own = &model.pairs[pair];
        let master = model.surfaces[own.rigid_master()?]
            .at(time, &state.u)
            .ok()?;
        let first: usize = (0..pair).map(|i| state.slaves(model, i).len()).sum();
        let histories = state.history(model, pair).map(|r| &state.histories[r]);
        let offsets = own.offsets(time);
        let law = Penalty::of(penalty);
        let mut slave = None;
        let (mut all, mut known, mut sum) = (0.0, 0.0, Vec3::zeros());
        for (i, p) in state.slaves(model, pair).iter().enumerate() {
            let at = &state.points[first + i];
            if !at.closed || p.lever_number().is_some() {
                continue;
            }
            let x = model.point_position(p, &state.u);
            let Some(foot) = master.foot(&x, at.hint, f64::INFINITY) else {
                continue;
            };
            let z0 = offsets.map_or(0.0, |o| o.at(i));
            let n = match histories {
                Some(histories) => histories[i].n,
                None => law.response(foot.signed_distance - z0).n,
            };
            let force = (-n * p.area).max(0.0);
            all += force;
            let slave = slave.get_or_insert_with(|| SlaveNormals::new(self, model, &state.u));
            let tool = master.pose.rotation * foot.normal;
            let Some(leaning) = slave.leaning(p.terms(), &tool).filter(|_| is_smooth(&foot)) else {
                continue;
            };
            known += force;
            // Where the slave alone is round, the surface is right about the direction.
            if let Some(along) = leaning.try_normalize(0.0) {
                let beside =
                    master.foot(&(x - along * self.half), Some(foot.hint()), f64::INFINITY);
                let normal = beside.map_or(tool, |foot| master.pose.rotation * foot.normal);
                let turns = along.dot(&(tool - normal)).max(0.0);
                sum += along * (leaning.norm().min(turns) * force);
            }
        }
        (known > 0.5 * all || all == 0.0).then_some([all, sum.norm()])
    }
}

/// Whether a surface is smooth around a foot.
pub(super) fn is_smooth(foot: &Foot) -> bool {
    match foot.location {
        Location::Face => true,
        Location::Edge { kind, .. } => kind == EdgeKind::Smooth,
        _ => false,
    }
}

/// Normals of the slave at its nodes, and directions across its border there.
struct SlaveNormals {
    /// None at folds.
    at: HashMap<u32, Option<Vec3>>,
    outward: HashMap<u32, Vec<Vec3>>,
}

impl SlaveNormals {
    fn new(of: &Leaning, model: &Model, u: &[f64]) -> Self {
        let x = |n: u32| model.position(n as usize, u);
        let normal = |[a, b, c, d]: &[u32; 4]| (x(*d) - x(*a)).cross(&(x(*c) - x(*b)));
        let normals: Vec<Vec3> = of.corners.iter().map(normal).collect();
        let mean = |faces: &Vec<u32>| {
            let own = faces.iter().map(|f| normals[*f as usize]);
            let mean = own.clone().sum::<Vec3>().try_normalize(0.0)?;
            let flat = |n: Vec3| n.dot(&mean) > FOLD * n.norm();
            own.clone().all(flat).then_some(mean)
        };
        let mut outward: HashMap<u32, Vec<Vec3>> = HashMap::new();
        for [p, q, inner] in &of.borders {
            let along = (x(*q) - x(*p)).try_normalize(0.0).unwrap_or_default();
            let out = x(*p) - x(*inner);
            let out = (out - along * along.dot(&out)).try_normalize(0.0);
            for node in [p, q] {
                outward.entry(*node).or_default().extend(out);
            }
        }
        SlaveNormals {
            at: (of.around.iter())
                .map(|(node, faces)| (*node, mean(faces)))
                .collect(),
            outward,
        }
    }

    /// The part of a surface's normal along the slave at a point of these nodes, zero where normals are opposite; none where
    /// they do not touch as smooth surfaces do.
    fn leaning(&self, terms: impl Iterator<Item = (usize, f64)>, tool: &Vec3) -> Option<Vec3> {
        let near = terms.filter(|(_, w)| w.abs() > NEAR);
        let near: Vec<(u32, f64)> = near.map(|(node, w)| (node as u32, w)).collect();
        let mut own = Vec3::zeros();
        for (node, w) in &near {
            own += (*self.at.get(node)?)? * *w;
        }
        let own = own.try_normalize(0.0)?;
        let mut leaning = tool - own * own.dot(tool);
        for (node, _) in &near {
            for out in self.outward.get(node).into_iter().flatten() {
                leaning -= out * out.dot(&leaning);
            }
        }
        (own.dot(tool) < 0.0 && leaning.norm() < LEANING).then_some(leaning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_aside_is_one_of_the_force_to_be_expected() {
        let mut lean = Lean::default();
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        // A tenth of the way: ten times the force is to come.
        near(lean.goes([10.0, 1.0], [0.0, 0.1, 1.0]), 0.01);
        near(lean.goes([50.0, 4.0], [0.1, 0.5, 1.0]), 0.04);
        // It falls: the largest force counts.
        near(lean.goes([20.0, 3.0], [0.5, 0.75, 1.0]), 0.06);
        assert_eq!(lean.goes([0.0, 0.0], [0.75, 1.0, 1.0]), 0.0);
        let [part, time] = lean.part();
        near(part, 0.08);
        assert_eq!(time, 0.5);
        let mut out = Writer::default();
        lean.put(&mut out);
        assert_eq!(Lean::take(&mut Reader::new(out.bytes())).unwrap(), lean);
    }
}
