//! How deep rigid surfaces sink into slave faces between the slave points, as steps are accepted.
//!
//! A round tool of radius `R` sinks `s^2 / (8 R)` into a flat face between two points that are `s` apart, and farther where it does not
//! lie over one of them. Against the way by which the slave is deformed that is about the part that forces are off by, and
//! where the tool is not over a point in the middle they point to a side, too.
//!
//! Forces that lean aside ([`super::aside`]) are looked at besides: where the slave is deformed by much, or carried by few points, they
//! tell more.
//!
//! A sheet's own surface is no polygon, but its points are as far apart; what leans aside is not looked at there.
//!
//! That way is the longest so far: where a tool is drawn back forces are small, and so is what they are off by. While it grows it is
//! taken to go on as in the last step until the end, so that a run is not given up for its first touch.
use super::aside::{Lean, Leaning, is_smooth};
use super::deformed;
use crate::contact::lever::Lever;
use crate::fem::face::Quad;
use crate::fem::quadrature::{MAX_POINTS, Rule, lobatto};
use crate::mesh::nurbs::{SheetPoint, side};
use crate::mesh::{Face, Mesh};
use crate::model::Model;
use crate::model::build::SHEET_POINTS;
use crate::model::error::number;
use crate::model::state::State;
use crate::run::bearing::Bearing;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::scene::Points;
use covact_geometry::{Foot, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Part of the way by which the slave is deformed that a surface may sink in between slave points.
const SUNK: f64 = 0.02;
/// Part of the force that may act aside.
const ASIDE: f64 = 0.05;
/// Part of what is worth a run of its own that is taken along.
const ALONG: f64 = 0.5;
/// Part of the force at sharp edges and borders of a surface from which on nothing is known of its direction.
const ON_RIMS: f64 = 0.5;
/// Part of the slave's elements below which a depth says nothing, however little the slave is deformed.
const NOTHING: f64 = 1e-3;
/// Angle between the normals at neighbouring places from which on an edge lies between them (radians), as of sharp edges elsewhere.
const EDGE: f64 = 0.5;

/// Faces around a node that no border goes through.
const INSIDE: u32 = 4;

/// The pairs that are looked at.
#[derive(Debug, Default)]
pub(in crate::run) struct Between {
    watched: Vec<Watched>,
    end: f64,
}

/// A pair with a rigid master.
#[derive(Debug)]
struct Watched {
    pair: usize,
    /// It may have more slave points in another variant of the run.
    may: bool,
    /// Places on every face that its points see least, along each of its parameters.
    places: Rule,
    /// Per face how far it lies off the curved surface that it stands for (length).
    bulges: Vec<f64>,
    /// Nodes of the slave faces.
    nodes: Vec<u32>,
    /// None where points have no normals of their own.
    leaning: Option<Leaning>,
    travel: Travel,
}

/// How far a pair has got.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::run) struct Travel {
    /// The way by which the slave is deformed at the last accepted step, and the longest so far (length).
    way: f64,
    longest: f64,
    /// How deep the surface has sunk in, and the same as a part of the longest way, at the last accepted step.
    last: [f64; 2],
    /// The same where the way was the longest.
    at_longest: [f64; 2],
    /// What of its force acts aside.
    lean: Lean,
}

impl Travel {
    pub fn put(&self, out: &mut Writer) {
        let Travel {
            way,
            longest,
            last,
            at_longest,
            lean,
        } = self;
        for x in [way, longest].into_iter().chain(last).chain(at_longest) {
            out.f64(*x);
        }
        lean.put(out);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut x = [0.0; 6];
        from.f64s(&mut x)?;
        let [way, longest, a, b, c, d] = x;
        Ok(Travel {
            way,
            longest,
            last: [a, b],
            at_longest: [c, d],
            lean: Lean::take(from)?,
        })
    }

    /// Goes on by a step of size `dt` to a way, where the surface has sunk in by `own`. Returns that as a part of the way that is to be
    /// expected in the time that is `left`.
    fn goes(&mut self, way: f64, own: f64, [dt, left]: [f64; 2]) -> f64 {
        let growth = (way - self.way).max(0.0) / dt;
        self.way = way;
        let is_longest = way >= self.longest;
        self.longest = self.longest.max(way);
        let part = |of: f64| if own > 0.0 { own / of } else { 0.0 };
        self.last = [own, part(self.longest)];
        if is_longest {
            self.at_longest = self.last;
        }
        part(self.longest.max(way + growth * left.max(0.0)))
    }

