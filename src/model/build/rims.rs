//! The pairs of the rims of rigid surfaces, where contacts ask for them.
use super::super::error::{At, text};
use super::super::rims::{self, RimNodes};
use super::super::{ModelError, PairModel, SurfaceModel};
use super::Builder;
use super::contacts::Side;
use crate::contact::points::SlavePoint;
use crate::scene::{Contact, Gap, MasterSurface, Passes, Points};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Point3};

/// How far from the box around the slave's faces a rim may come near them, as a part of its diagonal: bodies move as well.
const NEAR: f64 = 0.5;
/// Places of a motion that are looked at, besides its kinks.
const PLACES: usize = 64;

/// The surroundings of a slave: its box, and as much around it as it may move.
struct Near {
    low: Vec3,
    high: Vec3,
}

impl Near {
    fn new(places: impl Iterator<Item = Vec3>, offset: f64) -> Self {
        let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vec3::repeat);
        let [low, high] = places.fold(start, |[low, high], x| [low.inf(&x), high.sup(&x)]);
        let grown = Vec3::repeat(NEAR * (high - low).norm() + offset);
        Near {
            low: low - grown,
            high: high + grown,
        }
    }

    fn holds(&self, x: &Point3<f64>) -> bool {
        (0..3).all(|c| self.low[c] <= x[c] && x[c] <= self.high[c])
    }
}

impl Builder<'_> {
    /// The pairs of rims of rigid surfaces with the slaves of contacts; adds the nodes on them.
    pub(super) fn rims(
        &mut self,
        pairs: &[PairModel],
        surfaces: &[SurfaceModel],
    ) -> Result<Vec<PairModel>, ModelError> {
        let mut out = Vec::new();
        for (of, pair) in pairs.iter().enumerate() {
            let contact = &self.scene.contacts[&pair.name];
            let asked = contact.passes == Passes::Edges;
            let Some(index) = pair.rigid_master().filter(|_| asked) else {
                continue;
            };
            let surface = &surfaces[index];
            if self.scene.surfaces[&surface.name].motion.free.is_some() {
                let message = format!(
                    "the edges of surface `{}`, which is driven by force, cannot be slaves yet",
                    surface.name
                );
                let pointer = format!("/contacts/{}/passes", pair.name);
                let help = "leave `passes` out, or prescribe the motion of the surface";
                return Err(text(pointer, message).help(help));
            }
            let found = self.rim(contact, pair, surface)?;
            let (name, on) = (&pair.name, &surface.name);
            self.notes.push(match found.len() {
                0 => format!(
                    "contact `{name}`: no edge of surface `{on}` comes near `{}`, but those at its border: none are slaves",
                    contact.slave
                ),
                n => format!(
                    "contact `{name}`: {n} nodes on edges of surface `{on}` are slaves on `{}` as well",
                    contact.slave
                ),
            });
            if found.is_empty() {
                continue;
            }
            out.push(self.rim_pair(of, pair, index, (surface, found))?);
        }
        Ok(out)
    }

    /// Points on the rims of a surface that are slaves of a contact, with the length of rim around each; in the surface's own
    /// coordinates.
    fn rim(
        &self,
        contact: &Contact,
        pair: &PairModel,
        surface: &SurfaceModel,
    ) -> Result<Vec<(Vec3, f64)>, ModelError> {
        let slave = (self.moving_facets(pair.body, &pair.faces, false))
            .at(|| format!("/contacts/{}/slave", pair.name))?;
        let body = &self.bodies[pair.body];
        let nodes = pair.faces.iter().flat_map(|f| body.mesh.face_corners(*f));
        let places = nodes.map(|n| self.nodes[(n + body.first_node) as usize]);
        let near = Near::new(places, contact.offset);
        let poses = self.poses(surface)?;
        let mut found = rims::points(surface, &poses[0], &slave, pair.element_size);
        found.retain(|(p, _)| (poses.iter()).any(|pose| near.holds(&(pose * Point3::from(p.x)))));
        Ok(found.into_iter().map(|(p, piece)| (p.x, piece)).collect())
    }

    /// Where the motion of a surface puts it, at the start first.
    fn poses(&self, surface: &SurfaceModel) -> Result<Vec<Isometry3<f64>>, ModelError> {
        let end = self.scene.solution.end_time;
        let even = (0..=PLACES).map(|i| end * i as f64 / PLACES as f64);
        let functions = surface.motion.functions();
        let kinks = functions.flat_map(|f| f.breakpoints());
        let times = even.chain(kinks.filter(|t| (0.0..=end).contains(t)));
        let pose = |t: f64| surface.motion.pose(t);
        (times.map(pose).collect::<Result<_, _>>())
            .at(|| format!("/surfaces/{}/motion", surface.name))
    }

    /// The pair of a rim with the slave of pair `of`.
    fn rim_pair(
        &mut self,
        of: usize,
        pair: &PairModel,
        index: usize,
        (surface, found): (&SurfaceModel, Vec<(Vec3, f64)>),
    ) -> Result<PairModel, ModelError> {
        let contact = &self.scene.contacts[&pair.name];
        let pose =
            (surface.motion.pose(0.0)).at(|| format!("/surfaces/{}/motion", surface.name))?;
        let first_node = self.nodes.len() as u32;
        let width = 0.5 * pair.element_size;
        let mut points = Vec::with_capacity(found.len());
        for (node, (x, length)) in (first_node..).zip(&found) {
            self.nodes.push((pose * Point3::from(*x)).coords);
            points.push(SlavePoint::at_node(node, width * length));
        }
        // Flat faces turn the force of an edge back and forth as it passes over them.
        let smooth = self.moving_facets(pair.body, &pair.faces, true).is_ok();
        let back = Contact {
            slave: contact.master.clone(),
            master: contact.slave.clone(),
            points: Points::Nodes,
            gap: Gap::Pointwise,
            master_surface: smooth.then_some(MasterSurface::Smooth),
            depth: None,
            ..contact.clone()
        };
        let side = Side::Rim {
            body: pair.body,
            points,
        };
        let made = self.pair(&pair.name, &back, None, side)?;
        self.rims.push(RimNodes {
            surface: index,
            first_node,
            points: found.into_iter().map(|(x, _)| x).collect(),
        });
        Ok(PairModel {
            edges_of: Some(of),
            ..made
        })
    }
}
