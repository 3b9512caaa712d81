//! Faces of bodies as masters.
use super::super::{Builder, master_faces};
use crate::contact::points::SlavePoint;
use crate::mesh::Face;
use crate::model::error::{At, number, text};
use crate::model::master::{BodyMaster, moving_facets};
use crate::model::self_contact::OwnFacets;
use crate::model::{ModelError, penalty};
use crate::scene::{Contact, MasterSurface, Passes};
use covact_geometry::{MovingError, MovingFacets};
use penalty::Suitable;

impl Builder<'_> {
    /// [`moving_facets`] of a body of the model, where they start.
    pub(in crate::model::build) fn moving_facets(
        &self,
        body: usize,
        faces: &[Face],
        smooth: bool,
    ) -> Result<MovingFacets, MovingError> {
        let body = &self.bodies[body];
        moving_facets(&body.mesh, body.first_node, faces, smooth, |n| {
            self.nodes[n as usize]
        })
    }

    /// Faces of a body as a master, and the penalties that suit them.
    pub(super) fn body_master(
        &mut self,
        name: &str,
        contact: &Contact,
    ) -> Result<(BodyMaster, Suitable), ModelError> {
        let pointer = || format!("/contacts/{name}/master");
        let (body, faces) = self.contact_faces(name, &contact.master, &pointer())?;
        let (size, suits) = self.stiffness(body, &faces);
        let smooth = contact.master_surface == Some(MasterSurface::Smooth);
        let (facets, height) = match self.sheet_facets(body, &faces) {
            Some(facets) => facets.at(pointer)?,
            None => {
                master_faces::check(&self.bodies[body].mesh, &faces, &contact.master.to_string())
                    .map_err(|(message, help)| text(pointer(), message).help(help))?;
                (self.moving_facets(body, &faces, smooth).at(pointer)?, 0.0)
            }
        };
        let depth = contact.depth.unwrap_or(size.depth);
        self.notes.push(format!(
            "contact `{name}`: a point deeper than {} below `{}` is not in contact (`depth`)",
            number(depth),
            contact.master
        ));
        let master = BodyMaster {
            name: contact.master.to_string(),
            body,
            faces,
            facets,
            smooth,
            depth,
            element_size: size.edge,
            own: None,
            height,
        };
        Ok((master, suits))
    }

    /// Slave and master on one body: what is connected is no contact.
    pub(super) fn own_body(
        &mut self,
        name: &str,
        contact: &Contact,
        slave: &[Face],
        points: &mut [SlavePoint],
        master: &mut BodyMaster,
    ) -> Result<(), ModelError> {
        let body = &self.bodies[master.body];
        let faces = &master.faces;
        let common = slave.iter().filter(|f| faces.contains(f)).count();
        let equal = common == slave.len() && common == faces.len();
        if common > 0 && !equal {
            let message = format!(
                "`{}` and `{}` have {common} face(s) in common, {} and {} in all: these would be in contact with \
                 themselves",
                contact.slave,
                contact.master,
                slave.len(),
                faces.len()
            );
            return Err(text(format!("/contacts/{name}/master"), message).help(
                "for self contact give the same set as slave and as master, else two sets without a common face",
            ));
        }
        if equal && contact.passes == Passes::TwoHalf {
            return Err(text(
                format!("/contacts/{name}/passes"),
                format!(
                    "`{}` is slave and master at once: both sides of self contact are slaves already, with half of their \
                     areas",
                    contact.slave
                ),
            )
            .help("leave `passes` out, or give two sets without a common face"));
        }
        // As far as a point may sink in, through the wall and one more face.
        let distance = 2.0 * master.depth + master.element_size + contact.offset;
        let (mesh, first) = (&body.mesh, body.first_node);
        let facets = &master.facets;
        let sheet = body.block.sheet().is_some();
        master.own = Some(if sheet {
            let parts = (mesh, body.block.seams());
            OwnFacets::of_sheet(parts, first, points, &self.levers, facets, distance)
        } else {
            OwnFacets::new(mesh, first, points, slave, faces, facets, distance)
        });
        self.notes.push(format!(
            "contact `{name}`: self contact of body `{}`; what is nearer than {} along its undeformed mesh is left out, \
             and faces whose normals do not oppose each other",
            body.name,
            number(distance)
        ));
        if equal {
            // Where two faces meet, the points of both push, half each.
            points.iter_mut().for_each(|p| p.area *= 0.5);
            self.notes.push(format!(
                "contact `{name}`: its faces are slave and master at once, so that of two that meet each carries half of \
                 the pressure with half of its area"
            ));
        }
        Ok(())
    }
}