    /// Where it is off the most, of the last step and the one with the longest way.
    fn worst(&self) -> [f64; 2] {
        match self.last[1] >= self.at_longest[1] {
            true => self.last,
            false => self.at_longest,
        }
    }
}

/// Places on a face that slave points of a kind see least. `nodes`: points that stand for a face's nodes, where it has others.
fn places(points: Points, nodes: Option<usize>) -> Option<Rule> {
    let between = |gauss: usize| (gauss + 2).min(MAX_POINTS);
    let n = match points {
        Points::Auto | Points::Nodes => nodes.map_or(5, between),
        Points::Gauss(n) => between(n as usize),
        Points::Lobatto(n) => n as usize + 1,
        Points::Segments(_) => return None,
    };
    lobatto(n).ok()
}

/// Per face how far its middle lies off the curved surface through its nodes, by their normals: twice an edge's `L (m - n) / 8` at most.
fn bulges(mesh: &Mesh, faces: &[Face]) -> Vec<f64> {
    let mut normals: HashMap<u32, Vec3> = HashMap::new();
    for face in faces {
        let all = mesh.face_nodes(*face);
        let normal = Quad::new(&all, |n| mesh.nodes[n as usize]).area_vector(0.0, 0.0);
        for node in all.nodes() {
            *normals.entry(*node).or_insert_with(Vec3::zeros) += normal;
        }
    }
    let edge = |[a, b]: [u32; 2]| {
        let [n, m] = [a, b].map(|node| normals[&node].try_normalize(0.0).unwrap_or_default());
        let along = mesh.nodes[b as usize] - mesh.nodes[a as usize];
        along.dot(&(m - n)).abs() / 8.0
    };
    let own: Vec<f64> = (faces.iter())
        .map(|face| {
            let [a, b, c, d] = mesh.face_corners(*face);
            edge([a, b]).max(edge([c, d])) + edge([a, c]).max(edge([b, d]))
        })
        .collect();
    // At a border the normal is that of the face alone, which knows half of its curvature there.
    let mut around: HashMap<u32, (u32, f64)> = HashMap::new();
    for (face, bulge) in faces.iter().zip(&own) {
        for node in mesh.face_corners(*face) {
            let (count, most) = around.entry(node).or_insert((0, 0.0));
            (*count, *most) = (*count + 1, most.max(*bulge));
        }
    }
    (faces.iter().zip(&own))
        .map(|(face, bulge)| {
            let corners = mesh.face_corners(*face).map(|node| around[&node]);
            match corners.iter().any(|(count, _)| *count < INSIDE) {
                true => corners
                    .iter()
                    .fold(*bulge, |most, (_, near)| most.max(*near)),
                false => *bulge,
            }
        })
        .collect()
}

/// Whether the normals at the feet of neighbouring places on a face, which lie on a square grid, differ as at an edge.
fn bent(feet: &[Option<Foot>]) -> bool {
    let n = feet.len().isqrt();
    let apart = |a: usize, b: usize| match (&feet[a], &feet[b]) {
        (Some(a), Some(b)) => a.normal.dot(&b.normal) < EDGE.cos(),
        _ => false,
    };
    (0..n * n).any(|k| k % n + 1 < n && apart(k, k + 1) || k + n < n * n && apart(k, k + n))
}

impl Watched {
    fn new(model: &Model, pair: usize, may: bool) -> Option<Self> {
        let own = &model.pairs[pair];
        own.rigid_master()?;
        let body = &model.bodies[own.body];
        if own.faces.is_empty() || own.edges_of.is_some() {
            return None;
        }
        let sheet = body.block.sheet();
        let of_face = |f: &Face| match sheet {
            Some(_) => body.mesh.element(f.element as usize).to_vec(),
            None => body.mesh.face_nodes(*f).nodes().to_vec(),
        };
        let mut nodes: Vec<u32> = (own.faces.iter())
            .flat_map(of_face)
            .map(|n| n + body.first_node)
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        Some(Watched {
            pair,
            may,
            places: places(own.sampled, sheet.map(|_| SHEET_POINTS))?,
            bulges: match sheet {
                // Its elements follow its own surface.
                Some(_) => vec![0.0; own.faces.len()],
                None => bulges(&body.mesh, &own.faces),
            },
            nodes,
            leaning: match sheet {
                Some(_) => None,
                None => Leaning::new(model, pair),
            },
            travel: Travel::default(),
        })
    }

