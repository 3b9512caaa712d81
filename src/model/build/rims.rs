//! The pairs of the rims of rigid surfaces, where contacts ask for them.
use super::super::error::{At, text};
use super::super::rims::{self, RimNodes, SlaveFaces};
use super::super::{ModelError, PairModel, SurfaceModel};
use super::Builder;
use super::contacts::Side;
use crate::contact::points::SlavePoint;
use crate::scene::{Contact, Gap, MasterSurface, Passes, Points};
use covact_geometry::Vec3;
use nalgebra::Point3;

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
        let slave = SlaveFaces {
            facets: &slave,
            position: &|n| self.nodes[n as usize],
            size: pair.element_size,
            offset: contact.offset,
        };
        let found = rims::points(surface, &slave, self.scene.solution.end_time)
            .at(|| format!("/surfaces/{}/motion", surface.name))?;
        Ok(found.into_iter().map(|(p, piece)| (p.x, piece)).collect())
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