    /// How deep the surface is in the faces at displacements `u` and time `to` (length).
    fn depth(&self, model: &Model, u: &[f64], to: f64) -> Option<f64> {
        let pair = &model.pairs[self.pair];
        let surface = &model.surfaces[pair.rigid_master()?];
        let master = surface.at(to, u).ok()?;
        let faces = pair.faces.par_iter().zip(&self.bulges);
        let deepest = faces.map_init(Default::default, |room, (face, bulge)| {
            let (points, feet): &mut (Vec<Vec3>, Vec<Option<Foot>>) = room;
            let near = |middle: &Vec3, size: f64| {
                let reach = size + pair.offset + surface.depth;
                (master.foot(middle, None, reach).is_some()).then_some(reach)
            };
            points.clear();
            let Some(reach) = self.points_near(model, *face, u, near, points) else {
                return 0.0;
            };
            feet.clear();
            feet.extend(points.iter().map(|point| master.foot(point, None, reach)));
            // A face that lies across an edge is bent around it, which is another question.
            if bent(feet) {
                return 0.0;
            }
            let seen = feet.iter().flatten().filter(|foot| is_smooth(foot));
            let depths = seen.map(|foot| pair.offset - foot.signed_distance);
            let near = depths.filter(|depth| *depth < surface.depth);
            near.fold(0.0, |most: f64, depth| most.max(depth - bulge))
        });
        Some(deepest.reduce(|| 0.0, f64::max))
    }

    /// Adds the places on a face, at displacements `u`, where `near` gives the reach of what may lie near its middle, of which its
    /// corners are so far away.
    fn points_near(
        &self,
        model: &Model,
        face: Face,
        u: &[f64],
        near: impl Fn(&Vec3, f64) -> Option<f64>,
        points: &mut Vec<Vec3>,
    ) -> Option<f64> {
        let body = &model.bodies[model.pairs[self.pair].body];
        let at = |n: u32| model.position((n + body.first_node) as usize, u);
        let Some(sheet) = body.block.sheet() else {
            let quad = Quad::new(&body.mesh.face_nodes(face), at);
            let middle = quad.point(0.0, 0.0);
            let reach = near(&middle, (quad.nodes[0] - middle).norm())?;
            let line = self.places.points();
            points.extend((line.iter()).flat_map(|u| line.iter().map(|v| quad.point(*u, *v))));
            return Some(reach);
        };
        let controls = body.mesh.element(face.element as usize);
        let middle = controls.iter().map(|n| at(*n)).sum::<Vec3>() / controls.len() as f64;
        let size = (controls.iter()).fold(0.0f64, |most, n| most.max((at(*n) - middle).norm()));
        let reach = near(&middle, size + sheet.thickness)?;
        let height = 0.5 * sheet.thickness * side(face).unwrap_or(1.0);
        let sampled = sheet.sampled(std::iter::once(face.element as usize), &self.places);
        points.extend(sampled.into_iter().map(|SheetPoint { nodes, n, n_i, .. }| {
            let lever = Lever {
                nodes,
                n,
                n_i,
                height,
            };
            lever.position(at)
        }));
        Some(reach)
    }

    /// Looks at an accepted step, from time `from` to `to`. Returns how far off it is, as a multiple of what is worth a run of its own
    /// with more slave points.
    fn looks(
        &mut self,
        model: &Model,
        state: &State,
        [from, to, end]: [f64; 3],
        ([penetration, penalty], at_rims): ([f64; 2], f64),
    ) -> f64 {
        let u = &state.u[..];
        let size = model.pairs[self.pair].element_size;
        let depth = match model.pairs[self.pair].points.is_empty() {
            true => None,
            false => self.depth(model, u, to),
        };
        // What is left of an overclosure at the start is not to be seen as an overlap, at the points either.
        let over = (model.pairs[self.pair].overclosure.as_ref()).map_or(0.0, |o| {
            o.factor(to) * o.z0.iter().fold(0.0f64, |most, z0| most.max(-z0))
        });
        let own = depth.map_or(0.0, |depth| depth - penetration - over);
        let own = if own > NOTHING * size { own } else { 0.0 };
        let way = deformed(&self.nodes, u).max(own);
        let part = self.travel.goes(way, own, [to - from, end - to]);
        // At a sharp edge or a border of the surface no normal is to be expected.
        let leaning = self.leaning.as_ref().filter(|_| at_rims < ON_RIMS);
        let forces = leaning.and_then(|l| l.forces(model, self.pair, (state, to), penalty));
        let aside = forces.map_or(0.0, |forces| self.travel.lean.goes(forces, [from, to, end]));
        (part / SUNK).max(aside / ASIDE)
    }
}

impl Between {
    /// The pairs with rigid masters, of which those in `may` may have more slave points in another variant of the run, until the time
    /// `end`.
    pub fn new(model: &Model, end: f64, may: &[usize]) -> Self {
        if model.small.is_some() || model.dynamics.is_some() {
            return Between::default();
        }
        let pairs = 0..model.pairs.len();
        Between {
            watched: pairs
                .filter_map(|i| Watched::new(model, i, may.contains(&i)))
                .collect(),
            end,
        }
    }

    /// Looks at an accepted step; the pairs of which more slave points are worth a run of their own.
    pub fn look(
        &mut self,
        model: &Model,
        state: &State,
        [from, to]: [f64; 2],
        ((penetration, bearings), penalties): ((&[f64], &[Bearing]), &[f64]),
    ) -> Vec<usize> {
        let end = self.end;
        let mut found = Vec::new();
        for watched in &mut self.watched {
            let own = [penetration, penalties].map(|of| of[watched.pair]);
            // What edges of the surface carry is force of the contact, at rims.
            let of_edges = (model.pairs.iter().zip(bearings))
                .filter(|(pair, _)| pair.edges_of == Some(watched.pair))
                .map(|(_, bearing)| bearing.force)
                .sum::<f64>();
            let bearing = &bearings[watched.pair];
            let at_rims = match bearing.force + of_edges {
                force if force > 0.0 => (bearing.at_rims + of_edges) / force,
                _ => 0.0,
            };
            let off = watched.looks(model, state, [from, to, end], (own, at_rims));
            if watched.may {
                found.push((watched.pair, off));
            }
        }
        // A run is given up once: what is half as far off comes along.
        let enough = match found.iter().any(|(_, off)| *off > 1.0) {
            true => ALONG,
            false => f64::INFINITY,
        };
        found.retain(|(_, off)| *off > enough);
        found.into_iter().map(|(pair, _)| pair).collect()
    }

    /// How far every pair has got.
    pub fn travels(&self, model: &Model) -> Vec<Travel> {
        let mut travels = vec![Travel::default(); model.pairs.len()];
        for watched in &self.watched {
            travels[watched.pair] = watched.travel;
        }
        travels
    }

    /// Goes on from there.
    pub fn go_on(&mut self, travels: &[Travel]) {
        for watched in &mut self.watched {
            watched.travel = travels[watched.pair];
        }
    }

    /// What is told at the end of surfaces that have sunk in there.
    pub fn warnings(&self, model: &Model) -> Vec<String> {
        let (sunk, others): (Vec<_>, Vec<_>) =
            (self.watched.iter()).partition(|w| w.travel.worst()[1] > SUNK);
        let aside = others.into_iter().filter_map(|w| {
            let [part, time] = w.travel.lean.part();
            (part > ASIDE).then(|| {
                format!(
                    "contact `{}`: up to {:.0} % of its force act aside (at time {}), since {} turns between its slave points, few of which \
                     carry: forces may be off by as much. Take more `points` a face, or a finer mesh",
                    model.pairs[w.pair].name,
                    100.0 * part,
                    number(time),
                    model.pairs[w.pair].master_words(model),
                )
            })
        });
        let sunk = sunk.into_iter().map(|w| {
            let pair = &model.pairs[w.pair];
            let [own, part] = w.travel.worst();
            format!(
                "contact `{}`: {} sinks {} into `{}` between its slave points, {:.0} % of what these faces are deformed by: forces may be \
                 off by as much, and point to a side. Take more `points` a face, or a finer mesh",
                pair.name,
                pair.master_words(model),
                number(own),
                pair.slave,
                100.0 * part
            )
        });
        sunk.chain(aside).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tool that goes to its depth, stays there, and is drawn back, with the same part of the way between points throughout.
    #[test]
    fn the_way_that_is_expected_follows_the_last_step() {
        let mut travel = Travel::default();
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        // A tenth of the way to go, and half of it.
        near(travel.goes(0.1, 0.03, [0.1, 0.9]), 0.03);
        near(travel.goes(0.5, 0.03, [0.4, 0.5]), 0.03);
        // It stays: nothing more is to be expected.
        near(travel.goes(0.5, 0.03, [0.1, 0.4]), 0.06);
        // Drawn back, the longest way counts, at the end as well.
        near(travel.goes(0.1, 0.02, [0.1, 0.3]), 0.04);
        assert_eq!(travel.goes(0.01, 0.0, [0.1, 0.0]), 0.0);
        let [own, part] = travel.worst();
        near(own, 0.03);
        near(part, 0.06);
        // From a checkpoint.
        let mut out = Writer::default();
        travel.put(&mut out);
        let back = Travel::take(&mut Reader::new(out.bytes())).unwrap();
        assert_eq!(back, travel);
    }
}
